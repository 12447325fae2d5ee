// Consolidation of powders: known curves give their numbers back, and what they do not tell is said.
#include "calibrate/consolidation_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/core/error.h"

namespace softgrain {
namespace {

constexpr double kSlope = 0.12;
constexpr double kBegin = 0.05;
constexpr double kEnd = 1.6;
constexpr double kAlpha = 1.1;

double known(double p);

/// With which the curve goes on as steeply as it came: d(1/Phi)/d ln P* = -alpha (Phi_max - Phi)/Phi^2.
double densest() { return known(kEnd) + kSlope * known(kEnd) * known(kEnd) / kAlpha; }

/// Flat, then straight in 1/Phi over ln P*, then Phi_max - c P*^-alpha.
double known(double p) {
  const double first = 1.0 / 0.42;
  if (p <= kBegin) return 1.0 / first;
  if (p <= kEnd) return 1.0 / (first - kSlope * std::log(p / kBegin));
  return densest() - (densest() - known(kEnd)) * std::pow(p / kEnd, -kAlpha);
}

ConsolidationCurves curves_up_to(double top, const std::vector<double>& shifts) {
  ConsolidationCurves c;
  for (double p = 0.0125; p < 1.01 * top; p *= 2.0) c.pressure.push_back(p);
  for (const double s : shifts) {
    std::vector<double> f;
    for (const double p : c.pressure) f.push_back(1.0 / (1.0 / known(p) + s));
    c.fraction.push_back(f);
  }
  return c;
}

TEST(ConsolidationFit, GivesBackSlopeExponentAndDensestState) {
  const ConsolidationFit f = fit_consolidation(curves_up_to(25.6, {0.0}));
  ASSERT_TRUE(f.usable) << f.reason;
  EXPECT_EQ(f.reason, "");
  EXPECT_NEAR(f.slope.value, kSlope, 1e-9);
  EXPECT_GE(f.low, kBegin * (1.0 - 1e-9));
  EXPECT_LE(f.high, kEnd * (1.0 + 1e-9));
  EXPECT_NEAR(f.begin, kBegin, 1e-9);
  ASSERT_TRUE(f.exponent && f.densest);
  // The stretch may end a little before regime II does.
  EXPECT_NEAR(f.exponent->value, kAlpha, 0.35);
  EXPECT_NEAR(f.densest->value, densest(), 0.02);
}

TEST(ConsolidationFit, ErrorsComeFromSamples) {
  const ConsolidationFit f = fit_consolidation(curves_up_to(25.6, {-0.02, 0.0, 0.02}));
  EXPECT_NEAR(f.slope.value, kSlope, 1e-9) << "shifts of 1/Phi leave the slope";
  EXPECT_NEAR(f.slope.error, 0.0, 1e-9);
  ConsolidationCurves c = curves_up_to(25.6, {0.0, 0.0});
  for (std::size_t k = 0; k < c.pressure.size(); ++k)
    c.fraction[1][k] = 1.0 / (1.0 / c.fraction[1][k] - 0.02 * std::log(c.pressure[k] / c.pressure[0]));
  const ConsolidationFit two = fit_consolidation(c);
  EXPECT_NEAR(two.slope.error, 0.01, 1e-3) << "slopes 0.12 and 0.14";
}

/// The line of regime II to the end says nothing of where it would go.
TEST(ConsolidationFit, LimitsOfTheSearchAreNoResult) {
  ConsolidationCurves c;
  for (double p = 0.0125; p < 6.5; p *= 2.0) c.pressure.push_back(p);
  c.fraction.emplace_back();
  for (const double p : c.pressure) {
    // A little steeper at the beginning, so that the stretch of the slope ends long before the last point.
    const double steep = std::min(std::log(p / 0.0125), std::log(8.0));
    c.fraction[0].push_back(1.0 / (1.0 / 0.3 - 0.25 * std::log(p / 0.0125) - 0.01 * steep));
  }
  const ConsolidationFit f = fit_consolidation(c);
  ASSERT_TRUE(f.usable) << f.reason;
  EXPECT_FALSE(f.exponent || f.densest) << (f.densest ? f.densest->value : 0.0);
  EXPECT_NE(f.reason.find("limit of its search"), std::string::npos) << f.reason;
}

TEST(ConsolidationFit, SaysWhatCannotBeTold) {
  const ConsolidationFit early = fit_consolidation(curves_up_to(1.6, {0.0}));
  EXPECT_TRUE(early.usable);
  EXPECT_FALSE(early.exponent.has_value());
  EXPECT_NE(early.reason.find("alpha"), std::string::npos);
  ConsolidationCurves flat;
  flat.pressure = {0.01, 0.02, 0.04, 0.08, 0.16};
  flat.fraction = {{0.5, 0.5, 0.5, 0.5, 0.5}};
  const ConsolidationFit none = fit_consolidation(flat);
  EXPECT_FALSE(none.usable);
  EXPECT_NE(none.reason.find("does not grow"), std::string::npos);
  flat.fraction[0].pop_back();
  EXPECT_THROW(fit_consolidation(flat), InputError);
}

}  // namespace
}  // namespace softgrain
