// The fast relaxation against the slow reference: means over small packings, in seconds. The full comparison, on 24
// packings of the published size, is results/relaxation/study.sh.
#include <gtest/gtest.h>

#include <cmath>

#include "microsim/measure.h"
#include "microsim/shell_packing.h"

namespace softgrain {
namespace {

constexpr int kPackings = 16;
const MeasurementPlan kPlan{{0.25, 0.35}, {}, {}, 0.01, true};

SoftParticleSpec small_spec() {
  SoftParticleSpec spec;
  spec.trials = 200;
  spec.polydispersity = 4.0;
  spec.beta = 6.0;
  return spec;
}

struct Mean {
  double force = 0.0;
  std::int64_t passes = 0;
};

PackingRun run(const SoftParticleSpec& spec, std::uint64_t index, const Protocol& protocol) {
  MeasurementState state;
  state.experiment = make_soft_solid(spec, generate_shell_packing(spec, 17, index), protocol.damped_contacts());
  measure(state, kPlan, protocol, [](const MeasurementState&, double) {});
  return state.run;
}

Mean mean_of(const Protocol& protocol) {
  Mean mean;
  for (int k = 0; k < kPackings; ++k) {
    const PackingRun r = run(small_spec(), static_cast<std::uint64_t>(k), protocol);
    EXPECT_TRUE(r.normal.back().converged);
    mean.force += r.normal.back().force / kPackings;
    mean.passes += r.normal_cost.loop_passes;
  }
  return mean;
}

/// Measured: 1.05 +- 0.03 over 64 such packings, whose few grains scatter by half.
TEST(RelaxationsAgree, LeastWorkCostsATenthAndGivesTheSameForce) {
  const Mean slow = mean_of(*make_published_protocol({}));
  const Mean fast = mean_of(*make_least_work_protocol({}));
  EXPECT_NEAR(fast.force / slow.force, 1.0, 0.12);
  EXPECT_GT(slow.passes, 10 * fast.passes);
}

}  // namespace
}  // namespace softgrain
