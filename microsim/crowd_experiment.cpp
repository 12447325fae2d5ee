#include "microsim/crowd_experiment.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/core/error.h"
#include "common/data/slide_direction.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/displace.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/residual.h"
#include "microsim/protocol.h"

namespace softgrain {

namespace {

/// Which neighbour a body belongs to; -1 for the centre.
std::vector<std::int32_t> owners(const CrowdExperiment& e) {
  std::vector<std::int32_t> owner(static_cast<std::size_t>(e.system.particles.size()), -1);
  for (std::size_t k = 0; k < e.neighbours.size(); ++k) {
    const CrowdExperiment::Neighbour& n = e.neighbours[k];
    for (Slot i = n.begin; i < n.end; ++i) owner[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(k);
    owner[static_cast<std::size_t>(n.body)] = static_cast<std::int32_t>(k);
  }
  return owner;
}

/// Force on each neighbour from the content of the centre [N].
std::vector<Vec3> neighbour_forces(const CrowdExperiment& e, const std::vector<ContactRecord<3>>& records) {
  const std::vector<std::int32_t> owner = owners(e);
  std::vector<Vec3> forces(e.neighbours.size());
  for (const ContactRecord<3>& c : records) {
    if (c.i >= e.centre_bodies) continue;
    const std::int32_t k = owner[static_cast<std::size_t>(c.j)];
    if (k >= 0) forces[static_cast<std::size_t>(k)] -= c.normal * c.normal_force + c.tangential_force;
  }
  return forces;
}

/// h/Rs of neighbour k, towards the shell where it is now.
double present_overlap(const CrowdExperiment& e, std::size_t k) {
  const auto& p = e.system.particles;
  const Vec3 apart =
      p.sphere[static_cast<std::size_t>(e.neighbours[k].body)].x - p.sphere[static_cast<std::size_t>(e.centre_shell)].x;
  const CrowdPartner& partner = e.configuration.partners[k];
  const double distance = partner.kind == PartnerKind::plane ? dot(apart, partner.direction) : norm(apart);
  return 1.0 + partner.ratio - distance / e.spec.shell_radius;
}

RelaxationResult relax(CrowdExperiment& e, const CrowdOptions& options, double tolerance) {
  DampedOptions damped;
  damped.tolerance = tolerance;
  damped.force_floor = force_floor(e.spec);
  damped.max_passes = options.max_passes;
  damped.least_stiffness = options.least_stiffness * e.spec.youngs_modulus;
  return DampedRelaxation<3>(damped).relax(e.system);
}

/// Prescribed position: overlaps and slide [Rs].
struct Target {
  std::vector<double> overlap;
  double slide = 0.0;
};

/// `share` of the way from one to the other; exactly `to` at 1.
Target between(const Target& from, const Target& to, double share) {
  if (share == 1.0) return to;
  Target t{from.overlap, from.slide + share * (to.slide - from.slide)};
  for (std::size_t k = 0; k < t.overlap.size(); ++k) t.overlap[k] += share * (to.overlap[k] - from.overlap[k]);
  return t;
}

double distance(const Target& a, const Target& b) {
  double most = std::abs(a.slide - b.slide);
  for (std::size_t k = 0; k < a.overlap.size(); ++k) most = std::max(most, std::abs(a.overlap[k] - b.overlap[k]));
  return most;
}

std::int64_t steps_for(double length, double increment) {
  constexpr double kRounding = 1e-9;
  return std::max(std::int64_t{1}, static_cast<std::int64_t>(std::ceil(length / increment - kRounding)));
}

void advance(CrowdExperiment& e, const Target& to, const CrowdOptions& options) {
  const Target from{e.overlap, e.slide};
  const double length = distance(from, to);
  if (length <= 0.0) return;
  const std::int64_t steps = steps_for(length, options.increment);
  for (std::int64_t k = 1; k <= steps; ++k) {
    const Target next = between(from, to, static_cast<double>(k) / static_cast<double>(steps));
    e.move_to(next.overlap, next.slide);
    relax(e, options, options.tolerance_between);
  }
}

Target end_of(const CrowdStage& stage, double slide_before) { return {stage.overlap, slide_before + stage.slide}; }

CrowdPoint recorded(CrowdExperiment& e, const CrowdOptions& options, std::size_t stage) {
  const RelaxationResult rest = relax(e, options, options.tolerance);
  CrowdPoint point = e.observe();
  point.stage = static_cast<std::int64_t>(stage);
  point.residual = rest.residual;
  point.converged = rest.end == RelaxationEnd::converged;
  return point;
}

void require_plan(const CrowdConfiguration& c, const CrowdPlan& plan) {
  if (plan.size() != c.stages.size()) throw BadInput(c.name + ": the plan has another number of stages");
}

}  // namespace

Vec3 neighbour_place(const SoftParticleSpec& spec, const CrowdPartner& p, const Vec3& direction, double overlap) {
  return direction * ((1.0 + p.ratio - overlap) * spec.shell_radius);
}

Vec3 CrowdExperiment::direction(std::size_t k) const {
  const CrowdPartner& p = configuration.partners[k];
  if (k > 0 || slide == 0.0 || p.kind == PartnerKind::plane) return p.direction;
  const double angle = slide / (1.0 + p.ratio - overlap[0]);
  return p.direction * std::cos(angle) + slide_direction(p.direction) * std::sin(angle);
}

void CrowdExperiment::move_to(const std::vector<double>& overlaps, double slide_to) {
  std::vector<Vec3> moves(static_cast<std::size_t>(system.particles.size()));
  std::vector<Vec3> before(neighbours.size());
  for (std::size_t k = 0; k < neighbours.size(); ++k) before[k] = direction(k);
  const std::vector<double> overlaps_before = overlap;
  const double slide_before = slide;
  overlap = overlaps;
  slide = slide_to;
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const CrowdPartner& p = configuration.partners[k];
    Vec3 move = before[k] * ((overlaps_before[k] - overlap[k]) * spec.shell_radius);
    if (k == 0 && slide != slide_before)
      move = p.kind == PartnerKind::plane
                 ? move + slide_direction(p.direction) * ((slide - slide_before) * spec.shell_radius)
                 : neighbour_place(spec, p, direction(0), overlap[0]) -
                       neighbour_place(spec, p, before[0], overlaps_before[0]);
    for (Slot i = neighbours[k].begin; i < neighbours[k].end; ++i) moves[static_cast<std::size_t>(i)] = move;
    moves[static_cast<std::size_t>(neighbours[k].body)] = move;
  }
  displace(system, moves);
}

CrowdPoint CrowdExperiment::observe() const {
  CrowdPoint point;
  const double unit = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const std::vector<Vec3> forces = neighbour_forces(*this, contact_records(system));
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const Vec3 n = direction(k);
    const double normal = dot(forces[k], n);
    point.overlap.push_back(present_overlap(*this, k));
    point.normal.push_back(normal / unit);
    point.tangential.push_back((forces[k] - n * normal) * (1.0 / unit));
  }
  const Residual rest = softgrain::residual(system);
  point.residual = rest.relative(force_floor(spec));
  point.max_overlap = rest.max_overlap;
  point.slide = slide;
  point.centre = system.particles.sphere[static_cast<std::size_t>(centre_shell)].x * (1.0 / spec.shell_radius);
  return point;
}

