// Packings prepared under pressure against those of the slow way, in steps of the box: the same statistics.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <functional>

#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/residual.h"
#include "macrosim/body_contacts.h"
#include "macrosim/compression.h"
#include "macrosim/preparation.h"
#include "macrosim/pressed_box.h"

namespace softgrain {
namespace {

MacroSpec solids(std::int64_t bodies) {
  MacroSpec spec;
  spec.bodies = bodies;
  spec.soft_share = 0.0;
  spec.friction = 0.0;
  return spec;
}

MacroSystem as_grains(const MacroSpec& spec, const MacroPacking& packing) {
  MacroSystem macro = make_law_system(spec, packing, {}, 1.0);
  force_pass(macro.system, 0.0);
  return macro;
}

/// Another, slower way: the box shrinks in steps and all is relaxed after each; a step that
/// overshoots the pressure is taken back and halved.
MacroSystem compacted_in_steps(const MacroSpec& spec, std::uint64_t seed) {
  MacroSpec loose = spec;
  loose.preparation = Preparation::lammps;
  const MacroPacking packing = make_macro_packing(loose, seed, 0);
  const double pressure = spec.start_pressure * spec.youngs_modulus;
  const Vec3 size = packing.size();
  DampedOptions options;
  options.tolerance = 1e-3;
  options.max_passes = 50000;
  options.force_floor = 1e-2 * pressure * size[0] * size[1] / static_cast<double>(packing.bodies.size());
  MacroSystem macro = as_grains(spec, packing);
  double step = 0.02;
  for (int round = 0; round < 400; ++round) {
    const System3 before = macro.system;
    strain_box(macro.system, macro.box, {{step, step, step}});
    DampedRelaxation<3>(options).relax(macro.system);
    const Vec3 stress = box_stress(macro.system, macro.box);
    const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
    if (mean < pressure) continue;
    if (mean < 1.5 * pressure) return macro;
    macro.system = before;
    step *= 0.5;
  }
  ADD_FAILURE() << "not jammed in steps";
  return macro;
}

/// Of many samples.
struct PackingStatistics {
  std::vector<double> fraction, coordination, fabric, anisotropy;

