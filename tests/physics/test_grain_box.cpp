// Small packs of glass beads: generation reaches what it is asked for, loading answers like a granular solid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/statics/least_work.h"
#include "microsim/grain_box/analysis.h"
#include "microsim/grain_box/box_measure.h"
#include "microsim/grain_box/grain_box_run.h"
#include "microsim/grain_box/stepper.h"

namespace {

using namespace softgrain;

GrainBoxSpec small_spec() {
  GrainBoxSpec spec;
  spec.grains = 250;
  spec.generation.pressure = 10e6;
  spec.generation.increment = 2e-4;
  spec.loading.increments = {2e-4};
  spec.loading.end_strain = 0.006;
  spec.loading.probe_every = 10;
  return spec;
}

GrainBoxResult run(const GrainBoxSpec& spec) {
  GrainBoxResult result = run_grain_box(spec, 2, {}, {});
  EXPECT_TRUE(result.usable) << result.reason;
  return result;
}

/// One run for several tests: it takes seconds.
const GrainBoxResult& uniaxial() {
  static const GrainBoxResult result = run(small_spec());
  return result;
}

TEST(GrainBox, CompactionReachesThePressureWithFourContactsEverywhere) {
  const auto points = uniaxial().points_of(BoxPhase::compaction);
  ASSERT_FALSE(points.empty());
  const BoxPoint& end = *points.back();
  EXPECT_NEAR(end.pressure / 10e6, 1.0, 1.1e-3);
  EXPECT_GE(end.fewest_contacts, 4);
  EXPECT_EQ(end.rattlers, 0);
  EXPECT_GT(end.coordination, 5.0);
  EXPECT_LT(end.coordination, 7.0);
  // Isotropic within the scatter of a box seven grains wide.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(end.stress[k] / end.pressure, 1.0, 0.1);
}

/// What is left to the solver without inertia when the box is handed on: few steps, since the pack is near the pressure
/// and at rest. Handed on at a fifth of the pressure, packs of the size of the published ones went through long
/// rearrangements, and that of seed 1 found no equilibrium.
void first_equilibrium_is_near(const GrainBoxSpec& spec, std::uint64_t seed) {
  CompactedPack compacted = compact_until_stress(spec, make_loose_pack(spec, seed));
  const LeastWorkResult first = advance(compacted.pack, std::vector<Vec3>(kBoxWalls), spec.solver);
  EXPECT_TRUE(first.converged);
  EXPECT_LT(first.iterations, 300);
  EXPECT_NEAR(box_stress(compacted.pack).mean() / spec.generation.pressures().front(), 0.95, 0.2);
}

TEST(GrainBox, IsHandedOnNearThePressureAndAtRest) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) first_equilibrium_is_near(small_spec(), seed);
}

TEST(SlowGrainBox, ThePublishedPackIsHandedOnNearThePressureAndAtRest) {
  GrainBoxSpec spec;
  spec.grains = 2740;
  spec.generation.pressure = 4e6;
  spec.material.youngs_modulus_scatter = spec.material.poisson_ratio_scatter = 0.1;
  for (const std::uint64_t seed : {1U, 2U}) first_equilibrium_is_near(spec, seed);
}

/// What opposite walls differ by is borne by friction on the four others: nothing without it. The moment of the wall
/// forces about the centre is 0 but for the torsion of contacts with walls. Shear stresses by the first moments of
/// these forces are those of a pack of few grains: 40 contacts on a wall, whose centre of pressure is off the middle by
/// about L/sqrt(12 * 40), leave 5 % of its normal stress. The publication has two orders less than that between walls
/// that hold eleven times as many grains.
TEST(GrainBox, EveryStateIsInEquilibriumAndItsWallsAgree) {
  constexpr double kRounding = 1e-6;
  for (const BoxPoint& p : uniaxial().state.points) {
    EXPECT_LE(p.effort.residual, small_spec().solver.residual_tolerance);
    if (p.phase == BoxPhase::compaction) {
      EXPECT_LE(p.imbalance, kRounding);
    }
    EXPECT_LE(p.moment, p.phase == BoxPhase::compaction ? kRounding * p.pressure : 1e-3 * p.pressure);
    EXPECT_LE(p.shear, 0.05 * *std::max_element(p.stress.v.begin(), p.stress.v.end()));
  }
  Vec3 sum;
  double largest = 0.0;
  for (const Vec3& f : wall_forces(uniaxial().state.pack)) {
    sum += f;
    largest = std::max(largest, norm(f));
  }
  EXPECT_LT(norm(sum), kRounding * largest);
}

