// Shear memory fitted to curves that the law itself has made: what went in comes out, and what is not determined is
// said.
#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/kinds/material_law/memory_fit.h"

namespace softgrain {
namespace {

/// Where x_r is 1e-3.
const FinesBase kFines{0.04, 1.6, 0.7, 1e2 * 0.04 * std::pow(1e-3, 1.6)};

ShearNumbers true_numbers() {
  ShearNumbers n{0.45, 2.5, {}};
  n.memory.dilatancy.value = 0.9;
  n.memory.critical_pores.value = 0.93;
  n.memory.strength_slope.value = 15.0;
  n.memory.strength_range.value = 0.6;
  n.memory.density_slope.value = -0.15;
  n.memory.least_state.value = 1e-3;
  return n;
}

enum class Way { triaxial, shear, oedometric };

/// A path from an isotropic start, with what the law says of it.
ShearPath path_of(Way way, double pressure, double fraction, std::size_t sample) {
  ShearPath path;
  path.sample = sample;
  constexpr int kSteps = 8;
  for (int k = 0; k <= kSteps; ++k) {
    const double e = 0.005 * k;
    path.strain.push_back(way == Way::shear ? Vec3{{-e, 0.0, e}} : Vec3{{0.0, 0.0, e}});
    path.stress.push_back({{pressure, pressure, pressure}});
    path.fraction.push_back(fraction);
    path.sides_by_stress.push_back(way == Way::triaxial && k > 0);
  }
  const ShearPrediction law = predict(kFines, true_numbers(), path);
  EXPECT_EQ(law.stress.size(), path.strain.size());
  path.stress = law.stress;
  path.fraction = law.fraction;
  return path;
}

/// Loose and dense fines under two pressures; samples differ by their densities.
std::vector<ShearPath> all_paths(bool dense) {
  std::vector<ShearPath> out;
  for (std::size_t s = 0; s < 2; ++s)
    for (const double phi : dense ? std::vector{0.600, 0.655} : std::vector{0.600})
      for (const double pressure : phi < 0.65 ? std::vector{1e-4, 1e-3} : std::vector{1e-3})
        for (const Way way : {Way::triaxial, Way::shear, Way::oedometric})
          out.push_back(path_of(way, pressure, phi + 0.002 * static_cast<double>(s) + 8.0 * pressure, s));
  return out;
}

TEST(ShearMemoryFit, FindsTheNumbersThatMadeTheCurves) {
  const ShearMemoryFit fit = fit_shear_memory(kFines, all_paths(true), true);
  ASSERT_TRUE(fit.usable) << fit.message;
  const ShearNumbers n = true_numbers();
  EXPECT_NEAR(fit.friction.value / n.friction, 1.0, 0.01);
  EXPECT_NEAR(fit.stiffness.value / n.stiffness, 1.0, 0.01);
  EXPECT_NEAR(fit.memory.dilatancy.value / n.memory.dilatancy.value, 1.0, 0.02);
  EXPECT_NEAR(fit.memory.critical_pores.value / n.memory.critical_pores.value, 1.0, 0.01);
  EXPECT_NEAR(fit.memory.strength_slope.value / n.memory.strength_slope.value, 1.0, 0.05);
  EXPECT_NEAR(fit.memory.strength_range.value / n.memory.strength_range.value, 1.0, 0.05);
  EXPECT_NEAR(fit.memory.density_slope.value, n.memory.density_slope.value, 0.01);
  EXPECT_NEAR(fit.memory.least_state.value, 1e-3, 1e-12);
  EXPECT_LT(fit.deviation, 0.01);
  EXPECT_LE(fit.friction.low, fit.friction.value);
  EXPECT_GE(fit.friction.high, fit.friction.value);
}

TEST(ShearMemoryFit, WithoutDenseFinesThreeNumbersAreTaken) {
  const ShearMemoryFit fit = fit_shear_memory(kFines, all_paths(false), false);
  EXPECT_NEAR(fit.memory.strength_range.value, 2.0 / 3.0, 1e-12);
  EXPECT_TRUE(std::isinf(fit.memory.strength_range.standard_error));
  EXPECT_EQ(fit.memory.dilatancy.value, 1.0);
  EXPECT_TRUE(std::isinf(fit.memory.dilatancy.standard_error));
  EXPECT_EQ(fit.memory.density_slope.value, 0.0);
  EXPECT_TRUE(std::isinf(fit.memory.density_slope.standard_error));
  EXPECT_TRUE(std::isinf(fit.memory.least_state.standard_error)) << "not measured";
  EXPECT_EQ(fit.memory.dilatancy.low, -kInfinity) << "no interval where nothing was fitted";
}

TEST(ShearMemoryFit, SaysWhyThereIsNone) {
  std::vector<ShearPath> none = all_paths(false);
  none.front().strain.resize(1);
  EXPECT_FALSE(fit_shear_memory(kFines, none, false).usable);
  // A start without pressure.
  std::vector<ShearPath> floating = all_paths(false);
  for (ShearPath& path : floating) path.stress.front() = {};
  const ShearMemoryFit fit = fit_shear_memory(kFines, floating, false);
  EXPECT_FALSE(fit.usable);
  EXPECT_NE(fit.message, "fitted");
}

}  // namespace
}  // namespace softgrain
