// Minima of sums of squares on kinks: found from where a fit stalls, with errors, and nothing else taken for one.
#include "calibrate/kink_minimum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace softgrain {
namespace {

/// Forces p[0] max(0, x - d) at depths x = 0.45 and 1 with the threshold d = p[1] + 0.3 p[2]^2, and three straight
/// lines that draw the parameters to targets. `fall` is the force at 0.45: below zero no threshold gives it, and S is
/// least with that depth on the threshold.
struct Corner {
  double fall = -1.0;
  std::vector<double> target{1.0, 0.35, 0.2};
  std::vector<double> weight{1.0, 5.0, 2.0};

  static double threshold(std::span<const double> p) { return p[1] + 0.3 * p[2] * p[2]; }

  [[nodiscard]] LeastSquaresProblem problem() const {
    LeastSquaresProblem out;
    out.residuals = 5;
    out.evaluate = [*this](std::span<const double> p, std::span<double> r) {
      const double d = threshold(p);
      r[0] = 10.0 * p[0] * std::max(0.0, 0.45 - d) - fall;
      r[1] = p[0] * std::max(0.0, 1.0 - d) - 0.7;
      for (std::size_t k = 0; k < 3; ++k) r[2 + k] = weight[k] * (p[k] - target[k]);
      return true;
    };
    out.jacobian = [*this](std::span<const double> p, std::span<double> j) {
      const double d = threshold(p);
      std::fill(j.begin(), j.end(), 0.0);
      const auto force = [&](std::size_t row, double factor, double x) {
        if (!(x > d)) return;
        j[3 * row] = factor * (x - d);
        j[3 * row + 1] = -factor * p[0];
        j[3 * row + 2] = -factor * p[0] * 0.6 * p[2];
      };
      force(0, 10.0, 0.45);
      force(1, 1.0, 1.0);
      for (std::size_t k = 0; k < 3; ++k) j[3 * (2 + k) + k] = weight[k];
      return true;
    };
    out.kinks = [](std::span<const double> p) { return std::vector{0.45 - threshold(p), 1.0 - threshold(p)}; };
    return out;
  }
};

double sum_at(const LeastSquaresProblem& problem, const std::vector<double>& p) {
  std::vector<double> r(problem.residuals);
  EXPECT_TRUE(problem.evaluate(p, r));
  double sum = 0.0;
  for (const double x : r) sum += x * x;
  return sum;
}

LeastSquaresFit quick_fit(const LeastSquaresProblem& problem, const std::vector<double>& start) {
  LeastSquaresOptions quick;
  quick.thorough = false;
  return fit_least_squares(problem, {start}, quick);
}

LeastSquaresFit without_kinks(LeastSquaresProblem problem, const std::vector<double>& start) {
  problem.kinks = nullptr;
  return quick_fit(problem, start);
}

/// The least S with one parameter where it is: the others by a smooth fit on the kink, which p[1] = 0.45 - 0.3 p[2]^2
/// leaves two of.
std::vector<double> best_on_the_kink(const Corner& corner) {
  LeastSquaresProblem reduced;
  const LeastSquaresProblem full = corner.problem();
  reduced.residuals = full.residuals;
  reduced.evaluate = [full](std::span<const double> q, std::span<double> r) {
    return full.evaluate(std::vector{q[0], 0.45 - 0.3 * q[1] * q[1] + 1e-15, q[1]}, r);
  };
  const LeastSquaresFit fit = fit_least_squares(reduced, {{1.0, 0.1}});
  EXPECT_EQ(fit.end, FitEnd::converged) << fit.message;
  return {fit.parameters[0], 0.45 - 0.3 * fit.parameters[1] * fit.parameters[1], fit.parameters[1]};
}

TEST(KinkMinimum, FitThatStallsAtOneEndsInItWithErrors) {
  const Corner corner;
  const LeastSquaresProblem problem = corner.problem();
  const LeastSquaresFit stalled = without_kinks(problem, {0.8, 0.2, 0.5});
  ASSERT_NE(stalled.end, FitEnd::converged) << stalled.message;
  const LeastSquaresFit fit = quick_fit(problem, {0.8, 0.2, 0.5});
  ASSERT_TRUE(fit.usable()) << fit.message;
  EXPECT_EQ(fit.kinks, 1U);
  EXPECT_NE(fit.message.find("on a kink of the residuals"), std::string::npos) << fit.message;
  EXPECT_LE(fit.residual_sum_of_squares, stalled.residual_sum_of_squares * (1.0 + 1e-12));
  const std::vector<double> best = best_on_the_kink(corner);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(fit.parameters[j], best[j], 1e-6) << j;
    EXPECT_TRUE(std::isfinite(fit.standard_deviations[j]) && fit.standard_deviations[j] > 0.0) << j;
  }
  EXPECT_NEAR(Corner::threshold(fit.parameters), 0.45, 1e-10);
}

