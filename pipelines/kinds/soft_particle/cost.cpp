#include "pipelines/kinds/soft_particle/cost.h"

#include <algorithm>
#include <cstdint>

#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "microsim/shell_packing.h"
#include "microsim/soft_experiment.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

/// Loop passes of a relaxation: along the way to an overlap, at every recorded point, along a slow turn, at every
/// rotated point. Two scenes with the same way and different numbers of points give the first two (results/relaxation,
/// results/published).
struct Passes {
  double way = 0.0;  ///< per Delta
  double point = 0.0;
  double turn = 0.0;  ///< per degree, at the usual speed
  double rotated = 0.0;
};

/// Loop passes of one degree at the usual speed: with real masses in steps of the published protocol, and with raised
/// ones.
constexpr double kTurnPasses = 2.7e3;
constexpr double kRaisedTurnPasses = kTurnPasses / 4.0;

/// Degrees that the first body is turned by at one overlap: to the largest angle of each sign.
double turned_degrees(const MeasurementPlan& plan) {
  double least = 0.0;
  double most = 0.0;
  for (const double a : plan.angles_deg) {
    least = std::min(least, a);
    most = std::max(most, a);
  }
  return most - least;
}

Passes published_passes(PairKind kind, const PublishedOptions& options) {
  const PublishedOptions usual;
  const Passes p = kind == PairKind::soft_solid ? Passes{5.7e5, 2.7e4, kTurnPasses, 4.1e4}
                                                : Passes{2.0e5, 3.9e4, kTurnPasses, 3.6e4};
  const double shorter = usual.step_fraction / options.step_fraction;
  const double rests = static_cast<double>(options.stops + 1) / static_cast<double>(usual.stops + 1);
  return {p.way * shorter, p.point * shorter * rests, p.turn * shorter, p.rotated * shorter * rests};
}

Passes least_work_passes(PairKind kind, const LeastWorkProtocolOptions& options) {
  constexpr double kStep = 2.0;  // at which slow dynamics was counted
  const bool slow = options.increment_passes == 0;
  if (slow) return {6.2e4 * kStep / options.step_factor, 1.8e3, kRaisedTurnPasses, 260.0};
  return kind == PairKind::soft_solid ? Passes{1.0e4, 1.0e3, kRaisedTurnPasses, 260.0}
                                      : Passes{1.8e4, 1.5e3, kRaisedTurnPasses, 260.0};
}

Passes damped_passes(PairKind kind, const DampedProtocolOptions& options) {
  const DampedProtocolOptions usual;
  const Passes p = kind == PairKind::soft_solid ? Passes{2.6e3, 1.6e3, kRaisedTurnPasses, 700.0}
                                                : Passes{3.0e4, 1.5e3, kRaisedTurnPasses, 900.0};
  return {p.way * usual.increment / options.increment, p.point, p.turn, p.rotated};
}

Passes passes_of(const MeasureSetup& setup, Relaxation relaxation, PairKind kind) {
  if (relaxation == Relaxation::published) return published_passes(kind, setup.published);
  if (relaxation == Relaxation::damped) return damped_passes(kind, setup.damped);
  return least_work_passes(kind, setup.least_work);
}

}  // namespace

MeasureTrial try_soft_particle(const SoftParticleSpec& spec, std::uint64_t seed, double budget) {
  constexpr std::int64_t kPasses = 2000;
  constexpr double kHalfway = 0.15;  // h/Rs
  constexpr double kStep = 0.2;      // of the published protocol
  MeasureTrial t;
  t.packing_seconds = core_seconds_of([&] { t.packing = generate_shell_packing(spec, seed, 0); });
  SoftExperiment e = make_soft_solid(spec, t.packing, false);
  e.push(kHalfway * spec.shell_radius);
  e.set_damping(true);
  VelocityVerlet<3> integrator(kStep * step_limit(e.system).natural_time);
  integrator.initialise(e.system);
  t.pass_seconds = core_seconds_per_call([&] { integrator.step(e.system); }, budget, kPasses);
  return t;
}

double measuring_seconds(const MeasureSetup& setup, Relaxation relaxation, const MeasurementPlan& plan, PairKind kind,
                         double pass_seconds) {
  constexpr double kTwoParticles = 2.0;
  if (plan.deltas.empty()) return 0.0;
  const Passes p = passes_of(setup, relaxation, kind);
  const double turn = p.turn * turned_degrees(plan) * usual_turn_speed(setup.spec) / turn_speed(plan, setup.spec);
  const double passes = p.way * plan.deltas.back() + p.point * static_cast<double>(plan.deltas.size()) +
                        static_cast<double>(plan.tangential_deltas.size()) *
                            (turn + p.rotated * static_cast<double>(plan.angles_deg.size()));
  return passes * pass_seconds * (kind == PairKind::soft_soft ? kTwoParticles : 1.0);
}

}  // namespace softgrain
