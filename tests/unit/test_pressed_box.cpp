// Walls that stress holds: against closed forms of one grain between them, and what they must not touch.
#include <gtest/gtest.h>

#include <cmath>

#include "macrosim/preparation.h"
#include "macrosim/pressed_box.h"

namespace softgrain {
namespace {

constexpr double kRadius = 0.016;

struct OneGrain {
  System3 system;
  Box box;
  MacroSpec spec;

  explicit OneGrain(const Vec3& gap) {
    system.materials = {{"hard", spec.density, spec.youngs_modulus, spec.poisson_ratio, false}};
    system.laws = LawSet(1);
    system.laws.set(0, 0, hard_law(spec));
    NewBody<3> grain;
    grain.x = {{0.1, -0.2, 0.3}};
    grain.r = kRadius;
    grain.mass = 1.0;
    add_grain(system.particles, grain);
    const Vec3 half = Vec3{{kRadius, kRadius, kRadius}} + gap;
    box = add_box(system, grain.x - half, grain.x + half, 0);
  }

  [[nodiscard]] RelaxationResult press(const BoxControl& control, double tolerance = 1e-6) {
    DampedOptions options;
    options.tolerance = tolerance;
    options.max_passes = 20000;
    options.least_stiffness = 0.01 * spec.youngs_modulus;
    PressedBox walls(box, control);
    return DampedRelaxation<3>(options).relax(system, walls);
  }
  [[nodiscard]] Vec3 size() const { return box_high(system, box) - box_low(system, box); }
  /// Hertz: F = 4/3 E* sqrt(R) d^(3/2), E* = E/(2 (1 - nu^2)).
  [[nodiscard]] double overlap_of(double force) const {
    const double modulus = spec.youngs_modulus / (2.0 * (1.0 - spec.poisson_ratio * spec.poisson_ratio));
    return std::pow(force / (4.0 / 3.0 * modulus * std::sqrt(kRadius)), 2.0 / 3.0);
  }
};

/// From boxes that are too wide and too narrow, at pressures of three decades.
TEST(PressedBox, OneGrainIsPressedAsHertzSays) {
  for (const double pressure : {0.5, 5.0, 500.0})
    for (const double gap : {0.2 * kRadius, -0.02 * kRadius}) {
      OneGrain one(Vec3{{gap, gap, gap}});
      const RelaxationResult rest =
          one.press({.by_stress = {true, true, true}, .stress = {{pressure, pressure, pressure}}, .tolerance = 1e-6});
      ASSERT_EQ(rest.end, RelaxationEnd::converged) << pressure;
      const Vec3 size = one.size();
      for (int k = 0; k < 3; ++k) {
        const double overlap = one.overlap_of(pressure * size[0] * size[1]);
        EXPECT_NEAR(size[k], 2.0 * (kRadius - overlap), 3e-6 * overlap) << pressure << ", " << gap;
        EXPECT_NEAR(box_stress(one.system, one.box)[k], pressure, 1e-6 * pressure);
      }
    }
}

TEST(PressedBox, EveryAxisHasAStressOfItsOwn) {
  OneGrain one(Vec3{{0.1 * kRadius, 0.1 * kRadius, 0.1 * kRadius}});
  const Vec3 stress{{10.0, 40.0, 5.0}};
  ASSERT_EQ(one.press({.by_stress = {true, true, true}, .stress = stress, .tolerance = 1e-6}).end,
            RelaxationEnd::converged);
  const Vec3 size = one.size();
  for (int k = 0; k < 3; ++k) {
    const double overlap = one.overlap_of(stress[k] * size[(k + 1) % 3] * size[(k + 2) % 3]);
    EXPECT_NEAR(size[k], 2.0 * (kRadius - overlap), 1e-5 * overlap) << k;
  }
}

TEST(PressedBox, AxesWithoutStressStand) {
  OneGrain one(Vec3{{0.1 * kRadius, -0.01 * kRadius, 0.1 * kRadius}});
  const Vec3 before = one.size();
  ASSERT_EQ(one.press({.by_stress = {true, false, true}, .stress = {{10.0, 0.0, 10.0}}}).end, RelaxationEnd::converged);
  EXPECT_EQ(one.size()[1], before[1]);
  EXPECT_LT(one.size()[0], 2.0 * kRadius);
}

/// Alike: one strain for all, so that the mean stress is met and not the single ones.
TEST(PressedBox, AxesAlikeKeepTheShapeOfTheBox) {
  OneGrain one(Vec3{{0.1 * kRadius, 0.11 * kRadius, 0.12 * kRadius}});
  const Vec3 before = one.size();
  BoxControl control{.by_stress = {true, true, true}, .stress = {{10.0, 10.0, 10.0}}, .isotropic = true};
  control.tolerance = 1e-6;
  ASSERT_EQ(one.press(control).end, RelaxationEnd::converged);
  const Vec3 after = one.size();
  EXPECT_NEAR(after[1] / after[0], before[1] / before[0], 1e-12);
  EXPECT_NEAR(after[2] / after[0], before[2] / before[0], 1e-12);
  const Vec3 stress = box_stress(one.system, one.box);
  EXPECT_NEAR((stress[0] + stress[1] + stress[2]) / 3.0, 10.0, 1e-5);
}

TEST(PressedBox, WhatIsNotReachedIsSaid) {
  OneGrain one(Vec3{{0.5 * kRadius, 0.5 * kRadius, 0.5 * kRadius}});
  DampedOptions options;
  options.max_passes = 20;
  PressedBox walls(one.box, {.by_stress = {true, true, true}, .stress = {{10.0, 10.0, 10.0}}});
  EXPECT_EQ(DampedRelaxation<3>(options).relax(one.system, walls).end, RelaxationEnd::capped);
  EXPECT_GT(walls.residual(one.system), 1.0);
}

}  // namespace
}  // namespace softgrain
