// Dependence of a number on its inputs against closed forms, from the points of designs.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/core/random.h"
#include "common/core/sensitivity.h"
#include "pipelines/runs/sample_design.h"

namespace softgrain {
namespace {

using Columns = std::vector<std::vector<double>>;

Columns columns_of_points(const std::vector<std::vector<double>>& points, std::size_t keys) {
  Columns columns(keys);
  for (const std::vector<double>& point : points)
    for (std::size_t k = 0; k < keys; ++k) columns[k].push_back(point[k]);
  return columns;
}

constexpr double kSecond = 7.0;
constexpr double kThird = 0.1;

/// sin x1 + a sin^2 x2 + b x3^4 sin x1 with x from -pi to pi (Ishigami and Homma 1990, doi:10.1109/ISUMA.1990.151285).
double ishigami(const std::vector<double>& unit) {
  const auto x = [&](std::size_t k) { return std::numbers::pi * (2.0 * unit[k] - 1.0); };
  return std::sin(x(0)) * (1.0 + kThird * std::pow(x(2), 4)) + kSecond * std::pow(std::sin(x(1)), 2);
}

SobolSample ishigami_sample(std::size_t base, std::uint64_t seed) {
  SobolSample out{.a = {}, .b = {}, .mixed = Columns(3)};
  const auto points = unit_points({SampleForm::saltelli, base, seed}, 3);
  EXPECT_EQ(points.size(), base * 5);
  for (std::size_t p = 0; p < points.size(); p += 5) {
    out.a.push_back(ishigami(points[p]));
    out.b.push_back(ishigami(points[p + 1]));
    for (std::size_t k = 0; k < 3; ++k) out.mixed[k].push_back(ishigami(points[p + 2 + k]));
  }
  return out;
}

bool contains(const EffectSize& effect, double value) { return effect.low <= value && value <= effect.high; }

TEST(Sensitivity, SobolIndicesOfTheIshigamiFunctionLieInTheirIntervals) {
  const double pi4 = std::pow(std::numbers::pi, 4);
  const double variance = kSecond * kSecond / 8.0 + kThird * pi4 / 5.0 + kThird * kThird * pi4 * pi4 / 18.0 + 0.5;
  const double first = 0.5 * std::pow(1.0 + kThird * pi4 / 5.0, 2) / variance;
  const double second = kSecond * kSecond / 8.0 / variance;
  const double both = 8.0 * kThird * kThird * pi4 * pi4 / 225.0 / variance;  // of x1 and x3 together
  const auto indices = sobol_indices(ishigami_sample(512, 1), 1, 0);
  ASSERT_TRUE(indices.has_value());
  const double firsts[] = {first, second, 0.0};
  const double totals[] = {first + both, second, both};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(contains(indices->first[k], firsts[k])) << k << ": " << indices->first[k].value << " " << firsts[k];
    EXPECT_TRUE(contains(indices->total[k], totals[k])) << k << ": " << indices->total[k].value << " " << totals[k];
    EXPECT_LT(indices->total[k].high - indices->total[k].low, 0.3) << "an interval that says nothing";
    EXPECT_NEAR(indices->first[k].value, firsts[k], 0.06);
    EXPECT_NEAR(indices->total[k].value, totals[k], 0.06);
  }
}

TEST(Sensitivity, IndicesOfFewPointsOrOfAConstantAreNotDetermined) {
  EXPECT_FALSE(sobol_indices(ishigami_sample(kLeastBasePoints - 1, 1), 1, 0).has_value());
  EXPECT_TRUE(sobol_indices(ishigami_sample(kLeastBasePoints, 1), 1, 0).has_value());
  const std::vector<double> same(20, 3.0);
  EXPECT_FALSE(sobol_indices({same, same, {same}}, 1, 0).has_value());
}

/// f = x1: all of the variance is that of x1, and nothing of x2.
TEST(Sensitivity, AnInputThatDoesNothingHasNoIndex) {
  SobolSample sample{.a = {}, .b = {}, .mixed = Columns(2)};
  const auto points = unit_points({SampleForm::saltelli, 64, 5}, 2);
  for (std::size_t p = 0; p < points.size(); p += 4) {
    sample.a.push_back(points[p][0]);
    sample.b.push_back(points[p + 1][0]);
    for (std::size_t k = 0; k < 2; ++k) sample.mixed[k].push_back(points[p + 2 + k][0]);
  }
  const auto indices = sobol_indices(sample, 1, 0);
  ASSERT_TRUE(indices.has_value());
  EXPECT_EQ(indices->first[0].value, 1.0);
  EXPECT_EQ(indices->total[1].value, 0.0);
  EXPECT_EQ(indices->total[1].high, 0.0);
  EXPECT_NEAR(indices->total[0].value, 1.0, 0.1);
}

/// A monotone function has the rank correlation 1 or -1, however curved it is.
TEST(Sensitivity, MonotoneFunctionsHaveTheRankCorrelationOne) {
  std::vector<double> x;
  std::vector<double> y;
  for (int k = 0; k < 12; ++k) x.push_back(k), y.push_back(std::exp(k));
  const auto rises = rank_correlation(x, y);
  ASSERT_TRUE(rises.has_value());
  EXPECT_DOUBLE_EQ(rises->value, 1.0);
  EXPECT_GT(rises->low, 0.9);
  EXPECT_LT(rises->low, 1.0) << "twelve points do not prove it";
  EXPECT_EQ(rises->high, 1.0);
  for (double& v : y) v = -v;
  EXPECT_DOUBLE_EQ(rank_correlation(x, y)->value, -1.0);
  EXPECT_FALSE(rank_correlation(std::vector<double>(7, 1.0), std::vector<double>(7, 2.0)).has_value());
  EXPECT_FALSE(rank_correlation(std::vector<double>(12, 1.0), y).has_value()) << "a key that does not vary";
}

/// Equal values share ranks: x = 1 1 2 2 ..., y in the same order within pairs; ranks 1.5 1.5 3.5 3.5 ... against 1 to
/// 8 give r = sqrt(1 - 2/42): the squared ranks of a pair lose 1/2 of their 42 in all.
TEST(Sensitivity, EqualValuesShareTheirRanks) {
  const std::vector<double> x{1, 1, 2, 2, 3, 3, 4, 4};
  const std::vector<double> y{1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_NEAR(rank_correlation(x, y)->value, std::sqrt(40.0 / 42.0), 1e-12);
}

/// Independent columns: the interval at 95 % leaves out 0 in about 5 of 100 cases, here at most 11 (a binomial number
/// is above that in less than one case of 200).
TEST(Sensitivity, IntervalsOfIndependentColumnsHoldZero) {
  int outside = 0;
  for (std::uint64_t sample = 0; sample < 100; ++sample) {
    const auto columns = columns_of_points(unit_points({SampleForm::lhs, 20, sample}, 2), 2);
    const auto r = rank_correlation(columns[0], columns[1]);
    outside += contains(*r, 0.0) ? 0 : 1;
  }
  EXPECT_LE(outside, 11);
}

/// y = 3 x1 - 4 x2 over independent columns: coefficients 3 s1/s and -4 s2/s, which explain everything.
TEST(Sensitivity, RegressionFindsTheCoefficientsOfALinearFunction) {
  const auto columns = columns_of_points(unit_points({SampleForm::sobol, 64, 3}, 2), 2);
  std::vector<double> y;
  for (std::size_t p = 0; p < 64; ++p) y.push_back(3.0 * columns[0][p] - 4.0 * columns[1][p]);
  const auto fit = standardised_regression(columns, y);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->determination, 1.0, 1e-12);
  EXPECT_NEAR(fit->coefficients[0].value, 0.6, 0.02);
  EXPECT_NEAR(fit->coefficients[1].value, -0.8, 0.02);
  EXPECT_FALSE(standardised_regression({columns[0], columns[0]}, y).has_value()) << "one column twice";
  y.resize(8);
  EXPECT_FALSE(standardised_regression({std::vector<double>(y)}, y).has_value()) << "too few points";
}

/// Of a simple regression the coefficient is the correlation r, with the standard error sqrt((1 - r^2)/(n - 2)).
TEST(Sensitivity, TheIntervalOfARegressionIsThatOfStudent) {
  std::vector<double> x;
  std::vector<double> y;
  for (int k = 0; k < 12; ++k) x.push_back(k), y.push_back(k + (k % 3 == 0 ? 4.0 : 0.0));
  const auto fit = standardised_regression({x}, y);
  ASSERT_TRUE(fit.has_value());
  const EffectSize& b = fit->coefficients[0];
  EXPECT_NEAR(b.value * b.value, fit->determination, 1e-12);
  const double t = 2.228138851964939;  // 97.5 % quantile of Student's t, ten degrees of freedom
  EXPECT_NEAR(b.high - b.value, t * std::sqrt((1.0 - b.value * b.value) / 10.0), 1e-9);
}

TEST(SampleDesign, ALatinHypercubeHasOnePointInEveryStratum) {
  const auto points = unit_points({SampleForm::lhs, 30, 7}, 4);
  for (const std::vector<double>& column : columns_of_points(points, 4)) {
    std::vector<int> strata(30, 0);
    for (const double u : column) ++strata.at(static_cast<std::size_t>(u * 30.0));
    EXPECT_EQ(strata, std::vector<int>(30, 1));
  }
  EXPECT_EQ(unit_points({SampleForm::lhs, 30, 7}, 4), points) << "the seed determines it";
  EXPECT_NE(unit_points({SampleForm::lhs, 30, 8}, 4), points);
}

/// 2^m points of a digital net: one in each of 2^m strata of every coordinate, and a larger design begins with a
/// smaller.
TEST(SampleDesign, ASobolSequenceIsEvenAndGoesOn) {
  const auto points = unit_points({SampleForm::sobol, 32, 7}, 5);
  for (const std::vector<double>& column : columns_of_points(points, 5)) {
    std::vector<int> strata(32, 0);
    for (const double u : column) ++strata.at(static_cast<std::size_t>(u * 32.0));
    EXPECT_EQ(strata, std::vector<int>(32, 1));
  }
  const auto more = unit_points({SampleForm::sobol, 40, 7}, 5);
  EXPECT_TRUE(std::equal(points.begin(), points.end(), more.begin()));
  EXPECT_NE(unit_points({SampleForm::sobol, 32, 8}, 5), points);
}

TEST(SampleDesign, RangesGiveValuesAsSetTakesThem) {
  const auto value = [](const std::string& text, double u, bool whole = false) {
    std::string problem;
    auto range = range_of(text, problem);
    EXPECT_TRUE(range.has_value() && problem.empty()) << text << problem;
    range->whole = whole;
    return value_at(*range, u);
  };
  EXPECT_EQ(value("0.1..0.8", 0.5), "0.45");
  EXPECT_EQ(value("1e6..1e8:log", 0.5), "10000000");
  EXPECT_EQ(value("0.1..10 MPa:log", 0.5), "\"1 MPa\"");
  EXPECT_EQ(value("\"1 mm\"..\"3 mm\"", 0.25), "\"1.5 mm\"");
  EXPECT_EQ(value("0.1..0.123456789", 1.0 - 1e-12), "0.123456789") << "within the range";
  EXPECT_EQ(value("2..4", 0.001, true), "2");
  EXPECT_EQ(value("2..4", 0.5, true), "3");
  EXPECT_EQ(value("2..4", 0.999, true), "4");
  std::string problem;
  for (const char* none : {"../a..b", "0.1", "a..b", "1..2 bananas", "1e6..1e8:lg"})
    EXPECT_FALSE(range_of(none, problem).has_value()) << none;
  for (const char* wrong : {"2..1", "0..1:log", "1 mm..2 cm"}) {
    problem.clear();
    EXPECT_TRUE(range_of(wrong, problem).has_value());
    EXPECT_FALSE(problem.empty()) << wrong;
  }
}

}  // namespace
}  // namespace softgrain
