// The scattering model against closed forms and quadrature; its fit against known parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibrate/scattering_fit.h"
#include "common/core/error.h"
#include "common/core/random.h"

namespace softgrain {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ScatteringModel, ClosedFormsOfTheDecay) {
  for (const double x : {0.0, 1e-3, 0.3, 0.99, 1.0, 3.0, 30.0, 1e3}) {
    EXPECT_NEAR(fractal_decay(1.0, x) * std::sqrt(1.0 + x * x), 1.0, 1e-12) << x;       // of exp(-r)/r
    EXPECT_NEAR(fractal_decay(2.0, x) * std::pow(1.0 + x * x, 1.5), 1.0, 1e-11) << x;   // of exp(-r)
    EXPECT_NEAR(fractal_decay(3.0, x) * std::pow(1.0 + x * x, 2.5), 1.0 - 0.5 * x * x,  // of r exp(-r)
                1e-10 * (1.0 + x * x))
        << x;
  }
  EXPECT_TRUE(std::isnan(fractal_decay(0.0, 1.0)));
  EXPECT_TRUE(std::isnan(fractal_decay(1.0, -1.0)));
}

/// int_0^inf r^(dF-1) exp(-r) J0(x r) dr/Gamma(dF), with r = u^4 to tame the singularity, by Simpson's rule.
double quadrature(double dimension, double x) {
  const int n = 20000;
  const double last = std::pow(45.0, 0.25);
  double sum = 0.0;
  for (int k = 1; k <= n; ++k) {
    const double u = last * k / n;
    const double r = std::pow(u, 4.0);
    const double f = 4.0 * std::pow(u, 4.0 * dimension - 1.0) * std::exp(-r) * std::cyl_bessel_j(0.0, x * r);
    sum += (k == n ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * f;
  }
  return sum * last / (3.0 * n * std::tgamma(dimension));
}

TEST(ScatteringModel, IsTheHankelTransformOfTheCorrelation) {
  for (const double dimension : {1.3, 1.5, 1.75, 1.95, 2.0})
    for (const double x : {0.1, 1.0, 5.0, 15.0})
      EXPECT_NEAR(fractal_decay(dimension, x), quadrature(dimension, x), 1e-9) << dimension << " " << x;
}

/// 2F1(a, b; 1; z) by its series for |z| < 1, without any transformation.
TEST(ScatteringModel, EqualsTheSeriesInsideItsCircle) {
  for (const double dimension : {0.1, 0.7, 1.55, 1.99})
    for (const double x : {0.2, 0.6, 0.8}) {
      double term = 1.0;
      double sum = 1.0;
      for (int n = 0; n < 400; ++n) {
        term *= (0.5 * (1.0 + dimension) + n) * (0.5 * dimension + n) / ((n + 1.0) * (n + 1.0)) * -x * x;
        sum += term;
      }
      EXPECT_NEAR(fractal_decay(dimension, x), sum, 1e-13);
    }
}

TEST(ScatteringModel, FallsWithThePowerOfTheDimension) {
  for (const double dimension : {0.5, 1.2, 1.7}) {
    const double slope = std::log(fractal_decay(dimension, 2e3) / fractal_decay(dimension, 1e3)) / std::log(2.0);
    EXPECT_NEAR(slope, -dimension, 3e-3);
  }
}

TEST(ScatteringModel, LowerLengthIsThatOfTheAmplitude) {
  const double l = 0.6;
  const double xi = 7.0;
  const double d = 1.6;
  const double phi = 0.36;
  const ScatteringModel m{phi * 2.0 * kPi * l * l * std::tgamma(d) * std::pow(xi / l, d), d, xi, 0.1};
  EXPECT_NEAR(scattering_lower_length(m, phi), l, 1e-12);
}

const ScatteringModel kTruth{12.0, 1.55, 6.0, 0.08};

/// Mean intensity of the modes of a periodic square of edge 42 in bins, each mode exponentially distributed.
ScatteringCurve synthetic(const ScatteringModel& truth, std::uint64_t index, double edge = 42.0) {
  RandomStream random(3, RandomPurpose::test, index);
  ScatteringCurve curve;
  const double unit = 2.0 * kPi / edge;
  for (int n = 1; n * unit < 2.2; ++n) {
    const double k = n * unit;
    const double modes = std::max(2.0, std::round(kPi * n));
    double sum = 0.0;
    for (int m = 0; m < static_cast<int>(modes); ++m) sum -= std::log(random.uniform());
    curve.k.push_back(k);
    curve.modes.push_back(modes);
    curve.intensity.push_back(scattering_intensity(truth, k) * sum / modes);
  }
  return curve;
}

ScatteringFitOptions options() {
  ScatteringFitOptions o;
  o.k_high = 2.0;
  o.cell_length = 42.0;
  return o;
}

TEST(ScatteringFit, RecoversExactParameters) {
  for (const ScatteringModel& truth :
       {kTruth, ScatteringModel{40.0, 1.9, 9.0, 0.05}, ScatteringModel{5.0, 1.1, 4.0, 0.3}}) {
    ScatteringCurve curve = synthetic(truth, 0);
    for (std::size_t n = 0; n < curve.size(); ++n) {
      curve.modes[n] = 1e9;  // no bias left
      curve.intensity[n] = scattering_intensity(truth, curve.k[n]);
    }
    const ScatteringFit fit = fit_scattering({curve}, options());
    EXPECT_TRUE(fit.usable) << fit.reason;
    EXPECT_NEAR(fit.model.dimension, truth.dimension, 1e-4);
    EXPECT_NEAR(fit.model.length, truth.length, 1e-3);
    EXPECT_NEAR(fit.model.amplitude, truth.amplitude, 1e-3 * truth.amplitude);
    EXPECT_NEAR(fit.model.background, truth.background, 1e-4);
    EXPECT_LE(fit.k_high, 2.0);
    EXPECT_NEAR(fit.k_low, 2.0 * kPi / 42.0, 1e-12);
  }
}

/// Deviations over standard errors have mean 0 and deviation 1; intervals cover 95 %; chi^2 is about its degrees.
TEST(ScatteringFit, ErrorsAreThoseOfTheScatter) {
  const int trials = 60;
  double sum = 0.0;
  double square = 0.0;
  double length_square = 0.0;
  double chi2 = 0.0;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    // Three samples in cells of 14 xi: xi is then known well enough for errors from the curvature.
    std::vector<ScatteringCurve> curves;
    for (int s = 0; s < 3; ++s) curves.push_back(synthetic(kTruth, static_cast<std::uint64_t>(100 * t + s + 1), 84.0));
    ScatteringFitOptions wide;
    wide.k_high = 2.0;
    wide.cell_length = 84.0;
    const ScatteringFit fit = fit_scattering(curves, wide);
    ASSERT_TRUE(fit.usable) << fit.reason;
    const double pull = (fit.dimension.value - kTruth.dimension) / fit.dimension.error;
    sum += pull;
    square += pull * pull;
    const double length_pull = std::log(fit.length.value / kTruth.length) * fit.length.value / fit.length.error;
    length_square += length_pull * length_pull / trials;
    chi2 += fit.chi2_per_degree / trials;
    covered += fit.dimension.low <= kTruth.dimension && kTruth.dimension <= fit.dimension.high ? 1 : 0;
  }
  const double mean = sum / trials;
  EXPECT_NEAR(mean, 0.0, 4.0 / std::sqrt(trials) + 0.2);
  EXPECT_NEAR(std::sqrt(square / trials - mean * mean), 1.0, 0.3);
  EXPECT_NEAR(std::sqrt(length_square), 1.0, 0.35);
  EXPECT_GE(covered, 51);  // of 57 expected
  EXPECT_NEAR(chi2, 1.0, 0.03);
}

