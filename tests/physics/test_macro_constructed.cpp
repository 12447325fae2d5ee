// Macro scenes by construction, the shear test, the free twin, and what engines have in common.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/dynamics/force_pass.h"
#include "macrosim/body_contacts.h"
#include "macrosim/compression.h"
#include "macrosim/constructed_packing.h"
#include "microsim/shell_packing.h"

namespace softgrain {
namespace {

MacroSpec small_scene() {
  MacroSpec spec;
  spec.construction = Construction::voids;
  spec.bodies = 25;
  spec.soft_share = 0.35;
  spec.soft_radius_max = 0.012;
  spec.soft_polydispersity = 2.0;
  spec.steps = 3;
  spec.increments_per_step = 1;
  spec.strain_end = 0.06;
  return spec;
}

std::vector<ShellPacking> few_grains() {
  SoftParticleSpec spec;
  spec.trials = 200;
  spec.polydispersity = 3.0;
  return {generate_shell_packing(spec, 3, 0), generate_shell_packing(spec, 3, 1)};
}

double worst_overlap(const MacroPacking& p) {
  double worst = 0.0;
  for (std::size_t i = 0; i < p.bodies.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double gap = norm(p.bodies[i].x - p.bodies[j].x) - p.bodies[i].r - p.bodies[j].r;
      worst = std::max(worst, -gap / std::min(p.bodies[i].r, p.bodies[j].r));
    }
  return worst;
}

TEST(MacroConstructed, SoftParticlesFillTheVoidsToTheShareAskedFor) {
  MacroSpec spec = small_scene();
  spec.bodies = 60;
  for (const double share : {0.0, 0.2, 0.35, 0.5}) {
    spec.soft_share = share;
    const MacroPacking packing = make_packing(spec, 3, 0);
    const SceneFacts facts = describe(packing, {});
    EXPECT_EQ(facts.solid, 60);
    EXPECT_NEAR(facts.soft_share, share, 0.02);
    EXPECT_GT(facts.body_fraction, 0.48);
    EXPECT_LT(facts.body_fraction, 0.68);
    EXPECT_LT(worst_overlap(packing), 0.02);
    if (share > 0.0) {
      EXPECT_LE(facts.soft_radius_high, 0.012 * (1.0 + 1e-12));
      EXPECT_GE(facts.soft_radius_low, 0.006);
    }
  }
}

TEST(MacroConstructed, SeedAndSampleAloneDecide) {
  const MacroSpec spec = small_scene();
  const auto same = [](const MacroPacking& a, const MacroPacking& b) {
    bool equal = a.low == b.low && a.high == b.high && a.bodies.size() == b.bodies.size();
    for (std::size_t k = 0; equal && k < a.bodies.size(); ++k)
      equal = a.bodies[k].x == b.bodies[k].x && a.bodies[k].r == b.bodies[k].r && a.bodies[k].soft == b.bodies[k].soft;
    return equal;
  };
  EXPECT_TRUE(same(make_packing(spec, 3, 0), make_packing(spec, 3, 0)));
  EXPECT_FALSE(same(make_packing(spec, 3, 0), make_packing(spec, 3, 1)));
}

TEST(MacroConstructed, AShareThatDoesNotFitIsRefusedWithWhatFits) {
  MacroSpec spec = small_scene();
  spec.solid_fill = 0.45;
  spec.soft_share = 0.5;
  spec.soft_polydispersity = 1.2;
  try {
    (void)make_packing(spec, 3, 0);
    FAIL() << "half of the volume in voids that cannot hold it";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("hold at most"), std::string::npos) << e.what();
  }
}

TEST(MacroConstructed, FactsCountTheContents) {
  const MacroPacking packing = make_packing(small_scene(), 3, 0);
  const auto contents = few_grains();
  const SceneFacts facts = describe(packing, contents);
  EXPECT_EQ(facts.inner_grains, make_free_system(small_scene(), packing, contents, 3, 0).inner_grains);
  EXPECT_LT(facts.solid_fraction, facts.body_fraction);
  EXPECT_GT(facts.solid_fraction, facts.body_fraction * (1.0 - facts.soft_share));
  EXPECT_GT(facts.exponent.exponent, 1.0);
  EXPECT_GT(facts.largest_over_smallest, 2.0);
}

TEST(MacroConstructed, TheFreeTwinHoldsTheGrainsOfTheShelledOne) {
  const MacroSpec spec = small_scene();
  const MacroPacking packing = make_packing(spec, 3, 0);
  const auto contents = few_grains();
  const MacroSystem shelled = make_shelled_system(spec, packing, contents, 3, 0);
  const MacroSystem free = make_free_system(spec, packing, contents, 3, 0);
  EXPECT_EQ(free.system.particles.shells, 0);
  ASSERT_EQ(free.system.particles.grains, shelled.system.particles.grains);
  for (std::size_t u = 0; u < static_cast<std::size_t>(free.system.particles.grains); ++u) {
    EXPECT_EQ(free.system.particles.sphere[u].x, shelled.system.particles.sphere[u].x);
    EXPECT_EQ(free.system.particles.sphere[u].r, shelled.system.particles.sphere[u].r);
    EXPECT_EQ(free.body[u], shelled.body[u]);
  }
  EXPECT_EQ(free.largest_radius, shelled.largest_radius);
  EXPECT_EQ(static_cast<Slot>(free.body.size()), free.system.particles.size());
  EXPECT_EQ(static_cast<Slot>(shelled.body.size()), shelled.system.particles.size());
}

CompressionState tested(const MacroSpec& spec, const MacroPacking& packing, MacroSystem macro,
                        const std::string& engine) {
  CompressionState state;
  state.curve = begin_curve(spec, packing, macro, engine, 0);
  state.macro = std::move(macro);
  compress(state, spec);
  return state;
}

MacroSpec shear_of_solids() {
  MacroSpec spec = small_scene();
  spec.soft_share = 0.0;
  spec.test = MacroTest::shear;
  spec.preload = 0.03;
  spec.preload_steps = 2;
  return spec;
}

/// Without soft particles all engines are the same system, relaxed alike.
TEST(MacroConstructed, WithoutSoftParticlesLawsAndTwinsAgreeToTheLastBit) {
  MacroSpec spec = shear_of_solids();
  spec.twin.relaxation = TwinRelaxation::damped;
  const MacroPacking packing = make_packing(spec, 3, 0);
  const MacroCurve law = tested(spec, packing, make_law_system(spec, packing, {}, 1.0), "pair").curve;
  const MacroCurve shelled = tested(spec, packing, make_shelled_system(spec, packing, {}, 3, 0), "shelled").curve;
  const MacroCurve free = tested(spec, packing, make_free_system(spec, packing, {}, 3, 0), "free").curve;
  ASSERT_TRUE(law.usable) << law.note;
  EXPECT_GT(law.stress_axial.back(), 0.0);
  for (const MacroCurve* twin : {&shelled, &free}) {
    EXPECT_EQ(law.stress_axial, twin->stress_axial);
    EXPECT_EQ(law.stress_x, twin->stress_x);
    EXPECT_EQ(law.fabric_bodies, twin->fabric_bodies);
    EXPECT_EQ(law.coordination_bodies, twin->coordination_bodies);
    EXPECT_EQ(law.body_forces, twin->body_forces);
    EXPECT_EQ(law.cost.contact_evaluations, twin->cost.contact_evaluations);
  }
  for (std::size_t k = 0; k < law.fabric.size(); ++k)
    EXPECT_NEAR(law.fabric[k], law.fabric_bodies[k], 1e-12);  // every grain is a body; sums in another order
}

TEST(MacroConstructed, ShearKeepsTheVolumeAndLoadsTheShortenedAxisMost) {
  const MacroSpec spec = shear_of_solids();
  const MacroPacking packing = make_packing(spec, 3, 0);
  const CompressionState end = tested(spec, packing, make_law_system(spec, packing, {}, 1.0), "pair");
  const MacroCurve& c = end.curve;
  const double shrunk = 1.0 - spec.preload;
  const Vec3 before = packing.size();
  const Vec3 after = box_high(end.macro.system, end.macro.box) - box_low(end.macro.system, end.macro.box);
  EXPECT_NEAR(after[0], before[0] * shrunk * std::exp(spec.strain_end), 1e-12);
  EXPECT_NEAR(after[1], before[1] * shrunk, 1e-12);
  EXPECT_NEAR(after[2], before[2] * shrunk * std::exp(-spec.strain_end), 1e-12);
  ASSERT_EQ(static_cast<std::int64_t>(c.strain.size()), recorded_points(spec));
  EXPECT_DOUBLE_EQ(c.strain.front(), -spec.preload);
  EXPECT_DOUBLE_EQ(c.strain[2], 0.0);
  EXPECT_DOUBLE_EQ(c.strain.back(), spec.strain_end);
  EXPECT_TRUE(std::is_sorted(c.strain.begin(), c.strain.end()));
  EXPECT_GT(c.stress_deviator.back(), 0.0);
  for (std::size_t k = 0; k < c.strain.size(); ++k) {
    EXPECT_DOUBLE_EQ(c.stress_deviator[k], c.stress_axial[k] - c.stress_x[k]);
    EXPECT_DOUBLE_EQ(c.stress_lateral[k], 0.5 * (c.stress_x[k] + c.stress_y[k]));
  }
}

/// Force on the walls, summed body by body, is the force that the walls report; forces between bodies times branches
/// give the same stress in equilibrium.
TEST(MacroConstructed, ContactsBetweenBodiesCarryTheWallStress) {
  MacroSpec spec = small_scene();
  spec.bodies = 12;
  spec.strain_end = 0.25;
  const MacroPacking packing = make_packing(spec, 3, 0);
  const auto contents = few_grains();
  for (const bool shelled : {true, false}) {
    const auto make = shelled ? make_shelled_system : make_free_system;
    const CompressionState end =
        tested(spec, packing, make(spec, packing, contents, 3, 0), shelled ? "shelled" : "free");
    const MacroSystem& m = end.macro;
    const auto contacts = contact_records(m.system);
    const auto between = body_contacts(m, contacts);
    std::array<double, 6> on_wall{};
    Vec3 stress{};
    double scale = 0.0;
    for (const BodyContact& c : between) {
      if (c.b >= m.bodies) on_wall[static_cast<std::size_t>(c.b - m.bodies)] += c.normal_force;
      for (int k = 0; k < 3; ++k) stress[k] += c.force[k] * c.branch[k];
    }
    for (const ContactRecord<3>& c : contacts) scale = std::max(scale, c.normal_force);
    for (std::size_t w = 0; w < 6; ++w) {
      const Slot plane = m.box.plane[w];
      const double reported =
          -dot(Vec3(m.system.particles.force[static_cast<std::size_t>(plane)]), m.system.particles.normal_of(plane));
      EXPECT_NEAR(on_wall[w], reported, 1e-9 * scale);
    }
    if (!shelled) continue;  // stresses of the free twin are hardly above the floor of the relaxation here
    const Vec3 size = box_high(m.system, m.box) - box_low(m.system, m.box);
    const Vec3 wall = box_stress(m.system, m.box);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(stress[k] / (size[0] * size[1] * size[2]), wall[k], 0.05 * wall[2]) << "axis " << k;
  }
}

}  // namespace
}  // namespace softgrain
