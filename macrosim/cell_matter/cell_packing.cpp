#include "macrosim/cell_matter/cell_packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/error.h"
#include "common/dynamics/fire.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

/// Moves that are taken back in a row before a relaxation counts as diverged.
constexpr int kMaxRefusals = 30;
/// Parts of a strain step, the smallest: 2^-10.
constexpr int kMostParts = 1024;

CellRoom room_of(const CellState& state, bool periodic) {
  if (periodic) return box_cell(state.high, {true, true, true});
  return PlaneBox{state.low, state.high};
}

Vec3 by_axis(const Vec3& a, const Vec3& b) { return {{a[0] * b[0], a[1] * b[1], a[2] * b[2]}}; }

}  // namespace

/// Lengths of axes that are held by stress, as logarithmic strains beside the places of the sites. What pushes one is
/// (P - sigma) V + sum F (x - c): the work of the asked stress less that of cells and sites that go along.
class CellPacking::Axes {
 public:
  Axes(const CellPacking& packing, const BoxControl& control) : control_(control) { weigh(packing); }

  /// Half a row of the stiffness matrix, as of sites: what all cells resist a change of length with, faces their
  /// springs, and again as much for the sites that it pushes.
  void weigh(const CellPacking& p) {
    double sum = 0.0;
    for (std::size_t i = 0; i < p.cells_.volume.size(); ++i)
      sum += p.forces_.response[i].stiffness * p.cells_.volume[i] * p.cells_.volume[i];
    for (const FaceSpring& spring : p.forces_.springs)
      if (p.law_.friction.coefficient > 0.0) sum += spring.stiffness * norm2(spring.separation);
    double pressed = 0.0;
    for (int k = 0; k < 3; ++k) pressed += std::abs(control_.stress[k]) * p.room_.volume();
    mass_ = std::max(2.0 * sum, std::max(pressed, control_.least_stress * p.room_.volume()));
  }

  void feel(const CellPacking& p, double& power, double& speed2, double& pull2) {
    const Matrix<3> stress = p.stress();
    const double volume = p.room_.volume();
    for (int k = 0; k < 3; ++k) force_[k] = (control_.stress[k] - stress[k][k]) * volume;
    if (!p.room_.periodic())
      for (std::size_t i = 0; i < p.sites_.size(); ++i)
        force_ -= by_axis(p.forces_.force[i], p.sites_[i].x - p.room_.centre());
    hold(force_);
    for (int k = 0; k < 3; ++k) {
      power += velocity_[k] * force_[k];
      speed2 += velocity_[k] * velocity_[k] * mass_;
      pull2 += force_[k] * force_[k] / mass_;
    }
  }

  void steer(const Fire::Steering& steering, double step) {
    velocity_ = velocity_ * steering.keep + force_ * ((steering.pull + step) / mass_);
  }
  void stop() { velocity_ = {}; }

  /// Factors of the lengths in one pass.
  [[nodiscard]] Vec3 factors(double step, double share) const {
    Vec3 out;
    const double most = control_.largest_strain * share;
    for (int k = 0; k < 3; ++k) out[k] = 1.0 - std::clamp(velocity_[k] * step, -most, most);
    return out;
  }
  void took(const Vec3& factors) {
    for (int k = 0; k < 3; ++k) strained_[k] -= std::log(factors[k]);
  }
  [[nodiscard]] bool out_of_reach() const {
    return std::max({std::abs(strained_[0]), std::abs(strained_[1]), std::abs(strained_[2])}) > control_.farthest;
  }

  /// Largest error of the stress over its tolerance.
  [[nodiscard]] double residual(const CellPacking& p) const {
    const Matrix<3> stress = p.stress();
    Vec3 off;
    double largest = control_.least_stress;
    for (int k = 0; k < 3; ++k) {
      off[k] = stress[k][k] - control_.stress[k];
      if (control_.by_stress[static_cast<std::size_t>(k)]) largest = std::max(largest, std::abs(control_.stress[k]));
    }
    hold(off);
    return std::max({std::abs(off[0]), std::abs(off[1]), std::abs(off[2])}) / (control_.tolerance * largest);
  }