TEST(ScatteringFit, ASingleSampleIsFittedWithWideErrors) {
  const ScatteringFit one = fit_scattering({synthetic(kTruth, 9001)}, options());
  std::vector<ScatteringCurve> many;
  for (std::uint64_t s = 0; s < 9; ++s) many.push_back(synthetic(kTruth, 9001 + s));
  const ScatteringFit nine = fit_scattering(many, options());
  EXPECT_GT(one.dimension.error, 1.5 * nine.dimension.error);
  EXPECT_EQ(nine.bins, 9 * one.bins);
}

TEST(ScatteringFit, BadDataAreReported) {
  const auto reason = [](const ScatteringCurve& curve, const ScatteringFitOptions& o = options()) {
    const ScatteringFit fit = fit_scattering({curve}, o);
    EXPECT_FALSE(fit.usable);
    return fit.reason;
  };
  EXPECT_NE(reason({}).find("0 bins"), std::string::npos);
  ScatteringCurve zero = synthetic(kTruth, 1);
  zero.intensity[3] = 0.0;
  EXPECT_NE(reason(zero).find("no positive"), std::string::npos);
  ScatteringFitOptions narrow = options();
  narrow.k_high = 0.6;
  EXPECT_NE(reason(synthetic(kTruth, 1), narrow).find("bins of k"), std::string::npos);
  ScatteringCurve flat = synthetic(kTruth, 1);
  for (double& i : flat.intensity) i = 0.4;
  EXPECT_NE(reason(flat), "");
  ScatteringCurve rising = synthetic(kTruth, 1);
  for (std::size_t n = 0; n < rising.size(); ++n) rising.intensity[n] = rising.k[n] * rising.k[n];
  EXPECT_NE(reason(rising), "");
  ScatteringFitOptions backwards;
  backwards.k_low = 4.0;
  EXPECT_THROW((void)fit_scattering({flat}, backwards), InputError);
}

