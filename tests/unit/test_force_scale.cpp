// Forces of an experiment that cannot be those of a soft particle: wrong units, wrong sign.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/data/force_curves.h"
#include "common/data/macro_result.h"
#include "pipelines/kinds/macro/summary.h"

namespace softgrain {
namespace {

constexpr double kRs = 0.016;
constexpr double kE = 0.5e6;
const std::vector<double> kDelta{0.1, 0.2, 0.3};
const std::vector<double> kForce{0.095, 0.81, 2.6};  // N, as pipelines/press_test.csv has them

std::vector<double> times(double factor) {
  std::vector<double> out = kForce;
  for (double& f : out) f *= factor;
  return out;
}

bool says(const std::vector<std::string>& all, const std::string& words) {
  return std::any_of(all.begin(), all.end(),
                     [&](const std::string& one) { return one.find(words) != std::string::npos; });
}

TEST(ForceScale, RightForcesAreNotMinded) { EXPECT_TRUE(implausible_forces(kDelta, kForce, kRs, kE).empty()); }

/// N for mN, and the other way round; a solid sphere bears 4/3 E Rs^2 Delta^1.5 = 28 N at Delta = 0.3.
TEST(ForceScale, AFactorOfAThousandShowsBothWays) {
  EXPECT_TRUE(says(implausible_forces(kDelta, times(1e3), kRs, kE), "is 93 times that of a solid sphere"));
  EXPECT_TRUE(says(implausible_forces(kDelta, times(1e3), kRs, kE), "more than any soft particle"));
  EXPECT_TRUE(says(implausible_forces(kDelta, times(1e-3), kRs, kE), "check the units"));
  EXPECT_TRUE(says(implausible_forces(kDelta, kForce, kRs, 1e3 * kE), "check the units")) << "E in MPa read as GPa";
}

/// Near the threshold next to nothing is right.
TEST(ForceScale, SmallForcesAtSmallOverlapsAreRight) {
  EXPECT_TRUE(implausible_forces({0.02, 0.06}, {0.0, 1e-5}, kRs, kE).empty());
}

TEST(ForceScale, TensionCountedPositiveIsSaid) {
  EXPECT_TRUE(says(implausible_forces(kDelta, times(-1.0), kRs, kE), "compression counts positive"));
  EXPECT_TRUE(implausible_forces({0.05, 0.1, 0.2}, {-1e-3, 0.09, 0.8}, kRs, kE).empty()) << "noise before touch";
}

MacroCurve curve(const std::string& engine, std::int64_t soft, double stress) {
  MacroCurve c;
  c.engine = engine;
  c.soft = soft;
  c.start.youngs_modulus = 1e6;
  c.strain = {0.0, 0.1};
  c.stress_axial = {stress, 100.0};
  return c;
}

/// start_pressure E = 10 Pa.
TEST(FirstPoint, IsExplainedWhereItBearsFarLessThanThePreparation) {
  MacroSpec spec;
  spec.start_pressure = 1e-5;
  EXPECT_TRUE(first_point_remarks(spec, {curve("law", 3, 8.0), curve("shelled", 3, 12.0)}).empty());
  const auto said = first_point_remarks(spec, {curve("law", 3, 0.0), curve("law", 3, 2.0), curve("shelled", 3, 12.0)});
  ASSERT_EQ(said.size(), 1U);
  EXPECT_TRUE(says(said, "'law' bears 1 Pa, below start_pressure E = 10 Pa")) << said.front();
  EXPECT_TRUE(says(said, "nothing before their threshold"));
  EXPECT_TRUE(says(first_point_remarks(spec, {curve("shelled", 3, 0.0)}), "behind their shells"));
  EXPECT_TRUE(says(first_point_remarks(spec, {curve("law", 0, 0.0)}), "preparation_tolerance"));
  spec.protocol.friction = 2.0 * spec.friction;
  EXPECT_TRUE(says(first_point_remarks(spec, {curve("law", 0, 0.0)}), "more friction than the test"));
}

}  // namespace
}  // namespace softgrain