 private:
  /// Axes alike take the mean; those that go by strain have none.
  void hold(Vec3& a) const {
    const double mean = (a[0] + a[1] + a[2]) / 3.0;
    for (int k = 0; k < 3; ++k)
      a[k] = !control_.by_stress[static_cast<std::size_t>(k)] ? 0.0 : control_.alike ? mean : a[k];
  }

  BoxControl control_;
  double mass_ = 0.0;
  Vec3 force_{};
  Vec3 velocity_{};
  Vec3 strained_{};
};

CellPacking::CellPacking(CellLaw law, const std::vector<Sphere<3>>& sites, std::vector<CellContent> content,
                         const CellRoom& room)
    : law_(std::move(law)), sites_(sites), content_(std::move(content)), room_(room), periods_(sites.size()) {
  require_sound(law_, content_, sites_.size());
  room_.bring_home(sites_, periods_);
  if (!room_.holds(sites_)) throw BadInput("cells: a site lies outside the planes");
  if (!evaluate())
    for (std::size_t i = 0; i < sites_.size(); ++i)
      if (!(cells_.volume[i] > content_[i].solid))
        throw BadInput(fmt::format("cells: cell {} has a volume of {:.4g} m^3 and holds {:.4g} m^3 of solid", i,
                                   cells_.volume[i], content_[i].solid));
  springs_.keep(forces_.springs);
}

CellPacking::CellPacking(CellLaw law, const CellState& state, bool periodic)
    : law_(std::move(law)),
      sites_(state.sites),
      content_(state.content),
      room_(room_of(state, periodic)),
      periods_(state.periods) {
  require_sound(law_, content_, sites_.size());
  if (periods_.size() != sites_.size()) throw FileTrouble("cells: periods of other sites");
  springs_.keep(state.springs);
  if (!room_.holds(sites_) || !evaluate()) throw FileTrouble("cells: a state that cannot be");
}

CellState CellPacking::state() const {
  return {sites_, content_, periods_, springs_.kept(), room_.low(), room_.high()};
}

/// False: a cell has no pores, a site is outside, or a force is no number.
bool CellPacking::evaluate() {
  if (!room_.holds(sites_)) return false;
  ++tessellations_;
  cells_ = room_.cells_of(sites_);
  faces_ += static_cast<std::int64_t>(cells_.faces.size());
  forces_ = cell_forces(law_, content_, sites_, cells_, room_.volume(), face_keys(cells_, periods_), springs_);
  return forces_.possible();
}

Matrix<3> CellPacking::stress() const {
  if (room_.periodic()) return forces_.stress;
  const auto loads = wall_loads(cells_, forces_.response);
  const Vec3 size = room_.high() - room_.low();
  Matrix<3> out;
  for (int k = 0; k < 3; ++k) {
    const auto u = static_cast<std::size_t>(2 * k);
    out[k][k] = 0.5 * (loads[u] + loads[u + 1]) * size[k] / room_.volume();
  }
  return out;
}

/// The room and its sites.
void CellPacking::stretch(const Vec3& factor) {
  const Vec3 c = room_.centre();
  room_.stretch(factor);
  for (auto& s : sites_) s.x = c + by_axis(s.x - c, factor);
}

/// False, and all as it was: the move would leave a cell without pores.
bool CellPacking::move(const std::vector<Vec3>& velocity, double step, double longest, Axes* axes) {
  const auto sites = sites_;
  const auto periods = periods_;
  const CellRoom room = room_;
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    Vec3 d = velocity[i] * step;
    const double size = norm(d);
    if (size > longest) d *= longest / size;
    sites_[i].x += d;
  }
  const Vec3 factors = axes != nullptr ? axes->factors(step, 1.0) : Vec3{{1.0, 1.0, 1.0}};
  if (axes != nullptr) stretch(factors);
  room_.bring_home(sites_, periods_);
  auto cells = cells_;
  auto forces = forces_;
  if (evaluate()) {
    if (axes != nullptr) axes->took(factors);
    return true;
  }
  sites_ = sites;
  periods_ = periods;
  room_ = room;
  cells_ = std::move(cells);
  forces_ = std::move(forces);
  return false;
}