/// Disks of l = 0.6 at the solid fraction of the truth; what the amplitude is follows from dF, xi and l.
ScatteringModel tied_truth(double dimension, double length, double background) {
  constexpr double kPhi = 0.36;
  constexpr double kLower = 0.6;
  return {kPhi * 2.0 * kPi * kLower * kLower * std::tgamma(dimension) * std::pow(length / kLower, dimension), dimension,
          length, background};
}

ScatteringFitOptions tied() {
  ScatteringFitOptions o = options();
  o.solid_fraction = 0.36;
  o.background_max = 0.19;
  return o;
}

TEST(ScatteringFit, ATiedAmplitudeGivesTheLowerLength) {
  for (const double dimension : {1.3, 1.55, 1.9}) {
    const ScatteringModel truth = tied_truth(dimension, 6.0, 0.08);
    ScatteringCurve curve = synthetic(truth, 0);
    for (std::size_t n = 0; n < curve.size(); ++n) {
      curve.modes[n] = 1e9;
      curve.intensity[n] = scattering_intensity(truth, curve.k[n]);
    }
    const ScatteringFit fit = fit_scattering({curve}, tied());
    EXPECT_TRUE(fit.usable) << fit.reason;
    EXPECT_NEAR(fit.model.dimension, dimension, 1e-4);
    EXPECT_NEAR(fit.lower_length.value, 0.6, 1e-3);
    EXPECT_NEAR(fit.model.amplitude, truth.amplitude, 1e-3 * truth.amplitude);
    EXPECT_TRUE(fit.bounded.empty()) << fit.bounded;
    // The error of the amplitude goes the way of the covariance.
    EXPECT_NEAR(fit.amplitude.error, std::sqrt(fit.covariance[0]) * fit.amplitude.value, 1e-9 * fit.amplitude.value);
  }
}

/// Four samples in cells of seven xi, as powders have them: what the disks allow keeps dF and xi nearer to the truth
/// than a free amplitude does.
TEST(ScatteringFit, WhatDisksAllowSteadiesFewSamples) {
  const ScatteringModel truth = tied_truth(1.55, 6.0, 0.08);
  constexpr int kTrials = 20;
  double free_square = 0.0;
  double tied_square = 0.0;
  double length_square = 0.0;
  int covered = 0;
  int usable = 0;
  for (int t = 0; t < kTrials; ++t) {
    std::vector<ScatteringCurve> curves;
    for (int k = 0; k < 4; ++k) curves.push_back(synthetic(truth, static_cast<std::uint64_t>(500 + 4 * t + k)));
    const ScatteringFit free = fit_scattering(curves, options());
    const ScatteringFit bound = fit_scattering(curves, tied());
    free_square += std::pow(free.model.dimension - 1.55, 2) / kTrials;
    tied_square += std::pow(bound.model.dimension - 1.55, 2) / kTrials;
    length_square += std::pow(std::log(bound.model.length / 6.0), 2) / kTrials;
    usable += bound.usable ? 1 : 0;
    covered += bound.dimension.low <= 1.55 && 1.55 <= bound.dimension.high ? 1 : 0;
  }
  EXPECT_GE(usable, 18);
  EXPECT_LT(tied_square, 0.6 * free_square);
  EXPECT_LT(std::sqrt(tied_square), 0.15);
  EXPECT_LT(std::sqrt(length_square), 0.7);
  EXPECT_GE(covered, 15) << "of 20: where a bound holds, the others' intervals are somewhat narrow";
}

