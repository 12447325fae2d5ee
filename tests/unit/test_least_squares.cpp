// The general fitter: derivatives, bounds, rank, and what it says when a fit goes wrong.
#include "calibrate/least_squares.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/trust_region.h"
#include "common/core/error.h"
#include "tests/support/curve_problem.h"

namespace {

using namespace softgrain;
using std::exp;

constexpr auto kDecay = [](const auto* p, const double* x) { return p[0] * exp(-p[1] * x[0]); };

Observations decay_data(double amplitude, double rate, double noise = 0.0) {
  Observations data;
  for (int i = 0; i < 12; ++i) {
    data.x.push_back(0.3 * i);
    data.y.push_back(amplitude * std::exp(-rate * data.x.back()) + (i % 2 == 0 ? noise : -noise));
  }
  return data;
}

TEST(LeastSquares, ResultStartsAsNotRun) {
  const LeastSquaresFit fit;
  EXPECT_EQ(fit.end, FitEnd::not_run);
  EXPECT_FALSE(fit.usable());
}

TEST(LeastSquares, ExactDataAreRecoveredToRounding) {
  const auto fit = fit_least_squares(curve_problem<2>(decay_data(3.0, 0.7), kDecay), {{1.0, 0.1}});
  EXPECT_TRUE(fit.usable()) << fit.message;
  EXPECT_NEAR(fit.parameters[0], 3.0, 1e-13);
  EXPECT_NEAR(fit.parameters[1], 0.7, 1e-13);
  EXPECT_LT(fit.residual_sum_of_squares, 1e-28);
  EXPECT_EQ(fit.degrees_of_freedom, 10);
}

TEST(LeastSquares, UnitsOfParametersDoNotMatter) {
  constexpr auto tiny = [](const auto* p, const double* x) { return 1e9 * p[0] * exp(-1e-8 * p[1] * x[0]); };
  const auto plain = fit_least_squares(curve_problem<2>(decay_data(3.0, 0.7, 0.01), kDecay), {{1.0, 0.1}});
  const auto scaled = fit_least_squares(curve_problem<2>(decay_data(3.0, 0.7, 0.01), tiny), {{1e-9, 1e7}});
  EXPECT_NEAR(scaled.parameters[0] * 1e9 / plain.parameters[0], 1.0, 1e-9);
  EXPECT_NEAR(scaled.standard_deviations[1] * 1e-8 / plain.standard_deviations[1], 1.0, 1e-7);
}

TEST(LeastSquares, DifferencesAgreeWithExactDerivatives) {
  auto problem = curve_problem<2>(decay_data(3.0, 0.7), kDecay);
  for (const std::vector<double>& p : {std::vector{2.5, 0.4}, {-2.5e6, 0.4}, {0.0, 0.4}}) {
    std::vector<double> exact(24), numeric(24);
    ASSERT_TRUE(jacobian_at(problem, p, exact));
    ASSERT_TRUE(jacobian_at({problem.residuals, problem.evaluate, nullptr, {}}, p, numeric));
    for (std::size_t k = 0; k < exact.size(); ++k)
      EXPECT_NEAR(numeric[k], exact[k], (p[0] == 0.0 ? 1e-8 : 1e-9) * (1.0 + std::abs(exact[k]))) << p[0];
  }
}

TEST(LeastSquares, DifferencesStayWithinTheDomainOrSaySo) {
  LeastSquaresProblem problem;
  problem.residuals = 1;
  problem.evaluate = [](std::span<const double> p, std::span<double> r) {
    r[0] = p[0] * p[0];
    return p[0] < 2.001;
  };
  std::vector<double> slope(1);
  ASSERT_TRUE(jacobian_at(problem, std::vector{2.0}, slope));
  EXPECT_NEAR(slope[0], 4.0, 1e-9);
  EXPECT_FALSE(jacobian_at(problem, std::vector{2.1}, slope));
}

TEST(LeastSquares, FitsWithoutAJacobian) {
  auto problem = curve_problem<2>(decay_data(3.0, 0.7, 0.01), kDecay);
  const auto exact = fit_least_squares(problem, {{1.0, 0.1}});
  problem.jacobian = nullptr;
  const auto numeric = fit_least_squares(problem, {{1.0, 0.1}});
  EXPECT_NEAR(numeric.parameters[1], exact.parameters[1], 1e-10);
  EXPECT_NEAR(numeric.standard_deviations[1], exact.standard_deviations[1], 1e-8);
}

TEST(LeastSquares, ActiveBoundIsReportedAndTheRestIsOptimal) {
  auto problem = curve_problem<2>(decay_data(3.0, 0.7), kDecay);
  problem.bounds = {{0.0, 10.0}, {0.0, 0.5}};
  const auto fit = fit_least_squares(problem, {{1.0, 0.1}});
  EXPECT_EQ(fit.end, FitEnd::converged) << fit.message;
  EXPECT_TRUE(fit.at_bound[1]);
  EXPECT_FALSE(fit.at_bound[0]);
  EXPECT_DOUBLE_EQ(fit.parameters[1], 0.5);
  double xy = 0.0;
  double xx = 0.0;
  const auto data = decay_data(3.0, 0.7);
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    const double e = std::exp(-0.5 * data.x[i]);
    xy += e * data.y[i];
    xx += e * e;
  }
  EXPECT_NEAR(fit.parameters[0], xy / xx, 1e-9);
  EXPECT_EQ(fit.standard_deviations[1], 0.0);
}