/// S rises by at least one residual variance where one parameter is a standard deviation away, however the others are.
TEST(KinkMinimum, ErrorsAreNotTooSmall) {
  LeastSquaresProblem problem = Corner{}.problem();
  const LeastSquaresFit fit = quick_fit(problem, {0.8, 0.2, 0.5});
  ASSERT_TRUE(fit.usable()) << fit.message;
  const double variance = fit.residual_standard_deviation * fit.residual_standard_deviation;
  for (std::size_t j = 0; j < 3; ++j)
    for (const double side : {-1.0, 1.0}) {
      std::vector<double> start = fit.parameters;
      start[j] += side * fit.standard_deviations[j];
      problem.bounds.assign(3, {});
      problem.bounds[j] = {start[j], start[j]};
      const LeastSquaresFit aside = quick_fit(problem, start);
      EXPECT_GT(aside.residual_sum_of_squares, fit.residual_sum_of_squares + 0.7 * variance) << j << " " << side;
    }
}

TEST(KinkMinimum, FitThatConvergesIsLeftAsItIs) {
  Corner corner;
  corner.fall = 0.4;
  const LeastSquaresProblem problem = corner.problem();
  const LeastSquaresFit plain = without_kinks(problem, {0.8, 0.2, 0.5});
  const LeastSquaresFit fit = quick_fit(problem, {0.8, 0.2, 0.5});
  ASSERT_EQ(plain.end, FitEnd::converged) << plain.message;
  EXPECT_EQ(fit.parameters, plain.parameters);
  EXPECT_EQ(fit.covariance, plain.covariance);
  EXPECT_EQ(fit.message, plain.message);
  EXPECT_EQ(fit.kinks, 0U);
}

/// Two thresholds that cross at the origin, and lines that pull p[0] and p[1] above them.
LeastSquaresProblem two_corners(double pull) {
  LeastSquaresProblem out;
  out.residuals = 5;
  out.evaluate = [pull](std::span<const double> p, std::span<double> r) {
    r[0] = 1.0 + std::max(0.0, p[0] + 0.5 * p[1]);
    r[1] = 1.0 + std::max(0.0, p[1] - 0.5 * p[0]);
    r[2] = 0.6 * (p[0] - pull);
    r[3] = 0.6 * (p[1] - pull);
    r[4] = p[2] - 3.0;
    return true;
  };
  out.jacobian = [](std::span<const double> p, std::span<double> j) {
    const double first = p[0] + 0.5 * p[1] > 0.0 ? 1.0 : 0.0;
    const double second = p[1] - 0.5 * p[0] > 0.0 ? 1.0 : 0.0;
    const double rows[15] = {first, 0.5 * first, 0.0, -0.5 * second, second, 0.0, 0.6, 0.0,
                             0.0,   0.0,         0.6, 0.0,           0.0,    0.0, 1.0};
    std::copy(std::begin(rows), std::end(rows), j.begin());
    return true;
  };
  out.kinks = [](std::span<const double> p) { return std::vector{p[0] + 0.5 * p[1], p[1] - 0.5 * p[0]}; };
  return out;
}

