// Monotone curves through points: nothing beyond them, and the same as GSL's.
#include <gsl/gsl_spline.h>
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "common/core/monotone_curve.h"
#include "common/core/random.h"

namespace softgrain {
namespace {

TEST(MonotoneCurve, GoesThroughItsPointsAndNeverBeyond) {
  const std::vector<double> x{0.0, 1.0, 1.5, 4.0, 5.0};
  const std::vector<double> y{0.0, 0.1, 2.0, 2.0, 7.0};
  const MonotoneCurve curve(x, y);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_DOUBLE_EQ(curve.value(x[k]), y[k]);
  double last = 0.0;
  for (int k = 0; k <= 500; ++k) {
    EXPECT_GE(curve.value(0.01 * k), last - 1e-14);
    last = curve.value(0.01 * k);
  }
  EXPECT_EQ(curve.value(2.5), 2.0);  // flat between equal points
  EXPECT_EQ(curve.value(-3.0), 0.0);
  EXPECT_EQ(curve.value(30.0), 7.0);
  EXPECT_EQ(curve.low(), 0.0);
  EXPECT_EQ(curve.high(), 5.0);
}

TEST(MonotoneCurve, IsWhatGslMakesOfSteffensMethod) {
  RandomStream random(8, RandomPurpose::test, 0);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<double> x{random.uniform()};
    std::vector<double> y{random.uniform()};
    for (int k = 0; k < 2 + trial % 7; ++k) {
      x.push_back(x.back() + 0.01 + random.uniform());
      y.push_back(trial % 2 == 0 ? random.uniform() : y.back() + random.uniform());  // wavy, rising
    }
    const std::unique_ptr<gsl_spline, void (*)(gsl_spline*)> gsl(gsl_spline_alloc(gsl_interp_steffen, x.size()),
                                                                 gsl_spline_free);
    gsl_spline_init(gsl.get(), x.data(), y.data(), x.size());
    const MonotoneCurve curve(x, y);
    for (int k = 1; k < 200; ++k) {
      const double at = x.front() + (x.back() - x.front()) * k / 200.0;
      EXPECT_NEAR(curve.value(at), gsl_spline_eval(gsl.get(), at, nullptr), 1e-13) << trial << ", " << at;
    }
  }
}

TEST(MonotoneCurve, OneAndTwoPoints) {
  EXPECT_TRUE(MonotoneCurve().empty());
  EXPECT_EQ(MonotoneCurve({1.0}, {3.0}).value(-7.0), 3.0);
  const MonotoneCurve line({1.0, 3.0}, {2.0, 6.0});
  EXPECT_DOUBLE_EQ(line.value(1.5), 3.0);
  EXPECT_EQ(line.value(0.0), 2.0);
  EXPECT_THROW(MonotoneCurve({1.0, 1.0}, {2.0, 3.0}), std::invalid_argument);
  EXPECT_THROW(MonotoneCurve({1.0, 2.0}, {2.0}), std::invalid_argument);
}

}  // namespace
}  // namespace softgrain