  void add(const MacroSystem& m) {
    const auto& p = m.system.particles;
    const Vec3 size = box_high(m.system, m.box) - box_low(m.system, m.box);
    double volume = 0.0;
    for (std::size_t u = 0; u < at(p.grains); ++u) volume += 4.0 / 3.0 * M_PI * std::pow(p.sphere[u].r, 3);
    fraction.push_back(volume / (size[0] * size[1] * size[2]));
    const auto contacts = contact_records(m.system);
    coordination.push_back(2.0 * static_cast<double>(contacts.size()) / p.grains);
    fabric.push_back(fabric_anisotropy(m, contacts));
    const Vec3 stress = box_stress(m.system, m.box);
    anisotropy.push_back((stress[2] - stress[0]) / (stress[0] + stress[1] + stress[2]));
  }
};

/// The means agree within three standard errors, which say something themselves.
void expect_same(const std::vector<double>& a, const std::vector<double>& b, double largest_error, const char* what) {
  const MeanError one = mean_error(a);
  const MeanError other = mean_error(b);
  const double error = std::hypot(one.error, other.error);
  EXPECT_LT(error, largest_error) << what;
  EXPECT_LT(std::abs(one.mean - other.mean), 3.0 * error) << what << ": " << one.mean << " and " << other.mean;
}

void compare_with_steps(std::int64_t bodies, std::uint64_t samples, double fraction_error, double coordination_error) {
  MacroSpec spec = solids(bodies);
  spec.protocol.tolerance = 1e-3;  // as in the steps: contacts that bear next to nothing count as well
  PackingStatistics pressed;
  PackingStatistics stepwise;
  for (std::uint64_t seed = 1; seed <= samples; ++seed) {
    pressed.add(as_grains(spec, make_macro_packing(spec, seed, 0)));
    stepwise.add(compacted_in_steps(spec, seed));
  }
  expect_same(pressed.fraction, stepwise.fraction, fraction_error, "solid fraction");
  expect_same(pressed.coordination, stepwise.coordination, coordination_error, "coordination");
  expect_same(pressed.fabric, stepwise.fabric, 0.03, "fabric");
  expect_same(pressed.anisotropy, stepwise.anisotropy, 0.03, "anisotropy of stress");
}

TEST(MacroPreparation, HasTheStatisticsOfSteps) { compare_with_steps(60, 20, 0.004, 0.13); }
TEST(SlowMacroPreparation, HasTheStatisticsOfSteps) {
  compare_with_steps(250, 20, 0.0015, 0.06);
  compare_with_steps(1000, 6, 0.0015, 0.06);
}

/// Every body at rest, walls and inside at the pressure asked for, over the range that can be asked for.
TEST(MacroPreparation, EndsInBalanceAtThePressureAskedFor) {
  for (const double start : {1e-6, 1e-5, 1e-3, 9e-3})
    for (const double share : {0.0, 0.5}) {
      MacroSpec spec = solids(80);
      spec.start_pressure = start;
      spec.soft_share = share;
      const double pressure = start * spec.youngs_modulus;
      MacroPacking packing = make_macro_packing(spec, 4, 0);
      for (MacroBody& b : packing.bodies) b.soft = false;
      const MacroSystem macro = as_grains(spec, packing);
      const Residual r = residual(macro.system);
      EXPECT_LT(r.relative(0.0), 1.1 * spec.protocol.tolerance) << start;
      const Vec3 wall = box_stress(macro.system, macro.box);
      const Vec3 inside = contact_stress(macro.system, macro.box);
      EXPECT_NEAR(wall[0] + wall[1] + wall[2], 3.0 * pressure, 1.1 * spec.protocol.tolerance * pressure) << start;
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(inside[k], wall[k], 1.5 * spec.protocol.tolerance * pressure) << start << ", " << k;
      EXPECT_EQ(packing.size()[0], packing.size()[1]) << "all sides alike";
    }
}

/// With balance "own-load" a wide span is at rest when every grain is, by the forces that it bears itself.
TEST(MacroPreparation, OfAWideSpanEndsInTheBalanceOfEveryGrain) {
  MacroSpec spec = solids(1500);
  spec.solid_polydispersity = 12.0;
  spec.protocol.tolerance = 3e-3;
  spec.start_pressure = 1e-4;
  const MacroPacking by_mean = make_macro_packing(spec, 2, 0);
  spec.balance = Balance::own_load;
  const MacroPacking by_own = make_macro_packing(spec, 2, 0);
  EXPECT_NE(by_own.high[0], by_mean.high[0]);
  EXPECT_NEAR(by_own.solid_fraction(), by_mean.solid_fraction(), 5e-3) << "a relaxation along another way";
  const MacroSystem macro = as_grains(spec, by_own);
  const auto& p = macro.system.particles;
  std::vector<double> borne(static_cast<std::size_t>(p.size()), 0.0);
  double mean = 0.0;
  const auto contacts = contact_records(macro.system);
  for (const ContactRecord<3>& c : contacts) {
    borne[at(c.i)] += c.normal_force;
    borne[at(c.j)] += c.normal_force;
    mean += c.normal_force / static_cast<double>(contacts.size());
  }
  const double pressure = spec.start_pressure * spec.youngs_modulus;
  const ForceScale scale{mean, pressure};
  EXPECT_LT(worst_net_force(p, scale, 0.0), 1.1 * spec.protocol.tolerance * mean);
  double own = 0.0, expected = 0.0;
  for (std::size_t u = 0; u < at(p.grains); ++u) {
    if (p.sphere[u].r < 0.5 * spec.solid_radius_max) continue;
    own += borne[u] / 6.0;
    expected += scale.of<3>(p.sphere[u].r);
  }
  EXPECT_NEAR(own / expected, 1.3, 0.3) << "a grain bears the mean stress over the solid fraction";
}

/// Forty passes towards half the pressure.
System3 pressed(MacroSystem macro, double pressure, int threads) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  DampedOptions options;
  options.max_passes = 40;
  PressedBox walls(macro.box, {.by_stress = {true, true, true}, .stress = Vec3{{pressure, pressure, pressure}}});
  (void)DampedRelaxation<3>(options).relax(macro.system, walls);
  omp_set_num_threads(before);
  return macro.system;
}

TEST(MacroPreparation, IsTheSameForAnyNumberOfThreads) {
  MacroSpec spec = solids(1900);
  spec.start_pressure = 9e-3;  // soon at rest
  const MacroSystem start = as_grains(spec, make_macro_packing(spec, 1, 0));
  ASSERT_GT(start.system.contacts.size(), 8000) << "too small for the parallel path";
  const double half = 0.5 * spec.start_pressure * spec.youngs_modulus;
  const System3 one = pressed(start, half, 1);
  EXPECT_NE(one.particles.sphere[0].x, start.system.particles.sphere[0].x);
  for (const int threads : {2, 4}) {
    const System3 many = pressed(start, half, threads);
    for (std::size_t u = 0; u < one.particles.sphere.size(); ++u)
      ASSERT_EQ(many.particles.sphere[u].x, one.particles.sphere[u].x) << u << " with " << threads;
  }
}

MacroSpec prepared_by(Preparation preparation, std::int64_t bodies) {
  MacroSpec spec = solids(bodies);
  spec.preparation = preparation;
  spec.protocol = protocol_of(preparation, 0.3);
  return spec;
}

/// Solid fraction and coordination of samples; every one must bear the pressure.
struct NamedStatistics {
  MeanError fraction, coordination;
};

NamedStatistics statistics_of(MacroSpec spec, std::uint64_t samples) {
  Tally fraction;
  Tally coordination;
  for (std::uint64_t seed = 1; seed <= samples; ++seed) {
    const MacroPacking packing = make_macro_packing(spec, seed, 0);
    const MacroSystem macro = as_grains(solids(spec.bodies), packing);
    const Vec3 wall = box_stress(macro.system, macro.box);
    const double pressure = spec.start_pressure * spec.youngs_modulus;
    EXPECT_NEAR(wall[0] + wall[1] + wall[2], 3.0 * pressure, 1.1 * spec.protocol.tolerance * pressure) << seed;
    fraction.add(packing.solid_fraction());
    coordination.add(2.0 * static_cast<double>(contact_records(macro.system).size()) /
                     static_cast<double>(spec.bodies));
    EXPECT_GT(packing.cost.loop_passes, 0);
    EXPECT_GT(packing.cost.contact_evaluations, packing.cost.loop_passes);
  }
  return {fraction.statistics(), coordination.statistics()};
}

/// Friction lets bodies jam loosely and with fewer contacts.
TEST(MacroPreparation, FastIsLooseForItsFriction) {
  const NamedStatistics smooth = statistics_of(prepared_by(Preparation::frictionless, 120), 8);
  MacroSpec with_friction = prepared_by(Preparation::fast, 120);
  with_friction.wall_friction = 0.3;  // every fourth body is at a wall
  const NamedStatistics rough = statistics_of(with_friction, 8);
  EXPECT_LT(std::hypot(smooth.fraction.error, rough.fraction.error), 0.008);
  EXPECT_LT(rough.fraction.mean, smooth.fraction.mean - 0.03);
  EXPECT_GT(rough.fraction.mean, smooth.fraction.mean - 0.09);
  EXPECT_LT(rough.coordination.mean, smooth.coordination.mean - 1.0);
}

/// Of bodies that fit into the voids of the others: coarse ones and fines of a sixth of their radius.
TEST(MacroPreparation, DenseIsDenserWhereFinesFitTheVoids) {
  MacroSpec loose = prepared_by(Preparation::frictionless, 1040);
  std::vector<double> radii(40, 0.016);
  radii.insert(radii.end(), 1000, 0.016 / 6.0);
  loose.solid_sizes = Grading::list(radii);
  MacroSpec dense = loose;
  dense.preparation = Preparation::dense;
  dense.protocol = protocol_of(Preparation::dense, 0.3);
  dense.protocol.coarse_share = 0.88;
  const NamedStatistics a = statistics_of(loose, 4);
  const NamedStatistics b = statistics_of(dense, 4);
  EXPECT_GT(b.fraction.mean, a.fraction.mean) << a.fraction.mean << " and " << b.fraction.mean;
  EXPECT_LT(b.fraction.mean, 0.9);
}

/// What the default tolerance leaves undone is nothing that the volume would know of.
TEST(MacroPreparation, ATighterToleranceLeavesTheVolume) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    MacroSpec spec = solids(250);
    const double loose = make_macro_packing(spec, seed, 0).solid_fraction();
    spec.protocol.tolerance = 1e-4;
    EXPECT_NEAR(make_macro_packing(spec, seed, 0).solid_fraction(), loose, 5e-4);
  }
}