TEST(GrainBox, APackThatIsShearedIsSeen) {
  GrainPack pack = uniaxial().state.pack;
  const double before = box_stress(pack).shear / box_stress(pack).mean();
  const Vec3 lengths = box_lengths(pack);
  std::vector<Vec3> drag(kBoxWalls);  // rough walls -z +z along x, by two hundredths of the height in steps
  drag[4] = {{-1e-4 * lengths[2], 0.0, 0.0}};
  drag[5] = {{1e-4 * lengths[2], 0.0, 0.0}};
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(advance(pack, drag, small_spec().solver).converged);
  const BoxStress stress = box_stress(pack);
  EXPECT_GT(stress.shear, (before + 0.05) * stress.mean());
  EXPECT_LT(stress.moment, 2e-3 * stress.mean());
}

TEST(GrainBox, FrictionPhaseEndsBySlidingThatHasSaturated) {
  const auto points = uniaxial().points_of(BoxPhase::friction);
  ASSERT_GE(points.size(), 20U);
  const auto mean_share = [&](std::size_t first) {
    double sum = 0.0;
    for (std::size_t k = first; k < first + 10; ++k) sum += 0.1 * points[k]->sliding_share;
    return sum;
  };
  const double last = mean_share(points.size() - 10);
  EXPECT_NEAR(last, mean_share(points.size() - 20), small_spec().generation.saturation);
  EXPECT_GT(last, 2.0 * points.front()->sliding_share);
  // G falls first (contacts begin to slide), and grows in the end.
  const auto smallest = std::min_element(points.begin(), points.end(), [](const BoxPoint* a, const BoxPoint* b) {
    return a->shear_modulus < b->shear_modulus;
  });
  EXPECT_LT((*smallest)->shear_modulus, points.front()->shear_modulus);
}

/// K and G of every interval are Hooke's [QS 2.3]. Their size: sphere packs have K of the effective medium and, because
/// grains rearrange under shear, a third to two thirds of its G (Makse, Gland, Johnson, Schwartz 1999); and they lie in
/// the printed ranges, K 0.8 to 3 GPa and G 0.6 to 3 GPa.
TEST(GrainBox, ModuliAreHookesAndOfTheRightSize) {
  const std::vector<const BoxPoint*> points = uniaxial().points_of(BoxPhase::loading);
  ASSERT_GE(points.size(), 20U);
  const BoxPoint* before = uniaxial().points_of(BoxPhase::friction).back();
  for (const BoxPoint* p : points) {
    const Vec3 ds = p->stress - before->stress;
    const double lateral = 0.5 * (ds[0] + ds[1]);
    const double de = p->strain[2] - before->strain[2];
    EXPECT_NEAR(p->bulk * 3.0 * de / (ds[2] + 2.0 * lateral), 1.0, 1e-9);
    EXPECT_NEAR(p->shear_modulus * 2.0 * de / (ds[2] - lateral), 1.0, 1e-9);
    before = p;
    EXPECT_GT(p->bulk, 0.9 * p->bulk_medium);
    EXPECT_LT(p->bulk, 1.1 * p->bulk_medium);
    EXPECT_GT(p->shear_modulus, 0.33 * p->shear_medium);
    EXPECT_LT(p->shear_modulus, 0.67 * p->shear_medium);
    EXPECT_GT(p->bulk, 0.8e9);
    EXPECT_LT(p->bulk, 3e9);
    EXPECT_GT(p->shear_modulus, 0.6e9);
    EXPECT_LT(p->shear_modulus, 3e9);
  }
}

TEST(GrainBox, ElasticProbeIsStifferThanAnIntervalInWhichContactsSlide) {
  int probed = 0;
  for (const BoxPoint* p : uniaxial().points_of(BoxPhase::loading)) {
    if (!std::isfinite(p->shear_probe)) continue;
    ++probed;
    EXPECT_GT(p->shear_probe, p->shear_modulus);
    EXPECT_GT(p->bulk_probe, p->bulk);
    EXPECT_LT(p->bulk_probe, 2.0 * p->bulk);
  }
  EXPECT_GE(probed, 2);
}