CrowdRun run_crowd(CrowdExperiment& e, const CrowdPlan& plan, const CrowdOptions& options,
                   const CrowdObserver& observer) {
  require_plan(e.configuration, plan);
  const auto start = std::chrono::steady_clock::now();
  CrowdRun run;
  for (std::size_t k = 0; k < plan.size(); ++k) {
    const Target from{e.overlap, e.slide};
    const Target to = end_of(e.configuration.stages[k], e.slide);
    for (const double share : plan[k]) {
      advance(e, between(from, to, share), options);
      run.points.push_back(recorded(e, options, k));
      if (observer) observer(run.points.back());
    }
    advance(e, to, options);  // nothing left to do when the end was recorded
  }
  run.cost = e.system.cost;
  run.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return run;
}

std::int64_t count_increments(const CrowdConfiguration& configuration, const CrowdPlan& plan,
                              const CrowdOptions& options) {
  require_plan(configuration, plan);
  std::int64_t count = 0;
  Target from{std::vector<double>(configuration.partners.size(), 0.0), 0.0};
  for (std::size_t k = 0; k < plan.size(); ++k) {
    const Target to = end_of(configuration.stages[k], from.slide);
    double done = 0.0;
    for (const double share : plan[k]) {
      count += steps_for((share - done) * distance(from, to), options.increment);
      done = share;
    }
    if (done < 1.0) count += steps_for((1.0 - done) * distance(from, to), options.increment);
    from = to;
  }
  return count;
}

}  // namespace softgrain
