// The search for parameters on a model that is known: found within its interval, honest about what is not determined.
#include "calibrate/inverse_search.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "calibrate/response_surface.h"
#include "common/core/error.h"
#include "tests/support/synthetic_law.h"

namespace {

using namespace softgrain;
using test::normal_number;

const std::vector<double> kDeltas{0.1, 0.15, 0.2, 0.25, 0.3};

/// A made-up soft particle: u_0 raises the force, u_1 its exponent; packings differ by a factor.
double force(const std::vector<double>& u, double d) {
  return 100.0 * std::exp(1.5 * (u[0] - 0.5)) * std::pow(d, 2.5 + (u.size() > 1 ? u[1] : 0.5));
}

InverseEvaluation evaluate(const std::vector<double>& u, std::size_t packings, double scatter, std::uint64_t seed) {
  InverseEvaluation e;
  e.u = u;
  e.packings = packings;
  for (std::size_t k = 0; k < packings; ++k) {
    RandomStream random(seed, RandomPurpose::test, k);
    const double factor = std::exp(scatter * normal_number(random));
    for (const double d : kDeltas)
      e.force.push_back(factor * force(u, d) * (1.0 + 0.2 * scatter * normal_number(random)));
  }
  return e;
}

InverseTarget target_at(const std::vector<double>& truth, std::size_t packings, double scatter, std::uint64_t seed) {
  const InverseEvaluation made = evaluate(truth, packings, scatter, seed);
  InverseTarget t;
  t.delta = kDeltas;
  t.discrepancy = 0.02;
  for (std::size_t j = 0; j < kDeltas.size(); ++j) {
    double sum = 0.0;
    for (std::size_t k = 0; k < packings; ++k) sum += made.force[k * kDeltas.size() + j];
    t.force.push_back(sum / static_cast<double>(packings));
    t.error.push_back(scatter * t.force.back() / std::sqrt(static_cast<double>(packings)));
  }
  return t;
}

std::vector<InverseEvaluation> search(const InverseTarget& t, std::size_t d, std::size_t packings, double scatter,
                                      std::uint64_t seed) {
  std::vector<InverseEvaluation> done;
  for (std::size_t k = 0; k < 12; ++k) done.push_back(evaluate(spread_point(seed, k, d), packings, scatter, seed));
  for (int round = 0; round < 3; ++round)
    for (const auto& u : next_points(done, t, seed, 4)) done.push_back(evaluate(u, packings, scatter, seed));
  return done;
}

TEST(ResponseSurface, ReproducesAQuadraticAndItsGradient) {
  const auto f = [](const std::vector<double>& u) {
    return std::vector<double>{1.0 + 2.0 * u[0] - u[1] + 3.0 * u[0] * u[1] + u[1] * u[1], u[0]};
  };
  std::vector<std::vector<double>> points;
  std::vector<std::vector<double>> values;
  for (std::size_t k = 0; k < 15; ++k) {
    points.push_back(spread_point(1, k, 2));
    values.push_back(f(points.back()));
  }
  const ResponseSurface surface(points, values, std::vector<double>(15, 1.0));
  const std::vector<double> u{0.3, 0.8};
  EXPECT_NEAR(surface.value(u)[0], f(u)[0], 2e-3);  // a small ridge pulls towards flat
  const auto g = surface.gradient(u);
  const double h = 1e-5;
  EXPECT_NEAR(g[0], (surface.value({0.3 + h, 0.8})[0] - surface.value({0.3 - h, 0.8})[0]) / (2 * h), 1e-8);
  EXPECT_NEAR(g[1], (surface.value({0.3, 0.8 + h})[0] - surface.value({0.3, 0.8 - h})[0]) / (2 * h), 1e-8);
  const SurfaceMinimum m = nearest_to(surface, surface.value(u), {0.1, 0.1}, {{0.5, 0.5}, {0.1, 0.9}});
  EXPECT_NEAR(m.u[0], 0.3, 1e-3);
  EXPECT_NEAR(m.u[1], 0.8, 1e-3);
}

TEST(ResponseSurface, RefusesWhatDoesNotFit) {
  EXPECT_THROW(ResponseSurface({{0.5}}, {{1.0}}, {}), InputError);
  EXPECT_THROW(ResponseSurface({{0.5}}, {{1.0}}, {0.0}), InputError);
}

TEST(SpreadPoint, FillsTheBoxEvenly) {
  constexpr std::size_t kPoints = 64;
  std::vector<int> cells(16, 0);
  for (std::size_t k = 0; k < kPoints; ++k) {
    const auto u = spread_point(5, k, 2);
    ASSERT_TRUE(u[0] >= 0.0 && u[0] < 1.0 && u[1] >= 0.0 && u[1] < 1.0);
    ++cells[static_cast<std::size_t>(4.0 * u[0]) * 4 + static_cast<std::size_t>(4.0 * u[1])];
  }
  EXPECT_GE(*std::min_element(cells.begin(), cells.end()), 2);
  EXPECT_LE(*std::max_element(cells.begin(), cells.end()), 7);
}

TEST(InverseSearch, WithoutNoiseFindsTheTruth) {
  const std::vector<double> truth{0.62, 0.31};
  const InverseTarget t = target_at(truth, 4, 0.0, 1);
  const InverseAnswer a = answer(search(t, 2, 4, 0.0, 7), t, 7, 40);
  EXPECT_NEAR(a.u[0], truth[0], 0.02);
  EXPECT_NEAR(a.u[1], truth[1], 0.04);
  EXPECT_LT(a.misfit, 0.1);
}

/// Target and search by different packings. Of 24 x 2 intervals at the nominal 95 % at most 6 may miss (probability 2
/// %).
TEST(InverseSearch, IntervalsHoldTheTruth) {
  const std::vector<double> truth{0.55, 0.4};
  int missed = 0;
  double width = 0.0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const InverseTarget t = target_at(truth, 12, 0.15, 1000 + seed);
    const InverseAnswer a = answer(search(t, 2, 8, 0.15, seed), t, seed, 100);
    for (std::size_t k = 0; k < 2; ++k) {
      missed += a.low[k] <= truth[k] && truth[k] <= a.high[k] ? 0 : 1;
      width += (a.high[k] - a.low[k]) / 48.0;
      EXPECT_LE(a.low[k], a.u[k]);
      EXPECT_GE(a.high[k], a.u[k]);
    }
  }
  EXPECT_LE(missed, 6);
  EXPECT_LT(width, 0.6);
}

