// Dimensional analysis, exactly: force/(E Rs^2) depends on neither E nor Rs. By powers of two (so that square roots and
// fourth roots are exact) the law is the same to the last bit, whatever the protocol.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include "microsim/measure.h"
#include "microsim/shell_packing.h"

namespace softgrain {
namespace {

SoftParticleSpec base_spec() {
  SoftParticleSpec spec;
  spec.trials = 50;
  spec.polydispersity = 4.0;
  spec.rmax_over_shell = 0.5;
  spec.beta = 6.0;
  return spec;
}

SoftParticleSpec scaled(double modulus_factor, double radius_factor) {
  SoftParticleSpec spec = base_spec();
  spec.youngs_modulus *= modulus_factor;
  spec.shell_radius *= radius_factor;
  return spec;
}

/// Two intervals, short ones: 0.01 s at the published parameters.
std::unique_ptr<Protocol> published(const SoftParticleSpec& spec) {
  PublishedOptions options;
  options.stops = 1;
  options.stop_interval = natural_time(spec) * 8.0;
  options.approach_speed = spec.shell_radius / (natural_time(spec) * 512.0);
  return make_published_protocol(options);
}

std::unique_ptr<Protocol> damped(const SoftParticleSpec&) { return make_damped_protocol({}); }

std::unique_ptr<Protocol> least_work(const SoftParticleSpec&) { return make_least_work_protocol({}); }

using MakeProtocol = std::unique_ptr<Protocol> (*)(const SoftParticleSpec&);

PackingRun run(const SoftParticleSpec& spec, PairKind kind, MakeProtocol make, const MeasurementPlan& plan) {
  const auto protocol = make(spec);
  const ShellPacking first = generate_shell_packing(spec, 9, 0);
  MeasurementState state;
  state.experiment = kind == PairKind::soft_solid
                         ? make_soft_solid(spec, first, protocol->damped_contacts())
                         : make_soft_soft(spec, first, generate_shell_packing(spec, 9, 1), protocol->damped_contacts());
  measure(state, plan, *protocol);
  return state.run;
}

void expect_same_bits(double a, double b, const char* what, std::size_t k) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b))
      << what << " of point " << k << ": " << a << ", " << b;
}

/// `factor` is that of E Rs^2, a power of two: the division is exact.
void expect_same_law(const PackingRun& a, const PackingRun& b, double factor) {
  ASSERT_EQ(a.normal.size(), b.normal.size());
  for (std::size_t k = 0; k < a.normal.size(); ++k) {
    expect_same_bits(a.normal[k].force, b.normal[k].force / factor, "force", k);
    expect_same_bits(a.normal[k].residual, b.normal[k].residual, "residual", k);
    expect_same_bits(a.normal[k].max_overlap, b.normal[k].max_overlap, "overlap", k);
  }
  ASSERT_EQ(a.tangential.size(), b.tangential.size());
  for (std::size_t k = 0; k < a.tangential.size(); ++k) {
    expect_same_bits(a.tangential[k].force_parallel, b.tangential[k].force_parallel / factor, "parallel force", k);
    expect_same_bits(a.tangential[k].force_perpendicular, b.tangential[k].force_perpendicular / factor,
                     "perpendicular force", k);
  }
  EXPECT_EQ(a.normal_cost.loop_passes, b.normal_cost.loop_passes);
  EXPECT_EQ(a.tangential_cost.loop_passes, b.tangential_cost.loop_passes);
}

void expect_scale_free(PairKind kind, MakeProtocol make, const MeasurementPlan& plan) {
  const PackingRun base = run(base_spec(), kind, make, plan);
  EXPECT_GT(base.normal.back().force, 0.0);
  expect_same_law(base, run(scaled(256.0, 1.0), kind, make, plan), 256.0);
  expect_same_law(base, run(scaled(1.0, 16.0), kind, make, plan), 256.0);
  expect_same_law(base, run(scaled(256.0, 1.0 / 16.0), kind, make, plan), 1.0);
}

const MeasurementPlan kSolid{{0.20, 0.35}, {0.35}, {-0.05, 0.05, 0.5}, 0.05, true};
const MeasurementPlan kSoft{{0.35, 0.60}, {0.60}, {0.05}, 0.05, false};

TEST(MeasurementScaling, DampedSoftSolid) { expect_scale_free(PairKind::soft_solid, damped, kSolid); }
TEST(MeasurementScaling, DampedSoftSoft) { expect_scale_free(PairKind::soft_soft, damped, kSoft); }
TEST(MeasurementScaling, LeastWorkSoftSolid) { expect_scale_free(PairKind::soft_solid, least_work, kSolid); }
TEST(MeasurementScaling, LeastWorkSoftSoft) { expect_scale_free(PairKind::soft_soft, least_work, kSoft); }
TEST(MeasurementScaling, PublishedSoftSolid) { expect_scale_free(PairKind::soft_solid, published, kSolid); }
TEST(MeasurementScaling, PublishedSoftSoft) { expect_scale_free(PairKind::soft_soft, published, kSoft); }

/// The defaults of the published protocol (speed, interval) scale by themselves as well.
TEST(MeasurementScaling, PublishedDefaultsFollowTheNaturalTime) {
  const auto make = [](const SoftParticleSpec&) {
    PublishedOptions options;
    options.stops = 0;
    return make_published_protocol(options);
  };
  expect_scale_free(PairKind::soft_solid, make, {{0.35}, {}, {}, 0.05, true});
}

/// Density sets the unit of time alone.
TEST(MeasurementScaling, DensityDropsOutOfTheDampedLaw) {
  SoftParticleSpec heavy = base_spec();
  heavy.density *= 256.0;
  expect_same_law(run(base_spec(), PairKind::soft_solid, damped, kSolid),
                  run(heavy, PairKind::soft_solid, damped, kSolid), 1.0);
}

TEST(MeasurementScaling, DensityDropsOutOfThePublishedLawWhenTimesFollow) {
  SoftParticleSpec heavy = base_spec();
  heavy.density *= 256.0;
  expect_same_law(run(base_spec(), PairKind::soft_solid, published, kSolid),
                  run(heavy, PairKind::soft_solid, published, kSolid), 1.0);
}

}  // namespace
}  // namespace softgrain
