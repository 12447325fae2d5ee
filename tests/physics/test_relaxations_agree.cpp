// The fast relaxation against the slow reference, paired over the same packings: small ones in seconds, a few of the
// published size in minutes (Slow). Over 24 packings and more: results/relaxation/study.sh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "calibrate/curve_samples.h"
#include "common/core/statistics.h"
#include "microsim/measure.h"
#include "microsim/shell_packing.h"

namespace softgrain {
namespace {

constexpr double kAngle = 0.05;  // degree: within the linear range

/// Slow dynamics all along the path, as the scenes in pipelines/ choose it.
LeastWorkProtocolOptions scenes_choice() {
  LeastWorkProtocolOptions options;
  options.increment_passes = 0;
  options.step_factor = 2.0;
  return options;
}

PackingRun run(const SoftParticleSpec& spec, std::uint64_t index, const MeasurementPlan& plan,
               const Protocol& protocol) {
  MeasurementState state;
  state.experiment = make_soft_solid(spec, generate_shell_packing(spec, 17, index), protocol.damped_contacts());
  measure(state, plan, protocol);
  return state.run;
}

std::vector<PackingRun> run_all(const SoftParticleSpec& spec, int packings, const MeasurementPlan& plan,
                                const Protocol& protocol) {
  std::vector<PackingRun> runs(static_cast<std::size_t>(packings));
#pragma omp parallel for schedule(dynamic, 1)
  for (int k = 0; k < packings; ++k)
    runs[static_cast<std::size_t>(k)] = run(spec, static_cast<std::uint64_t>(k), plan, protocol);
  return runs;
}

void expect_converged(const std::vector<PackingRun>& runs) {
  for (const PackingRun& r : runs) {
    for (const NormalPoint& p : r.normal)
      EXPECT_TRUE(p.converged) << r.relaxation << " " << r.packing << " " << p.delta;
    for (const TangentialPoint& p : r.tangential)
      EXPECT_TRUE(p.converged) << r.relaxation << " " << r.packing << " " << p.delta << " " << p.angle_deg;
  }
}

std::vector<double> forces(const std::vector<PackingRun>& runs, double delta) {
  std::vector<double> out;
  for (const PackingRun& r : runs)
    for (const NormalPoint& p : r.normal)
      if (p.delta == delta) out.push_back(p.force);
  return out;
}

/// kt at the origin of every packing, summed over these overlaps.
std::vector<double> stiffnesses(const std::vector<PackingRun>& runs, const SoftParticleSpec& spec,
                                std::span<const double> deltas) {
  std::vector<double> out;
  for (const PackingRun& r : runs) {
    double sum = 0.0;
    for (const double delta : deltas) {
      std::vector<TangentialPoint> points;
      std::copy_if(r.tangential.begin(), r.tangential.end(), std::back_inserter(points),
                   [&](const TangentialPoint& p) { return p.delta == delta; });
      sum += initial_slope(points, kAngle, spec.shell_radius).value_or(std::nan(""));
    }
    out.push_back(sum);
  }
  return out;
}

/// The ratio of the means is 1 within the target or three standard errors, and the error is small enough for that to
/// say something.
void expect_same_mean(const std::vector<double>& fast, const std::vector<double>& slow, double target,
                      double largest_error, const std::string& what) {
  const RatioError r = paired_ratio(fast, slow);
  std::printf("%s: ratio %.4f +- %.4f over %zu packings\n", what.c_str(), r.ratio, r.error, fast.size());
  EXPECT_LT(r.error, largest_error) << what;
  EXPECT_LT(std::abs(r.ratio - 1.0), std::max(target, 3.0 * r.error)) << what;
}

std::int64_t passes(const std::vector<PackingRun>& runs, Cost PackingRun::*cost) {
  std::int64_t sum = 0;
  for (const PackingRun& r : runs) sum += (r.*cost).loop_passes;
  return sum;
}

SoftParticleSpec small_spec() {
  SoftParticleSpec spec;
  spec.trials = 200;
  spec.polydispersity = 4.0;
  spec.beta = 6.0;
  return spec;
}

/// Packings of few grains, whose forces scatter by half. Over 32 of them: Fn 1.006 +- 0.018, kt 1.03 +- 0.05 by the
/// scenes' choice; the key defaults, increments by least work, are too stiff here: Fn 1.05 +- 0.03 over 64.
TEST(RelaxationsAgree, LeastWorkCostsATenthAndGivesTheSameForceAndStiffness) {
  constexpr int kPackings = 24;
  const std::vector<double> deltas{0.35};
  const SoftParticleSpec spec = small_spec();
  const MeasurementPlan turned{deltas, deltas, {-kAngle, kAngle}, 0.05, true};
  const MeasurementPlan pressed{deltas, {}, {}, 0.05, true};
  const auto slow = run_all(spec, kPackings, turned, *make_published_protocol({}));
  const auto fast = run_all(spec, kPackings, turned, *make_least_work_protocol(scenes_choice()));
  const auto faster = run_all(spec, kPackings, pressed, *make_least_work_protocol({}));
  for (const auto* runs : {&slow, &fast, &faster}) expect_converged(*runs);
  const auto reference = forces(slow, deltas[0]);
  expect_same_mean(forces(fast, deltas[0]), reference, 0.02, 0.04, "Fn, scenes' choice");
  expect_same_mean(stiffnesses(fast, spec, deltas), stiffnesses(slow, spec, deltas), 0.05, 0.1, "kt, scenes' choice");
  expect_same_mean(forces(faster, deltas[0]), reference, 0.1, 0.1, "Fn, key defaults");
  EXPECT_GT(passes(slow, &PackingRun::normal_cost), 3 * passes(fast, &PackingRun::normal_cost));
  EXPECT_GT(passes(slow, &PackingRun::normal_cost), 10 * passes(faster, &PackingRun::normal_cost));
  EXPECT_GT(passes(slow, &PackingRun::tangential_cost), 100 * passes(fast, &PackingRun::tangential_cost));
}

/// Packings of the published size on a plane, by the published protocol at its own speed. Minutes, nearly all of it the
/// reference. The targets are 2 % of Fn and 5 % of kt; six packings can only show 2-6 % and 12-26 %, more of them
/// are in results/relaxation. Measured: Fn 1.040(16), 1.013(19), 1.009(7) at 0.15, 0.20, 0.30; kt 0.97(9), 1.03(4),
/// over both 1.01(5).
TEST(SlowRelaxationsAgree, LeastWorkGivesForceAndStiffnessOfThePublishedProtocol) {
  constexpr int kPackings = 6;
  const SoftParticleSpec spec;
  const std::vector<double> turned{0.20, 0.30};
  const MeasurementPlan plan{{0.15, 0.20, 0.30}, turned, {-kAngle, kAngle}, 0.05, true};
  const auto slow = run_all(spec, kPackings, plan, *make_published_protocol({}));
  const auto fast = run_all(spec, kPackings, plan, *make_least_work_protocol(scenes_choice()));
  expect_converged(slow);
  expect_converged(fast);
  for (const double delta : plan.deltas)
    expect_same_mean(forces(fast, delta), forces(slow, delta), 0.02, 0.03, "Fn at " + std::to_string(delta));
  for (const double delta : turned)
    expect_same_mean(stiffnesses(fast, spec, std::vector{delta}), stiffnesses(slow, spec, std::vector{delta}), 0.05,
                     0.12, "kt at " + std::to_string(delta));
  expect_same_mean(stiffnesses(fast, spec, turned), stiffnesses(slow, spec, turned), 0.05, 0.08, "kt over both");
  EXPECT_GT(passes(slow, &PackingRun::normal_cost), 8 * passes(fast, &PackingRun::normal_cost));
  EXPECT_GT(passes(slow, &PackingRun::tangential_cost), 100 * passes(fast, &PackingRun::tangential_cost));
}

}  // namespace
}  // namespace softgrain