TEST(MacroPreparation, EveryPartOfAProtocolChangesThePacking) {
  const auto change = [](Preparation preparation, const std::function<void(PreparationProtocol&)>& how) {
    MacroSpec spec = prepared_by(preparation, 40);
    const MacroPacking before = make_macro_packing(spec, 1, 0);
    how(spec.protocol);
    return make_macro_packing(spec, 1, 0).high[0] != before.high[0];
  };
  for (const Preparation p : {Preparation::frictionless, Preparation::fast, Preparation::dense}) {
    EXPECT_TRUE(change(p, [](PreparationProtocol& q) { q.start_fraction = 0.2; })) << to_string(p);
    EXPECT_TRUE(change(p, [](PreparationProtocol& q) { q.friction += 0.2; })) << to_string(p);
    EXPECT_TRUE(change(p, [](PreparationProtocol& q) { q.tolerance = 1e-3; })) << to_string(p);
    EXPECT_TRUE(change(p, [](PreparationProtocol& q) { q.first_pressure *= 4.0; })) << to_string(p);
    EXPECT_TRUE(change(p, [](PreparationProtocol& q) { q.inertial_number += 0.05; })) << to_string(p);
  }
  EXPECT_TRUE(change(Preparation::fast, [](PreparationProtocol& q) { q.restitution = 0.8; }));
  EXPECT_TRUE(change(Preparation::dense, [](PreparationProtocol& q) { q.coarse_share = 0.5; }));
}

