// Packings prepared under pressure against those of the slow way, in steps of the box: the same statistics.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "common/core/statistics.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/residual.h"
#include "macrosim/body_contacts.h"
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

/// The protocol that LAMMPS runs, word by word: the box shrinks in steps and all is relaxed after each; a step that
/// overshoots the pressure is taken back and halved.
MacroSystem compacted_in_steps(const MacroSpec& spec, std::uint64_t seed) {
  MacroSpec loose = spec;
  loose.preparation = MacroEngine::lammps;
  const MacroPacking packing = make_macro_packing(loose, seed, 0);
  const CompactionProtocol protocol = compaction_protocol(spec, packing.size(), packing.bodies.size());
  DampedOptions options;
  options.tolerance = protocol.tolerance;
  options.max_passes = protocol.max_passes;
  options.force_floor = protocol.force_floor;
  MacroSystem macro = as_grains(spec, packing);
  double step = protocol.first_step;
  for (int round = 0; round < protocol.most_rounds; ++round) {
    const System3 before = macro.system;
    strain_box(macro.system, macro.box, {{step, step, step}});
    DampedRelaxation<3>(options).relax(macro.system);
    const Vec3 stress = wall_stress(macro.system, macro.box);
    const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
    if (mean < protocol.pressure) continue;
    if (mean < protocol.overshoot * protocol.pressure) return macro;
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
    const Vec3 stress = wall_stress(m.system, m.box);
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
  const MacroSpec spec = solids(bodies);
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
      EXPECT_LT(r.relative(0.0), 1.1e-3) << start;
      const Vec3 wall = wall_stress(macro.system, macro.box);
      const Vec3 inside = contact_stress(macro.system, macro.box);
      EXPECT_NEAR(wall[0] + wall[1] + wall[2], 3.0 * pressure, 3.3e-3 * pressure) << start;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(inside[k], wall[k], 1e-2 * pressure) << start << ", " << k;
      EXPECT_EQ(packing.size()[0], packing.size()[1]) << "all sides alike";
    }
}

/// Two hundred passes towards half the pressure.
System3 pressed(MacroSystem macro, double pressure, int threads) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  DampedOptions options;
  options.max_passes = 200;
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

}  // namespace
}  // namespace softgrain