TEST(KinkMinimum, SeveralKinksAreHeldTogether) {
  const LeastSquaresFit fit = quick_fit(two_corners(1.0), {0.4, 0.7, 1.0});
  ASSERT_TRUE(fit.usable()) << fit.message;
  EXPECT_EQ(fit.kinks, 2U);
  EXPECT_NE(fit.message.find("on 2 kinks of the residuals"), std::string::npos) << fit.message;
  EXPECT_NEAR(fit.parameters[0], 0.0, 1e-9);
  EXPECT_NEAR(fit.parameters[1], 0.0, 1e-9);
  EXPECT_NEAR(fit.parameters[2], 3.0, 1e-9);
  EXPECT_GT(fit.standard_deviations[0], 0.0);
}

/// A strong pull leaves one of the two behind: the search does not stay where it begins.
TEST(KinkMinimum, KinkWithALowerSideIsLeft) {
  const LeastSquaresProblem problem = two_corners(4.0);
  const auto found = find_kink_minimum(problem, {0.0, 0.0, 3.0}, 1e-11);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kinks, 1U);
  const double p0 = 1.82 / 4.025;  // dS/dp[0] = 0 with p[1] = p[0]/2
  EXPECT_NEAR(found->parameters[0], p0, 1e-9);
  EXPECT_NEAR(found->parameters[1], 0.5 * p0, 1e-9);
  EXPECT_LT(sum_at(problem, found->parameters), sum_at(problem, {0.0, 0.0, 3.0}));
}

/// Slopes of the wrong sign: no strategy gets anywhere, and neither does the search.
TEST(KinkMinimum, StallOffAMinimumStaysOne) {
  LeastSquaresProblem problem = Corner{}.problem();
  problem.jacobian = [plain = problem](std::span<const double> p, std::span<double> jacobian) {
    plain.jacobian(p, jacobian);
    for (double& x : jacobian) x = -x;
    return true;
  };
  for (const std::vector<double>& start : {std::vector{0.8, 0.2, 0.5}, {0.8, 0.45, 0.0}}) {
    const LeastSquaresFit fit = quick_fit(problem, start);
    EXPECT_EQ(fit.end, FitEnd::stalled) << fit.message;
    EXPECT_EQ(fit.kinks, 0U);
    EXPECT_FALSE(find_kink_minimum(problem, start, 1e-11));
  }
}

/// A corner that the problem does not name is none to end in, and one that is a ridge neither.
TEST(KinkMinimum, OnlyNamedCornersWithARiseOnBothSidesCount) {
  LeastSquaresProblem problem = two_corners(1.0);
  problem.kinks = [](std::span<const double> p) { return std::vector{p[2] - 3.0}; };
  const LeastSquaresFit fit = quick_fit(problem, {0.4, 0.7, 1.0});
  EXPECT_NE(fit.end, FitEnd::converged) << fit.message;
  LeastSquaresProblem ridge;
  ridge.residuals = 2;
  ridge.evaluate = [](std::span<const double> p, std::span<double> r) {
    r[0] = std::max(0.0, p[0]) - 1.0;
    r[1] = 0.5 * (p[0] + 1.0);
    return true;
  };
  ridge.jacobian = [](std::span<const double> p, std::span<double> j) {
    j[0] = p[0] > 0.0 ? 1.0 : 0.0;
    j[1] = 0.5;
    return true;
  };
  ridge.kinks = [](std::span<const double> p) { return std::vector{p[0]}; };
  const auto found = find_kink_minimum(ridge, {0.0}, 1e-11);
  EXPECT_TRUE(!found || found->kinks == 0U);
}

TEST(KinkMinimum, ParametersOnBoundsStayThere) {
  LeastSquaresProblem problem = two_corners(1.0);
  problem.bounds = {{-1.0, 1.0}, {-1.0, 1.0}, {0.0, 2.0}};
  const LeastSquaresFit fit = quick_fit(problem, {0.4, 0.7, 1.0});
  ASSERT_EQ(fit.end, FitEnd::converged) << fit.message;
  EXPECT_NEAR(fit.parameters[2], 2.0, 1e-8);
  EXPECT_TRUE(fit.at_bound[2]);
  EXPECT_EQ(fit.kinks, 2U);
}

}  // namespace
}  // namespace softgrain