TEST(LeastSquares, BoundsOfZeroWidthFixAParameter) {
  auto problem = curve_problem<2>(decay_data(3.0, 0.7, 0.01), kDecay);
  problem.bounds = {{}, {0.6, 0.6}};
  const auto fit = fit_least_squares(problem, {{1.0, 0.6}});
  EXPECT_EQ(fit.end, FitEnd::converged) << fit.message;
  EXPECT_EQ(fit.parameters[1], 0.6);
  EXPECT_EQ(fit.rank, 1);
  problem.bounds[0] = {2.0, 2.0};
  EXPECT_EQ(fit_least_squares(problem, {{2.0, 0.6}}).parameters[0], 2.0);
}

/// At p = 0 the data say nothing of p^3: its bound does not hold it.
TEST(LeastSquares, WhatIsNotFeltAtItsBoundIsUndetermined) {
  constexpr auto flat = [](const auto* p, const double* x) { return p[0] * exp(-0.7 * x[0]) + p[1] * p[1] * p[1]; };
  auto problem = curve_problem<2>(decay_data(3.0, 0.7, 0.01), flat);
  problem.bounds = {{}, {0.0, 1.0}};
  const auto fit = fit_least_squares(problem, {{2.0, 0.0}});
  EXPECT_FALSE(fit.at_bound[1]);
  EXPECT_EQ(fit.rank, 1);
  EXPECT_TRUE(std::isinf(fit.standard_deviations[1]));
  EXPECT_FALSE(fit.usable());
}

TEST(LeastSquares, RankDeficientCovarianceIsReported) {
  constexpr auto twice = [](const auto* p, const double* x) { return (p[0] + p[1]) * exp(-p[2] * x[0]); };
  const auto fit = fit_least_squares(curve_problem<3>(decay_data(3.0, 0.7, 0.01), twice), {{1.0, 1.0, 0.2}});
  EXPECT_TRUE(fit.rank_deficient);
  EXPECT_EQ(fit.rank, 2);
  EXPECT_TRUE(std::isinf(fit.standard_deviations[0]));
  EXPECT_TRUE(std::isinf(fit.standard_deviations[1]));
  EXPECT_TRUE(std::isfinite(fit.standard_deviations[2]));
  EXPECT_FALSE(fit.usable());
  EXPECT_NE(fit.message.find("determine 2 of 3"), std::string::npos) << fit.message;
}

TEST(LeastSquares, FewerResidualsThanParametersIsRankDeficient) {
  Observations data;
  data.x = {1.0};
  data.y = {2.0};
  const auto fit = fit_least_squares(curve_problem<2>(data, kDecay), {{1.0, 0.1}});
  EXPECT_TRUE(fit.rank_deficient);
  EXPECT_EQ(fit.degrees_of_freedom, -1);
}

TEST(LeastSquares, UndefinedModelIsAFailureNotACrash) {
  LeastSquaresProblem problem;
  problem.residuals = 2;
  problem.evaluate = [](std::span<const double>, std::span<double>) { return false; };
  const auto fit = fit_least_squares(problem, {{1.0}});
  EXPECT_EQ(fit.end, FitEnd::failed);
  EXPECT_FALSE(fit.usable());
}

TEST(LeastSquares, StalledFitSaysSoAndFurtherStartsRescueIt) {
  constexpr auto saturation = [](const auto* p, const double* x) { return p[0] * (1.0 - exp(-p[1] * x[0])); };
  Observations data;
  for (const double x : {1.0, 2.0, 3.0, 5.0, 7.0, 10.0}) {
    data.x.push_back(x);
    data.y.push_back(214.0 * (1.0 - std::exp(-0.55 * x)));
  }
  const auto problem = curve_problem<2>(data, saturation);
  LeastSquaresOptions quick;
  quick.thorough = false;
  const auto stuck = fit_least_squares(problem, {{1.0, 1.0}}, quick);
  EXPECT_NE(stuck.end, FitEnd::converged);
  EXPECT_GT(stuck.step_left, 1e-5);
  EXPECT_FALSE(stuck.usable());
  const auto rescued = fit_least_squares(problem, {{1.0, 1.0}});
  EXPECT_TRUE(rescued.usable()) << rescued.message;
  EXPECT_NEAR(rescued.parameters[1], 0.55, 1e-12);
}

TEST(LeastSquares, StartOutsideItsBoundsIsRefused) {
  auto problem = curve_problem<2>(decay_data(3.0, 0.7), kDecay);
  problem.bounds = {{0.0, 10.0}, {0.0, 0.5}};
  EXPECT_THROW(fit_least_squares(problem, {{1.0, 2.0}}), InputError);
  EXPECT_THROW(fit_least_squares(problem, {}), InputError);
}

TEST(LeastSquares, BestOfSeveralStartsIsKept) {
  constexpr auto wave = [](const auto* p, const double* x) {
    using std::sin;
    return sin(p[0] * x[0]);
  };
  Observations data;
  for (int i = 1; i < 40; ++i) {
    data.x.push_back(0.1 * i);
    data.y.push_back(std::sin(5.0 * 0.1 * i));
  }
  LeastSquaresOptions quick;
  quick.thorough = false;
  const auto fit = fit_least_squares(curve_problem<1>(data, wave), {{1.0}, {9.0}, {4.8}}, quick);
  EXPECT_EQ(fit.start, 2U);
  EXPECT_NEAR(fit.parameters[0], 5.0, 1e-10);
}

}  // namespace