RelaxationResult CellPacking::relax(const CellRelaxation& options, Axes* axes) {
  RelaxationResult result;
  Fire fire;
  std::vector<Vec3> velocity(sites_.size());
  double longest = options.largest_move * std::cbrt(room_.volume() / static_cast<double>(sites_.size()));
  const double usual = longest;
  std::vector<double> mass = forces_.mass;
  for (int refusals = 0; result.end == RelaxationEnd::not_run;) {
    result.residual = forces_.residual();
    const bool pressed = axes == nullptr || axes->residual(*this) <= 1.0;
    if (result.residual <= options.tolerance && pressed)
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
    for (std::size_t i = 0; i < sites_.size(); ++i)
      velocity[i] = velocity[i] * steering.keep + forces_.force[i] * ((steering.pull + fire.step) / mass[i]);
    if (axes != nullptr) axes->steer(steering, fire.step);
    ++result.passes;
    if (move(velocity, fire.step, longest, axes)) {
      refusals = 0;
      longest = std::min(usual, 1.1 * longest);
    } else {
      ++refusals;
      longest *= 0.25;
      fire = {};
      std::fill(velocity.begin(), velocity.end(), Vec3{});
      if (axes != nullptr) axes->stop();
    }
  }
  return result;
}

/// The affine part of a strain, then to rest; where that leaves a cell without pores, in parts.
CellPoint CellPacking::step(const Vec3& factor, const BoxControl* control, const CellRelaxation& options) {
  for (int k = 0; k < 3; ++k)
    if (!(factor[k] > 0.0) || !std::isfinite(factor[k]))
      throw BadInput(fmt::format("cells: axis {} stretched by a factor of {}; it must be above 0", k, factor[k]));
  const CellPacking before = *this;
  tessellations_ = faces_ = 0;
  RelaxationResult end;
  int parts = 1;
  for (int left = 1; left > 0;) {
    const auto sites = sites_;
    const CellRoom room = room_;
    Vec3 part;
    for (int k = 0; k < 3; ++k) part[k] = std::pow(factor[k], 1.0 / parts);
    stretch(part);
    if (!evaluate()) {
      sites_ = sites;
      room_ = room;
      evaluate();
      parts *= 2;
      left *= 2;
      if (parts > kMostParts) {
        *this = before;
        throw NotUsable("cells: even a small part of this strain leaves a cell without pores");
      }
      continue;
    }
    --left;
    if (left == 0 && control != nullptr) {
      Axes axes(*this, *control);
      end = relax(options, &axes);
    } else {
      end = relax(options, nullptr);
    }
    springs_.keep(forces_.springs);
  }
  CellPoint point = now();
  point.relaxation = end;
  return point;
}

CellPoint CellPacking::strain(const Vec3& factor, const CellRelaxation& options) {
  return step(factor, nullptr, options);
}

CellPoint CellPacking::press(const Vec3& factor, const BoxControl& control, const CellRelaxation& options) {
  return step(factor, &control, options);
}

CellPoint CellPacking::now() const {
  CellPoint point;
  point.tessellations = tessellations_;
  point.faces = faces_;
  point.volume = room_.volume();
  point.stress = stress();
  point.energy = forces_.energy + forces_.spring_energy;
  point.guarded = forces_.guarded;
  point.sliding =
      cells_.faces.empty() ? 0.0 : static_cast<double>(forces_.sliding) / static_cast<double>(cells_.faces.size());
  return point;
}

}  // namespace softgrain