TEST(InverseSearch, SaysWhatTheTargetDoesNotDetermine) {
  const auto blind = [](std::vector<double> u) {
    InverseEvaluation e = evaluate({u[0]}, 6, 0.1, 3);
    e.u = std::move(u);
    return e;
  };
  const InverseTarget t = target_at({0.5}, 10, 0.1, 99);
  std::vector<InverseEvaluation> done;
  for (std::size_t k = 0; k < 24; ++k) done.push_back(blind(spread_point(3, k, 2)));
  const InverseAnswer a = answer(done, t, 3, 100);
  EXPECT_FALSE(a.open[0]);
  EXPECT_TRUE(a.open[1]);
  EXPECT_GT(a.high[1] - a.low[1], 0.5);
}

TEST(InverseSearch, MissingForcesAreLeftOut) {
  const InverseTarget t = target_at({0.5, 0.5}, 4, 0.05, 1);
  auto done = search(t, 2, 4, 0.05, 2);
  for (double& f : done[3].force) f = std::nan("");
  done[4].force[0] = std::nan("");
  EXPECT_FALSE(done[3].usable(kDeltas.size()));
  EXPECT_TRUE(done[4].usable(kDeltas.size()));
  EXPECT_TRUE(std::isinf(misfit_of(done[3], t)));
  EXPECT_NO_THROW(answer(done, t, 2, 20));
  done.resize(4);
  EXPECT_THROW(answer(done, t, 2, 20), UnusableResult);
}

TEST(InverseSearch, DoesNotDependOnThreads) {
  const InverseTarget t = target_at({0.5, 0.5}, 4, 0.1, 1);
  const int before = omp_get_max_threads();
  std::vector<InverseAnswer> answers;
  std::vector<std::vector<std::vector<double>>> points;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    const auto done = search(t, 2, 4, 0.1, 2);
    answers.push_back(answer(done, t, 2, 30));
    points.push_back(next_points(done, t, 2, 4));
  }
  omp_set_num_threads(before);
  for (std::size_t k = 1; k < answers.size(); ++k) {
    EXPECT_EQ(answers[0].u, answers[k].u);
    EXPECT_EQ(answers[0].low, answers[k].low);
    EXPECT_EQ(answers[0].high, answers[k].high);
    EXPECT_EQ(answers[0].misfit, answers[k].misfit);
    EXPECT_EQ(points[0], points[k]);
  }
  const InverseAnswer other = answer(search(t, 2, 4, 0.1, 3), t, 3, 30);
  EXPECT_NE(answers[0].low, other.low) << "another seed is another search";
}

}  // namespace
