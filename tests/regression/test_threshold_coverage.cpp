// Statistics of the threshold fit over many synthetic ensembles: no bias beyond its error, honest errors, intervals
// that cover.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "calibrate/threshold_fit.h"
#include "tests/support/synthetic_law.h"

namespace {

using namespace softgrain;
using test::synthetic;
using test::SyntheticOptions;

constexpr int kEnsembles = 120;

struct Tally {
  int inside = 0;
  double sum = 0.0;
  double squares = 0.0;
  double errors = 0.0;

  void add(double value, double error, bool covered) {
    inside += covered ? 1 : 0;
    sum += value;
    squares += value * value;
    errors += error;
  }
  [[nodiscard]] double mean() const { return sum / kEnsembles; }
  [[nodiscard]] double deviation() const { return std::sqrt((squares - sum * sum / kEnsembles) / (kEnsembles - 1)); }
  [[nodiscard]] double coverage() const { return static_cast<double>(inside) / kEnsembles; }
  [[nodiscard]] double stated_error() const { return errors / kEnsembles; }
};

/// 32 packings as measured ones scatter: 12 % between packings, 10 % between points, two curves for one threshold.
SyntheticOptions ensemble(std::uint64_t seed) {
  SyntheticOptions o;
  o.packings = 32;
  o.factor_scatter = 0.12;
  o.point_scatter = 0.10;
  o.seed = seed;
  return o;
}

TEST(ThresholdCoverage, IntervalsCoverTheTruth) {
  Tally b, delta, a_t, force;
  int good = 0;
  FitOptions options;
  options.replicates = 300;
  const SyntheticOptions truth;
  const std::vector<double> at{0.2};
  for (std::uint64_t e = 0; e < kEnsembles; ++e) {
    const auto report = fit_pair_law(synthetic(ensemble(1000 + e)), PairKind::soft_solid, options);
    const PairLaw& law = report.law;
    good += law.status == LawStatus::good ? 1 : 0;
    const auto covers = [](const Estimate& x, double value) { return x.low <= value && value <= x.high; };
    b.add(law.normal.b.value, law.normal.b.standard_error, covers(law.normal.b, truth.normal.b));
    delta.add(law.normal.delta.value, law.normal.delta.standard_error, covers(law.normal.delta, truth.normal.delta));
    a_t.add(law.tangential_initial.a.value, law.tangential_initial.a.standard_error,
            covers(law.tangential_initial.a, truth.a_initial));
    const Band band = law_band(report, LawCurve::normal, at).front();
    const double f = truth.normal.value(0.2);
    force.add(band.value / f, 0.25 * (band.high - band.low) / f, band.low <= f && f <= band.high);
  }
  if (std::getenv("SOFTGRAIN_PRINT_DIGITS") != nullptr)
    for (const Tally* t : {&b, &delta, &a_t, &force})
      std::printf("mean %.6f deviation %.6f stated %.6f coverage %.3f\n", t->mean(), t->deviation(), t->stated_error(),
                  t->coverage());
  EXPECT_EQ(good, kEnsembles);
  // Bias: within four standard errors of the mean over ensembles, or one per cent.
  const auto unbiased = [](const Tally& t, double value) {
    return std::abs(t.mean() - value) <= std::max(4.0 * t.deviation() / std::sqrt(kEnsembles), 0.01 * value);
  };
  EXPECT_TRUE(unbiased(b, truth.normal.b)) << b.mean();
  EXPECT_TRUE(unbiased(delta, truth.normal.delta)) << delta.mean();
  EXPECT_TRUE(unbiased(force, 1.0)) << force.mean();
  for (const Tally* t : {&b, &delta, &a_t, &force}) {
    // 95 % nominal; binomial error of 120 ensembles is 2 %.
    EXPECT_GE(t->coverage(), 0.85);
    EXPECT_LE(t->coverage(), 0.995);
    // Stated errors agree with the scatter that actually occurs (whose own error is 6.5 %).
    EXPECT_NEAR(t->stated_error() / t->deviation(), 1.0, 0.25);
  }
}

/// Soft-soft contacts of seven packings as the published ones are: overlaps from 0.1 to 0.4 with a threshold at half of
/// that, 25 % between packings.
SyntheticOptions seven(std::uint64_t seed) {
  SyntheticOptions o;
  o.normal = {0.28, 5.7, 0.21};
  o.kind = PairKind::soft_soft;
  o.deltas = {0.10, 0.125, 0.15, 0.175, 0.20, 0.225, 0.25, 0.275, 0.30, 0.325, 0.35, 0.375, 0.40};
  o.a_initial = 0.0;
  o.packings = 7;
  o.factor_scatter = 0.25;
  o.point_scatter = 0.15;
  o.seed = seed;
  return o;
}

struct Seven {
  int a = 0;
  int b = 0;
  int delta = 0;
  int force = 0;
};

Seven coverage_of_seven(int ensembles) {
  Seven out;
  const SyntheticOptions truth = seven(0);
  const std::vector<double> at{0.35};
  FitOptions options;
  options.replicates = 200;
  for (int e = 0; e < ensembles; ++e) {
    const auto report = fit_pair_law(synthetic(seven(5000 + static_cast<std::uint64_t>(e))), truth.kind, options);
    const auto covers = [](double low, double high, double value) { return low <= value && value <= high ? 1 : 0; };
    const ThresholdPowerLaw& n = report.law.normal;
    out.a += covers(n.a.low, n.a.high, truth.normal.a);
    out.b += covers(n.b.low, n.b.high, truth.normal.b);
    out.delta += covers(n.delta.low, n.delta.high, truth.normal.delta);
    const Band band = law_band(report, LawCurve::normal, at).front();
    out.force += covers(band.low, band.high, truth.normal.value(0.35));
  }
  if (std::getenv("SOFTGRAIN_PRINT_DIGITS") != nullptr)
    std::printf("seven packings, %d ensembles: a %d b %d delta %d force %d\n", ensembles, out.a, out.b, out.delta,
                out.force);
  return out;
}

/// Quantiles of replicates alone hold the truth in four fifths of such ensembles.
TEST(ThresholdCoverage, IntervalsOfSevenPackingsCoverTheTruthToo) {
  constexpr int kFew = 80;
  const Seven found = coverage_of_seven(kFew);
  for (const int n : {found.a, found.b, found.delta, found.force}) EXPECT_GE(n, 0.86 * kFew);
}

TEST(SlowThresholdCoverage, IntervalsOfSevenPackingsCoverTheTruthAsOftenAsTheySay) {
  constexpr int kMany = 600;
  const Seven found = coverage_of_seven(kMany);
  for (const int n : {found.a, found.b, found.delta, found.force}) {
    EXPECT_GE(n, 0.91 * kMany);
    EXPECT_LE(n, 0.99 * kMany);
  }
}

TEST(ThresholdCoverage, ErrorsShrinkWithTheRootOfPackings) {
  FitOptions options;
  options.replicates = 200;
  const auto error = [&](int packings) {
    SyntheticOptions o = ensemble(77);
    o.packings = packings;
    return fit_pair_law(synthetic(o), PairKind::soft_solid, options).law.normal.delta.standard_error;
  };
  EXPECT_NEAR(error(400) / error(100), 0.5, 0.12);
}

TEST(ThresholdCoverage, QualityTellsAWrongLaw) {
  // A force that saturates is no threshold power law; 10 % scatter over 200 packings must show it.
  SyntheticOptions o = ensemble(5);
  o.packings = 200;
  o.a_initial = 0.0;
  FitOptions options;
  options.replicates = 100;
  EXPECT_GT(fit_pair_law(synthetic(o), PairKind::soft_solid, options).law.quality, 1e-3);
  auto wrong = synthetic(o);
  for (auto& run : wrong.runs)
    for (auto& p : run.normal) p.force /= 1.0 + std::pow(p.delta / 0.15, 8);
  EXPECT_LT(fit_pair_law(wrong, PairKind::soft_solid, options).law.quality, 1e-6);
}

}  // namespace
