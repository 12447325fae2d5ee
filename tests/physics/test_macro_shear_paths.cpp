// Undrained and direct-shear paths: what they hold, closed forms of a lattice, stress against the sum over contacts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/data/macro_result.h"
#include "common/dynamics/contact_tensors.h"
#include "macrosim/body_contacts.h"
#include "macrosim/compression.h"
#include "macrosim/constructed_packing.h"
#include "macrosim/test_protocol.h"
#include "microsim/shell_packing.h"
#include "tests/support/multi_contact.h"

namespace softgrain {
namespace {

MacroSpec grains(std::int64_t bodies) {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.bodies = bodies;
  spec.soft_share = 0.0;
  spec.start_pressure = 1e-4;
  spec.test = MacroTest::stages;
  return spec;
}

MacroStage& add_stage(MacroSpec& spec, StageKind kind, double strain, std::int64_t steps = 3) {
  spec.steps = steps;
  spec.increments_per_step = 2;
  spec.stages.push_back(short_stage(spec, kind, strain, steps));
  return spec.stages.back();
}

CompressionState start_of(const MacroSpec& spec, const MacroPacking& packing) {
  CompressionState state;
  state.macro = make_law_system(spec, packing, pair_soft_laws({}, {}, 0.0), 1.0);
  state.curve = begin_curve(spec, packing, state.macro, "law", 0);
  return state;
}

double volume_at(const MacroCurve& c, std::size_t k) {
  return (1.0 - c.strain_x[k]) * (1.0 - c.strain_y[k]) * (1.0 - c.strain_z[k]);
}

TEST(ShearPaths, UndrainedKeepsTheVolumeAndTheSidesAlike) {
  MacroSpec spec = grains(60);
  add_stage(spec, StageKind::isotropic, 0.02, 2);
  add_stage(spec, StageKind::undrained, 0.03, 3);
  const MacroPacking packing = make_packing(spec, 1, 0);
  CompressionState state = start_of(spec, packing);
  compress(state, spec);
  const MacroCurve& c = state.curve;
  ASSERT_TRUE(c.usable) << c.note;
  ASSERT_EQ(c.strain.size(), 6U);
  for (std::size_t k = 2; k < c.strain.size(); ++k) {
    EXPECT_NEAR(volume_at(c, k) / volume_at(c, 2), 1.0, 1e-12);
    EXPECT_NEAR(c.strain_x[k], c.strain_y[k], 1e-13);
  }
  EXPECT_NEAR(std::log((1.0 - c.strain_z[2]) / (1.0 - c.strain_z[5])), 0.03, 1e-12);
  EXPECT_GT(c.stress_axial.back(), c.stress_x.back());
  EXPECT_TRUE(c.shear_strain.empty());
}

TEST(ShearPaths, DirectShearKeepsTheNormalStressAndTheSides) {
  MacroSpec spec = grains(80);
  add_stage(spec, StageKind::isotropic, 0.02, 2);
  add_stage(spec, StageKind::direct_shear, 0.04, 4).axis[2] = {true, 0.0, 1};
  const MacroPacking packing = make_packing(spec, 1, 0);
  CompressionState state = start_of(spec, packing);
  compress(state, spec);
  const MacroCurve& c = state.curve;
  ASSERT_TRUE(c.usable) << c.note;
  ASSERT_EQ(c.strain.size(), 7U);
  for (std::size_t k = 2; k < c.strain.size(); ++k) {
    EXPECT_NEAR(c.stress_axial[k] / c.stress_axial[2], 1.0, spec.stages[1].tolerance) << k;
    EXPECT_NEAR(c.strain_x[k], c.strain_x[2], 1e-13);
    EXPECT_NEAR(c.strain_y[k], c.strain_y[2], 1e-13);
    EXPECT_NEAR(c.shear_strain[k], 0.01 * static_cast<double>(k - 2), 1e-14);
  }
  EXPECT_EQ(c.shear_strain[2], 0.0);
  EXPECT_GT(c.stress_xz.back(), 0.05 * c.stress_axial.back());
  EXPECT_LT(std::abs(c.stress_xy.back()), std::abs(c.stress_xz.back()));
  // Residual moments are small: the tensor is symmetric.
  EXPECT_LT(c.stress_asymmetry.back(), 0.02);
  EXPECT_GT(c.fabric_tensor[4].back(), 0.0);  // contacts turn towards the direction of compression
}

/// The whole tensor and the fabric at the end, contact by contact.
TEST(ShearPaths, TensorsAreSumsOverContacts) {
  MacroSpec spec = grains(60);
  add_stage(spec, StageKind::simple_shear, 0.03);
  const MacroPacking packing = make_packing(spec, 2, 0);
  CompressionState state = start_of(spec, packing);
  compress(state, spec);
  const MacroCurve& c = state.curve;
  ASSERT_TRUE(c.usable) << c.note;
  double stress[3][3] = {};
  double fabric[3][3] = {};
  const auto contacts = contact_records(state.macro.system);
  for (const auto& one : contacts)
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) {
        stress[k][l] += one.branch[k] * (one.normal_force * one.normal[l] + one.tangential_force[l]);
        fabric[k][l] += one.normal[k] * one.normal[l] / static_cast<double>(contacts.size());
      }
  const Vec3 size = box_high(state.macro.system, state.macro.box);
  const double volume = size[0] * size[1] * size[2];
  const double scale = c.stress_axial.back();
  EXPECT_NEAR(volume_at(c, c.strain.size() - 1), 1.0, 1e-12);
  EXPECT_NEAR(stress[2][2] / volume, c.stress_axial.back(), 1e-10 * scale);
  EXPECT_NEAR(stress[0][0] / volume, c.stress_x.back(), 1e-10 * scale);
  EXPECT_NEAR(0.5 * (stress[0][2] + stress[2][0]) / volume, c.stress_xz.back(), 1e-10 * scale);
  EXPECT_NEAR(0.5 * (stress[0][1] + stress[1][0]) / volume, c.stress_xy.back(), 1e-10 * scale);
  EXPECT_NEAR(0.5 * (stress[1][2] + stress[2][1]) / volume, c.stress_yz.back(), 1e-10 * scale);
  const double components[6] = {fabric[0][0], fabric[1][1], fabric[2][2], fabric[0][1], fabric[0][2], fabric[1][2]};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(c.fabric_tensor[k].back(), components[k], 1e-9) << k;
  for (const TensorColumns* t : {&c.fabric_tensor, &c.fabric_strong})
    EXPECT_NEAR((*t)[0].back() + (*t)[1].back() + (*t)[2].back(), 1.0, 1e-12);
  EXPECT_NEAR(c.fabric_tensor[2].back() - c.fabric_tensor[0].back(), c.fabric_bodies.back(), 1e-12);
  EXPECT_TRUE(c.inertial_number.empty());
}

/// A simple cubic lattice without friction that slides: rows along z tilt, and nothing else happens.
TEST(ShearPaths, ASlidingLatticeIsOnItsClosedForm) {
  constexpr double kRadius = 0.016;
  constexpr double kSpacing = 2.0 * kRadius * (1.0 - 1e-3);
  MacroSpec spec = grains(27);
  spec.friction = 0.0;
  spec.force_floor = 1e-9;
  spec.tolerance = 1e-6;
  add_stage(spec, StageKind::simple_shear, 0.02);
  MacroPacking packing;
  packing.high = Vec3{{3.0, 3.0, 3.0}} * kSpacing;
  for (int k = 0; k < 27; ++k)
    packing.bodies.push_back({Vec3{{k % 3 + 0.5, k / 3 % 3 + 0.5, k / 9 + 0.5}} * kSpacing, kRadius, false});
  CompressionState state = start_of(spec, packing);
  compress(state, spec);
  const MacroCurve& c = state.curve;
  ASSERT_TRUE(c.usable) << c.note;
  const double modulus = spec.youngs_modulus / (2.0 * (1.0 - spec.poisson_ratio * spec.poisson_ratio));
  const auto force = [&](double length) {
    return 4.0 / 3.0 * modulus * std::sqrt(0.5 * kRadius) * std::pow(2.0 * kRadius - length, 1.5);
  };
  for (std::size_t k = 0; k < c.strain.size(); ++k) {
    const double gamma = 0.02 * static_cast<double>(k) / 3.0;
    const double length = kSpacing * std::sqrt(1.0 + gamma * gamma);
    const double tilted = force(length) * kSpacing * kSpacing / length / (kSpacing * kSpacing * kSpacing);
    const double along = force(kSpacing) / (kSpacing * kSpacing);
    EXPECT_NEAR(c.stress_axial[k], tilted, 1e-8 * along) << k;
    EXPECT_NEAR(c.stress_y[k], along, 1e-8 * along) << k;
    EXPECT_NEAR(c.stress_xz[k], -gamma * tilted, 1e-8 * along) << k;  // rows lean the way the top went, against x
    EXPECT_NEAR(c.fabric_tensor[4][k], -gamma / (1.0 + gamma * gamma) / 3.0, 1e-9) << k;
    EXPECT_NEAR(c.fabric_tensor[1][k], 1.0 / 3.0, 1e-12) << k;
  }
}

/// A cell that slides by more than half its length is replaced by an equal one on the way: stress goes on as before,
/// and the shear strain is the whole way.
TEST(ShearPaths, SlidingGoesOnBeyondHalfTheLength) {
  MacroSpec spec = grains(60);
  add_stage(spec, StageKind::isotropic, 0.02, 1);
  for (int k = 0; k < 2; ++k) {
    MacroStage& stage = add_stage(spec, StageKind::direct_shear, 0.4, 8);
    stage.increments_per_step = 8;
    stage.axis[2] = {true, 0.0, 1};
  }
  const MacroPacking packing = make_packing(spec, 1, 0);
  CompressionState state = start_of(spec, packing);
  compress(state, spec);
  const MacroCurve& c = state.curve;
  ASSERT_TRUE(c.usable) << c.note;
  EXPECT_NEAR(c.shear_strain.back(), 0.8, 1e-12);
  const Matrix<3>& edges = state.macro.system.cell.edges;
  EXPECT_LE(std::abs(edges[0][2] / edges[0][0]), 0.51);
  for (std::size_t k = 6; k < c.strain.size(); ++k) {          // it flows: friction on planes of spheres with mu = 0.3
    EXPECT_GT(c.stress_xz[k] / c.stress_axial[k], 0.15) << k;  // few grains scatter
    EXPECT_LT(c.stress_xz[k] / c.stress_axial[k], 0.9) << k;
  }
}

/// Grains in shells slide in motion, at a rate: the points say its inertial number.
TEST(ShearPaths, TwinsSlideInMotionAndSayTheirInertialNumber) {
  MacroSpec spec = grains(60);
  spec.soft_share = 0.2;
  spec.twin.settle_time = 20.0;
  spec.steps = 2;
  spec.stages = {short_stage(spec, StageKind::isotropic, 0.03, 1), short_stage(spec, StageKind::direct_shear, 0.01, 2)};
  spec.stages[1].axis[2] = {true, 0.0, 1};
  const MacroPacking packing = make_macro_packing(spec, 1, 0);
  CompressionState state;
  state.macro = make_shelled_system(spec, packing, {generate_shell_packing(test::coarse_spec(), 1, 0)}, 1, 0);
  state.curve = begin_curve(spec, packing, state.macro, "shelled", 0);
  compress(state, spec);
  const MacroCurve& c = state.curve;
  ASSERT_TRUE(c.usable) << c.note;
  EXPECT_NEAR(c.stress_axial.back() / c.stress_axial[1], 1.0, spec.tolerance);
  EXPECT_GT(c.stress_xz.back(), 0.0);
  ASSERT_EQ(c.inertial_number.size(), 4U);
  EXPECT_EQ(c.inertial_number[0], 0.0);
  EXPECT_EQ(c.inertial_number[1], 0.0);  // compressed alike along all axes: no shear
  double diameter = 0.0;
  const auto& p = state.macro.system.particles;
  for (Slot i = 0; i < p.grains; ++i) diameter += 2.0 * p.sphere[at(i)].r / p.grains;
  const double rate =
      spec.twin.speed * std::sqrt(spec.youngs_modulus / spec.density) / (2.0 * state.macro.largest_radius);
  const double pressure = (c.stress_x.back() + c.stress_y.back() + c.stress_axial.back()) / 3.0;
  EXPECT_NEAR(c.inertial_number[3], rate * diameter * std::sqrt(spec.density / pressure), 1e-9 * c.inertial_number[3]);
}

TEST(ShearPaths, SlidingForthAndBackIsElasticWithoutFriction) {
  MacroSpec spec = grains(60);
  spec.friction = 0.0;
  spec.tolerance = 1e-6;
  add_stage(spec, StageKind::isotropic, 0.03, 2);
  add_stage(spec, StageKind::simple_shear, 1e-4, 1);
  MacroStage& back = add_stage(spec, StageKind::unload, 0.0, 1);
  back.record.way = StageKind::simple_shear;
  back.shear = -1e-4;
  const MacroPacking packing = make_packing(spec, 1, 0);
  CompressionState state = start_of(spec, packing);
  compress(state, spec);
  const MacroCurve& c = state.curve;
  ASSERT_TRUE(c.usable) << c.note;
  EXPECT_GT(c.stress_xz[3], c.stress_xz[2]);
  EXPECT_NEAR(c.stress_xz[4], c.stress_xz[2], 0.02 * (c.stress_xz[3] - c.stress_xz[2]));
  EXPECT_NEAR(c.shear_strain.back(), 0.0, 1e-16);
}

TEST(ShearPaths, GoOnFromEveryIncrementAndFromAFile) {
  MacroSpec spec = grains(60);
  add_stage(spec, StageKind::direct_shear, 0.02, 2).axis[2] = {true, 0.0, 0};
  add_stage(spec, StageKind::undrained, 0.01, 1);
  const MacroPacking packing = make_packing(spec, 3, 0);
  CompressionState whole = start_of(spec, packing);
  std::vector<CompressionState> saved;
  RunControl<CompressionState> control{.seconds = 0.0};
  control.save = [&](const CompressionState& s) { saved.push_back(s); };
  compress(whole, spec, control);
  ASSERT_TRUE(whole.curve.usable) << whole.curve.note;
  ASSERT_GT(saved.size(), 3U);
  for (CompressionState& state : saved) {
    compress(state, spec);
    EXPECT_EQ(whole.curve.stress_xz, state.curve.stress_xz);
    EXPECT_EQ(whole.curve.shear_strain, state.curve.shear_strain);
    EXPECT_EQ(whole.curve.stress_asymmetry, state.curve.stress_asymmetry);
    EXPECT_EQ(whole.curve.fabric_tensor, state.curve.fabric_tensor);
    EXPECT_EQ(whole.curve.fabric_strong, state.curve.fabric_strong);
  }
}

TEST(ShearPaths, ShortFormsHaveTheirStages) {
  MacroSpec spec = grains(60);
  spec.strain_end = 0.1;
  spec.preload = 0.02;
  for (const auto& [test, kind] : {std::pair{MacroTest::undrained, StageKind::undrained},
                                   {MacroTest::simple_shear, StageKind::simple_shear},
                                   {MacroTest::direct_shear, StageKind::direct_shear}}) {
    spec.test = test;
    const auto stages = stages_of(spec);
    ASSERT_EQ(stages.size(), 2U);
    EXPECT_EQ(stages[1].record.kind, kind);
    EXPECT_EQ(stages[1].axis[2].by_stress, kind == StageKind::direct_shear);
    EXPECT_EQ(stages[1].shear, slides(kind) ? 0.1 : 0.0);
    EXPECT_EQ(any_slides(stages), slides(kind));
    EXPECT_EQ(shear_at(stages, spec.preload_steps), 0.0);
    EXPECT_DOUBLE_EQ(shear_at(stages, recorded_points(spec) - 1), slides(kind) ? 0.1 : 0.0);
  }
}

}  // namespace
}  // namespace softgrain
