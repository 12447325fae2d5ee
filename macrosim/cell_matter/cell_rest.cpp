// How a packing of cells comes to rest: by mixed steps of its tangent, and by Fire where these do not get there.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/dynamics/fire.h"
#include "common/dynamics/slow_dynamics.h"
#include "common/dynamics/thread_choice.h"
#include "common/io/interrupt.h"
#include "macrosim/cell_matter/cell_axes.h"
#include "macrosim/cell_matter/cell_packing.h"
#include "macrosim/cell_matter/cell_steps.h"

namespace softgrain {

namespace {

/// Steps that are mixed.
constexpr std::size_t kMixed = 6;
/// The residual has to fall by a fifth in so many steps, or Fire takes over.
constexpr int kPatience = 25;
constexpr double kFall = 0.8;
/// How well the tangent is solved, and in how many iterations at most.
constexpr double kAnswer = 0.05;
constexpr int kMostAnswers = 200;
/// Steps shorter than this part of the longest one lead nowhere.
constexpr double kShortest = 1e-6;
/// Moves that are taken back in a row before a relaxation by Fire counts as diverged.
constexpr int kMaxRefusals = 30;

double longest_of(const std::vector<Vec3>& steps, std::size_t sites) {
  double out = 0.0;
  for (std::size_t i = 0; i < sites; ++i) out = std::max(out, norm(steps[i]));
  return out;
}

void no_longer_than(Vec3& step, double most) {
  if (const double size = norm(step); size > most) step *= most / size;
}

}  // namespace

/// False, and all as it was: the move would leave a cell without pores.
bool CellPacking::move(const std::vector<Vec3>& steps, const Vec3& factors) {
  const auto sites = sites_;
  const auto periods = periods_;
  const CellRoom room = room_;
  for (std::size_t i = 0; i < sites_.size(); ++i) sites_[i].x += steps[i];
  if (factors != kAsItIs) stretch(factors);
  room_.bring_home(sites_, periods_);
  RadicalCells cells = std::move(cells_);  // evaluate() makes both anew
  CellForces forces = std::move(forces_);
  const auto put_back = [&] {
    cells_ = std::move(cells);
    forces_ = std::move(forces);
  };
  try {
    if (evaluate()) return true;
  } catch (...) {
    put_back();
    throw;
  }
  sites_ = sites;
  periods_ = periods;
  room_ = room;
  put_back();
  return false;
}

/// How far from rest, in tolerances.
double CellPacking::unrest(const CellRelaxation& options, const Axes* axes) const {
  const double off = axes != nullptr ? axes->residual(*this) : 0.0;
  return std::max(forces_.residual() / options.tolerance, off);
}

/// Where the tangent at each place would lead, mixed with the last steps. Ends as not_run where that does not get on.
RelaxationResult CellPacking::settle(const CellRelaxation& options, Axes* axes) {
  RelaxationResult result;
  PassThreads threads(sites_.size(), PassKind::cells);
  StepMixer mixer(kMixed);
  const auto n = static_cast<double>(sites_.size());
  const double spacing = std::cbrt(room_.volume() / n);
  const double usual = options.largest_move * spacing;
  // A strain of the room is one more motion among those of the sites, as long as all that go along with it.
  const double strained = std::cbrt(room_.volume()) * std::sqrt(n / 12.0);
  double best = HUGE_VAL;
  double longest = usual;
  for (int since = 0; since <= kPatience && longest > kShortest * usual; ++since) {
    const double now = unrest(options, axes);
    result.residual = forces_.residual();
    if (now <= 1.0) result.end = RelaxationEnd::converged;
    if (now <= 1.0 || result.passes >= options.max_passes || (axes != nullptr && axes->out_of_reach())) break;
    if (now < kFall * best) {
      best = now;
      since = 0;
    }
    stop_if_interrupted("relaxing");
    std::vector<Vec3> steps = CellTangent(sites_, cells_, forces_).answer(kAnswer, kMostAnswers);
    if (axes != nullptr) steps.push_back(axes->answer(*this) * strained);
    steps = mixer.mix(steps);
    double farthest = longest_of(steps, sites_.size());
    if (axes != nullptr) farthest = std::max(farthest, norm(steps.back()) / strained / axes->largest_strain() * usual);
    const double share = std::min(1.0, longest / farthest);
    for (Vec3& d : steps) d *= share;
    ++result.passes;
    const Vec3 factors = axes != nullptr ? kAsItIs - steps.back() * (1.0 / strained) : kAsItIs;
    if (move(steps, factors)) {
      mixer.took(steps);
      if (axes != nullptr) axes->took(factors);
      longest = std::min(usual, 2.0 * longest);
    } else {
      mixer.forget();
      longest = 0.25 * std::min(longest, farthest);
    }
    threads.passed(1, std::ssize(cells_.faces));
  }
  return result;
}

/// Relaxes by Fire, with the stiffness of the faces of each site as its mass.
RelaxationResult CellPacking::glide(const CellRelaxation& options, Axes* axes) {
  RelaxationResult result;
  PassThreads threads(sites_.size(), PassKind::cells);
  Fire fire;
  std::vector<Vec3> velocity(sites_.size());
  std::vector<Vec3> steps(sites_.size());
  double longest = options.largest_move * std::cbrt(room_.volume() / static_cast<double>(sites_.size()));
  const double usual = longest;
  std::vector<double> mass = forces_.mass;
  for (int refusals = 0; result.end == RelaxationEnd::not_run;) {
    result.residual = forces_.residual();
    if (unrest(options, axes) <= 1.0)
      result.end = RelaxationEnd::converged;
    else if (refusals > kMaxRefusals)
      result.end = RelaxationEnd::diverged;
    else if (result.passes >= options.max_passes || (axes != nullptr && axes->out_of_reach()))
      result.end = RelaxationEnd::capped;
    if (result.end != RelaxationEnd::not_run) break;
    stop_if_interrupted("relaxing");
    if (result.passes % PseudoMasses::kInterval == 0) {
      mass = forces_.mass;
      if (axes != nullptr) axes->weigh(*this);
    }
    double power = 0.0;
    double speed2 = 0.0;
    double pull2 = 0.0;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      power += dot(velocity[i], forces_.force[i]);
      speed2 += norm2(velocity[i]) * mass[i];
      pull2 += norm2(forces_.force[i]) / mass[i];
    }
    if (axes != nullptr) axes->feel(*this, power, speed2, pull2);
    const Fire::Steering steering = fire.steer(power, speed2, pull2);
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      velocity[i] = velocity[i] * steering.keep + forces_.force[i] * ((steering.pull + fire.step) / mass[i]);
      steps[i] = velocity[i] * fire.step;
      no_longer_than(steps[i], longest);
    }
    if (axes != nullptr) axes->steer(steering, fire.step);
    const Vec3 factors = axes != nullptr ? axes->factors(fire.step) : kAsItIs;
    ++result.passes;
    if (move(steps, factors)) {
      if (axes != nullptr) axes->took(factors);
      refusals = 0;
      longest = std::min(usual, 1.1 * longest);
    } else {
      ++refusals;
      longest *= 0.25;
      fire = {};
      std::fill(velocity.begin(), velocity.end(), Vec3{});
      if (axes != nullptr) axes->stop();
    }
    threads.passed(1, std::ssize(cells_.faces));
  }
  return result;
}

RelaxationResult CellPacking::rest(const CellRelaxation& options, Axes* axes) {
  if (!options.by_tangent) return glide(options, axes);
  RelaxationResult result = settle(options, axes);
  if (result.end == RelaxationEnd::converged) return result;
  const std::int64_t passes = result.passes;
  result = glide(options, axes);
  result.passes += passes;
  return result;
}

}  // namespace softgrain