TEST(MacroPreparation, WhatCannotBePreparedSaysHowFarItCame) {
  for (const Preparation p : {Preparation::frictionless, Preparation::fast, Preparation::dense}) {
    MacroSpec spec = prepared_by(p, 40);
    spec.protocol.max_passes = 20;
    try {
      (void)make_macro_packing(spec, 1, 0);
      ADD_FAILURE() << "prepared in 20 passes: " << to_string(p);
    } catch (const UnusableResult& e) {
      const std::string text = e.what();
      for (const char* word : {"did not reach a pressure of 1e-05 E", "capped after 20 passes", "walls at", "fill"})
        EXPECT_NE(text.find(word), std::string::npos) << word << " not in " << text;
    }
  }
}

/// Contacts with walls go on as the preparation left them too, so that a test begins about at its pressure, whatever
/// the friction of its walls.
TEST(MacroPreparation, ATestBeginsAtThePressureOfARoughPreparation) {
  for (const Preparation p : {Preparation::fast, Preparation::slow})
    for (const auto& [wall_friction, rolling_friction] : {std::pair{0.0, 0.0}, {0.3, 0.0}, {0.3, 0.2}}) {
      MacroSpec spec = prepared_by(p, 60);
      spec.soft_share = 0.0;
      spec.friction = 0.3;
      spec.wall_friction = wall_friction;
      spec.rolling.friction = rolling_friction;
      spec.start_pressure = 1e-4;
      spec.protocol.tolerance = 1e-3;
      const MacroPacking packing = make_macro_packing(spec, 1, 0);
      const bool walls = std::ranges::any_of(packing.springs, [](const BodySpring& s) { return s.j >= 60; });
      EXPECT_EQ(walls, wall_friction > 0.0) << to_string(p);
      EXPECT_EQ(any_rolls(packing.springs), rolling_friction > 0.0) << to_string(p);
      spec.steps = 1;
      spec.increments_per_step = 1;
      spec.strain_end = 1e-5;
      CompressionState state;
      state.macro = make_law_system(spec, packing, {}, 1.0);
      force_pass(state.macro.system, 0.0, History::none);
      EXPECT_LT(residual(state.macro.system).relative(0.0), 1.1 * spec.protocol.tolerance) << to_string(p);
      state.curve = begin_curve(spec, packing, state.macro, "law", 0);
      compress(state, spec);
      const MacroCurve& c = state.curve;
      const double mean = (c.stress_x.front() + c.stress_y.front() + c.stress_axial.front()) / 3.0;
      const double pressure = spec.start_pressure * spec.youngs_modulus;
      EXPECT_NEAR(mean, pressure, 0.02 * pressure) << to_string(p) << ", mu of walls " << wall_friction;
    }
}