/// An intensity that is a third of what l within the disks gives: the tie would bend dF and xi, so it is given up.
TEST(ScatteringFit, AnAmplitudeThatDisksDoNotAllowIsLeftFree) {
  ScatteringModel truth = tied_truth(1.55, 4.0, 0.02);
  truth.amplitude *= 0.33;
  std::vector<ScatteringCurve> curves;
  for (int k = 0; k < 8; ++k) curves.push_back(synthetic(truth, static_cast<std::uint64_t>(900 + k)));
  const ScatteringFit fit = fit_scattering(curves, tied());
  EXPECT_TRUE(fit.usable) << fit.reason;
  EXPECT_GT(fit.tie_cost, 3.84);
  EXPECT_EQ(fit.lower_length.value, 0.0);
  EXPECT_NEAR(fit.model.dimension, 1.55, 3.0 * fit.dimension.error);
  EXPECT_LT(fit.dimension.error, 0.25);
  EXPECT_NEAR(std::log(fit.model.length / 4.0), 0.0, 3.0 * fit.length.error / fit.model.length);
  EXPECT_LT(fit.chi2_per_degree, 1.4);
}

TEST(ScatteringFit, IndependentDisksScatterByTheirAreas) {
  EXPECT_DOUBLE_EQ(independent_intensity({1.0, 1.0}, 4.0), 2.0 * std::pow(0.25 * kPi, 2) / 4.0);
  ScatteringFitOptions wrong = tied();
  wrong.lower_length_max = 0.1;
  EXPECT_THROW((void)fit_scattering({synthetic(kTruth, 1)}, wrong), InputError);
}

TEST(ScatteringFit, LengthsOutsideTheCellOrTheDisksAreReported) {
  ScatteringCurve curve = synthetic(kTruth, 1);
  const auto with = [&](const ScatteringModel& truth) {
    for (std::size_t n = 0; n < curve.size(); ++n) {
      curve.modes[n] = 1e9;
      curve.intensity[n] = scattering_intensity(truth, curve.k[n]);
    }
    return fit_scattering({curve}, options()).reason;
  };
  EXPECT_NE(with({200.0, 1.5, 30.0, 0.1}).find("half the cell"), std::string::npos);
  EXPECT_NE(with({2.0, 1.5, 0.7, 0.1}).find("below the disks"), std::string::npos);
  EXPECT_NE(with({20.0, 2.4, 6.0, 0.1}).find("outside (0, 2]"), std::string::npos);
}

TEST(ScatteringFit, PooledCurvesKeepTheModes) {
  const ScatteringCurve a{{0.5, 1.5}, {2.0, 1.0}, {2.0, 4.0}};
  const ScatteringCurve b{{0.6, 2.5}, {5.0, 7.0}, {4.0, 1.0}};
  const ScatteringCurve mean = pooled_curve({a, b}, {0.0, 1.0, 2.0, 3.0});
  ASSERT_EQ(mean.size(), 3U);
  EXPECT_DOUBLE_EQ(mean.modes[0], 6.0);
  EXPECT_DOUBLE_EQ(mean.intensity[0], 4.0);
  EXPECT_DOUBLE_EQ(mean.k[0], (1.0 + 2.4) / 6.0);
  EXPECT_DOUBLE_EQ(mean.intensity[2], 7.0);
}

}  // namespace
}  // namespace softgrain