/// Friction without limit once left increments without equilibrium, and a minimiser that went round in circles.
TEST(GrainBox, EndlessFrictionComesToRest) {
  GrainBoxSpec spec = small_spec();
  spec.grains = 400;
  spec.generation.increment = 1e-4;
  spec.loading.increments = {1e-4};
  spec.loading.end_strain = std::numeric_limits<double>::infinity();
  spec.loading.end_stress = 20e6;
  spec.friction = std::numeric_limits<double>::infinity();
  spec.walls.friction = 0.0;
  const GrainBoxResult result = run_grain_box(spec, 1, {}, {});
  ASSERT_TRUE(result.usable) << result.reason;
  EXPECT_GE(result.state.points.back().pressure, 20e6);
  EXPECT_LT(result.state.points.back().sliding_share, 0.05);
}

TEST(GrainBox, IsotropicLoadingIsIsotropicWithinScatter) {
  GrainBoxSpec spec = small_spec();
  spec.friction = 0.0;
  spec.walls.friction = 0.0;
  spec.loading.test = "isotropic";
  spec.loading.strain_rate = {{1.0, 1.0, 1.0}};
  spec.loading.end_strain = 0.002;
  const GrainBoxResult result = run(spec);
  for (const BoxPoint* p : result.points_of(BoxPhase::loading)) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(p->stress[k] / p->pressure, 1.0, 0.1);
    // Smooth walls bear nothing along themselves, so that opposite ones agree to the residual.
    EXPECT_LT(p->moment, 1e-5 * p->pressure);
    EXPECT_LT(p->imbalance, 1e-5);
    // Grains that may slide move otherwise than the strain, which can only make the pack softer than the medium.
    EXPECT_GT(p->bulk, 0.7 * p->bulk_medium);
    EXPECT_LT(p->bulk, p->bulk_medium);
    EXPECT_TRUE(std::isnan(p->shear_modulus));
    EXPECT_TRUE(std::isnan(p->sliding_share));
    // Without friction nothing is lost: the elastic probe is the modulus, but for contacts that open or close.
    if (std::isfinite(p->bulk_probe)) {
      EXPECT_NEAR(p->bulk_probe / p->bulk, 1.0, 0.1);
    }
  }
}

TEST(GrainBox, TheServoHoldsTheLateralStress) {
  GrainBoxSpec spec = small_spec();
  spec.loading.test = "triaxial";
  spec.loading.control = {AxisControl::stress, AxisControl::stress, AxisControl::strain};
  const Vec3 stress = uniaxial().points_of(BoxPhase::friction).back()->stress;
  spec.loading.stress = {{0.9 * stress[0], 0.9 * stress[0], 0.0}};
  spec.loading.end_strain = 0.003;
  const GrainBoxResult result = run(spec);
  const auto points = result.points_of(BoxPhase::loading);
  ASSERT_GE(points.size(), 10U);
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(points.back()->stress[k] / spec.loading.stress[k], 1.0, 2.0 * spec.loading.stress_tolerance);
  EXPECT_LT(points.back()->strain[0], points.front()->strain[0]);  // the pack widens
}

/// The same grains in the same places, but for what pressing them on moves; a pack that grows to the higher pressure by
/// itself is another arrangement. At equal stress the one from the lower pressure has fewer contacts.
TEST(GrainBox, AHigherPressureGoesOnFromThePackOfTheLowerOne) {
  GrainBoxSpec low = small_spec();
  low.generation.pressure = 4e6;
  GrainBoxSpec high = low;
  high.generation.pressure = 20e6;
  high.generation.lower_pressures = {4e6};
  for (GrainBoxSpec* spec : {&low, &high}) {
    spec->friction = spec->walls.friction = 0.0;  // (a), and one state more
    spec->loading.end_strain = 1e-4;
    spec->loading.increments = {1e-4};
  }
  const GrainBoxResult a = run(low);
  const GrainBoxResult b = run(high);
  const auto first = a.points_of(BoxPhase::compaction);
  const auto both = b.points_of(BoxPhase::compaction);
  ASSERT_GT(both.size(), first.size() + 1);
  for (std::size_t k = 0; k < first.size(); ++k) EXPECT_EQ(first[k]->pressure, both[k]->pressure) << k;
  EXPECT_NEAR(first.back()->pressure / 4e6, 1.0, 1.1e-3);
  EXPECT_NEAR(both.back()->pressure / 20e6, 1.0, 1.1e-3);
  EXPECT_EQ(a.state.stress_free_lengths, b.state.stress_free_lengths);
  EXPECT_GT(both.back()->coordination, first.back()->coordination);
  EXPECT_EQ(b.state.pressures_met, 2);
}

}  // namespace