/// What contacts bore at the end of a preparation with friction, twins begin with as runs by laws do: without soft
/// particles both are the same bodies, and have the same bits. In a periodic cell grains resist rolling.
TEST(MacroPreparation, TwinsBeginWithTheSpringsThatItLeft) {
  for (const Preparation p : {Preparation::fast, Preparation::slow, Preparation::frictionless})
    for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
      MacroSpec spec = prepared_by(p, 60);
      spec.soft_share = 0.0;
      spec.friction = 0.3;  // or nobody asks for springs
      spec.boundary = boundary;
      spec.wall_friction = boundary == Boundary::walls ? 0.2 : 0.0;
      spec.rolling.friction = boundary == Boundary::walls ? 0.0 : 0.1;
      spec.steps = 1;
      spec.increments_per_step = 1;
      spec.strain_end = 0.005;
      spec.twin.relaxation = TwinRelaxation::damped;
      const MacroPacking packing = make_macro_packing(spec, 1, 0);
      EXPECT_EQ(packing.springs.empty(), p == Preparation::frictionless);
      const auto run = [&](MacroSystem macro, const std::string& engine) {
        CompressionState state;
        state.macro = std::move(macro);
        state.curve = begin_curve(spec, packing, state.macro, engine, 0);
        compress(state, spec);
        return state.curve;
      };
      const MacroCurve law = run(make_law_system(spec, packing, {}, 1.0), "law");
      for (const MacroCurve& twin : {run(make_shelled_system(spec, packing, {}, 1, 0), "shelled"),
                                     run(make_free_system(spec, packing, {}, 1, 0), "free")}) {
        EXPECT_EQ(twin.stress_axial, law.stress_axial) << to_string(p);
        EXPECT_EQ(twin.stress_lateral, law.stress_lateral) << to_string(p);
      }
    }
}

TEST(MacroPreparation, TellsHowFarItIs) {
  for (const Preparation p : {Preparation::frictionless, Preparation::fast, Preparation::dense}) {
    std::vector<double> shares;
    (void)make_macro_packing(prepared_by(p, 60), 1, 0, {[&](double share) { shares.push_back(share); }});
    ASSERT_GT(shares.size(), 10U);
    EXPECT_LT(shares[0], 0.3);
    EXPECT_GT(shares.back(), 0.9);
    for (const double s : shares) {
      EXPECT_GE(s, 0.0);
      EXPECT_LE(s, 1.0);
    }
  }
}

/// Passes of a preparation and of the default test after it.
void expect_cheaper_than_test(std::int64_t bodies, std::uint64_t samples) {
  MacroSpec spec;
  spec.bodies = bodies;
  spec.soft_share = 0.0;
  std::int64_t preparation = 0;
  std::int64_t test = 0;
  for (std::uint64_t seed = 1; seed <= samples; ++seed) {
    const MacroPacking packing = make_macro_packing(spec, seed, 0);
    CompressionState state;
    state.macro = make_law_system(spec, packing, {}, 1.0);
    state.curve = begin_curve(spec, packing, state.macro, "law", 0);
    compress(state, spec);
    EXPECT_EQ(state.curve.preparation.loop_passes, packing.cost.loop_passes);
    preparation += packing.cost.loop_passes;
    test += state.curve.cost.loop_passes;
  }
  EXPECT_LT(preparation, test);
}

TEST(MacroPreparation, TakesFewerPassesThanTheTestAfterIt) { expect_cheaper_than_test(250, 4); }
TEST(SlowMacroPreparation, TakesFewerPassesThanTheTestAfterIt) { expect_cheaper_than_test(4000, 4); }

}  // namespace
}  // namespace softgrain
