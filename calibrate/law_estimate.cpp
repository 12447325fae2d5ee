#include "calibrate/threshold_fit.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "calibrate/bootstrap.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"

namespace softgrain {

namespace {

int count_values(const CurveSamples& s) {
  return static_cast<int>(std::count_if(s.value.begin(), s.value.end(), [](double x) { return !std::isnan(x); }));
}

int count_packings(const CurveSamples& s) {
  int n = 0;
  for (std::size_t i = 0; i < s.packings; ++i) {
    bool any = false;
    for (std::size_t k = 0; k < s.delta.size(); ++k) any = any || !std::isnan(s.at(i, k));
    n += any ? 1 : 0;
  }
  return n;
}

/// Values of a stiffness curve on the rows of the normal curve; NaN where it was not measured.
void fill_stiffness(const CurveMeans& means, const std::vector<double>& rows, std::vector<double>& mean,
                    std::vector<double>& deviation) {
  for (const double d : rows) {
    const auto it =
        std::find_if(means.delta.begin(), means.delta.end(), [d](double x) { return std::abs(x - d) < 1e-7; });
    const auto k = static_cast<std::size_t>(it - means.delta.begin());
    const bool found = it != means.delta.end();
    mean.push_back(found ? means.mean[k] : std::numeric_limits<double>::quiet_NaN());
    deviation.push_back(found ? means.deviation[k] : std::numeric_limits<double>::quiet_NaN());
  }
}

double constant_of(double a, double b, double delta) { return delta > 0.0 ? -a * std::pow(delta, b) : 0.0; }

/// Standard error of c = -a delta^b from the covariance of (a, b, delta) at rows i, j, 2; infinite where no threshold
/// shows, since c is bounded there and not linear.
double constant_error(const std::vector<double>& covariance, std::size_t i, std::size_t j, double a, double b,
                      double delta) {
  if (delta <= 0.0) return kInfinity;
  const double p = std::pow(delta, b);
  const std::array<std::size_t, 3> rows{i, j, 2};
  const std::array<double, 3> slope{-p, -a * p * std::log(delta), -a * b * p / delta};
  double variance = 0.0;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) variance += slope[r] * slope[c] * covariance[rows[r] * 7 + rows[c]];
  return std::sqrt(std::max(variance, 0.0));
}

/// 95 % interval of the replicates of a value that cannot be negative. Those of residuals may lean to one side, because
/// the best threshold follows the noise of the points around it: the longer side then counts for both. Those of
/// packings are too close to the value where packings are few.
std::pair<double, double> interval_of(const FitReport& report, double value, std::vector<double> replicates) {
  const auto [low, high] = interval95(std::move(replicates));
  if (!std::isfinite(low) || !std::isfinite(high)) return {low, high};
  if (!report.from_residuals) {
    const double factor = factor_of_several(static_cast<std::int64_t>(report.drawn_packings));
    return widened(value, low, high, factor, true);
  }
  const double half = std::max(value - low, high - value);
  return {std::max(0.0, value - half), value + half};
}

/// All replicates alike: what never scattered says nothing of how far off it may be.
bool tells_nothing(double value, double low, double high) {
  constexpr double kRounding = 1e-12;
  return std::isfinite(low) && !(high - low > kRounding * std::abs(value));
}

/// `sign`: -1 of a number that is never above 0.
template <class Pick>
Estimate estimate(double value, double error, const FitReport& report, Pick pick, double sign = 1.0) {
  std::vector<double> values;
  for (const auto& r : report.replicates) values.push_back(sign * pick(r));
  auto [low, high] = interval_of(report, sign * value, std::move(values));
  if (tells_nothing(value, low, high)) return {value, kInfinity, -kInfinity, kInfinity};
  if (sign < 0.0) std::tie(low, high) = std::pair{-high, low == 0.0 ? 0.0 : -low};
  return {value, error, low, high};
}

}  // namespace

void describe_data(const RunList& runs, const LawSamples& samples, const LawMeans& means, FitReport& report) {
  PairLaw& law = report.law;
  const CurveMeans& normal = means[0];
  law.packings = count_packings(samples[0]);
  for (const CurveSamples& s : samples) law.points += count_values(s);
  report.normal_left_out = samples[0].left_out;
  report.tangential_left_out = samples[1].left_out;
  law.table.delta = normal.delta;
  law.table.force_mean = normal.mean;
  law.table.force_deviation = normal.deviation;
  fill_stiffness(means[1], normal.delta, law.table.kt_initial_mean, law.table.kt_initial_deviation);
  fill_stiffness(means[2], normal.delta, law.table.kt_secant_mean, law.table.kt_secant_deviation);
  if (normal.delta.empty()) return;
  law.delta_min = normal.delta.front();
  law.delta_max = normal.delta.back();
  for (const PackingRun* run : runs)
    for (const NormalPoint& p : run->normal)
      if (p.converged && p.delta >= law.delta_min - 1e-7 && p.delta <= law.delta_max + 1e-7)
        law.max_overlap = std::max(law.max_overlap, p.max_overlap);
}

void fill_goodness(const FitCurves& curves, const JointParameters& found, double noise_floor, PairLaw& law) {
  double chi2 = 0.0;
  double points = 0.0;
  double parameters = 1.0;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    const FitCurve& c = curves[j];
    if (c.present()) parameters += 2.0;
    for (std::size_t k = 0; k < c.means.delta.size(); ++k) {
      const double f = found.value(j, c.means.delta[k]);
      if (f <= 0.0 && c.means.mean[k] <= noise_floor) continue;  // below threshold nothing is tested
      const double z = (c.means.mean[k] - f) / c.sigma[k];
      chi2 += c.means.count[k] * z * z;
      points += 1.0;
    }
  }
  const double freedom = points - parameters;
  law.chi2_per_dof = freedom > 0.0 ? chi2 / freedom : 0.0;
  law.quality = freedom > 0.0 ? gsl_cdf_chisq_Q(chi2, freedom) : 0.0;
}

ThresholdPowerLaw estimated_law(const FitReport& report, const std::array<double, 7>& p, std::size_t curve,
                                bool errors_known) {
  const std::size_t i = kRowOfA[curve];
  const std::size_t j = i + 1;
  const auto& cov = report.law.covariance;
  const auto error = [&](std::size_t k) { return errors_known ? std::sqrt(cov[k * 7 + k]) : kInfinity; };
  ThresholdPowerLaw law;
  law.a = estimate(p[i], error(i), report, [i](const auto& r) { return r[i]; });
  law.b = estimate(p[j], error(j), report, [j](const auto& r) { return r[j]; });
  law.delta = estimate(p[2], error(2), report, [](const auto& r) { return r[2]; });
  law.c = estimate(
      constant_of(p[i], p[j], p[2]), errors_known ? constant_error(cov, i, j, p[i], p[j], p[2]) : kInfinity, report,
      [i, j](const auto& r) { return constant_of(r[i], r[j], r[2]); }, -1.0);
  return law;
}

std::vector<Band> law_band(const FitReport& report, LawCurve curve, std::span<const double> deltas) {
  const PairLaw& law = report.law;
  const std::size_t i = kRowOfA[static_cast<std::size_t>(curve)];
  const std::array<const ThresholdPowerLaw*, kLawCurves> laws{&law.normal, &law.tangential_initial,
                                                              &law.tangential_secant};
  const ThresholdPowerLaw& best = *laws[static_cast<std::size_t>(curve)];
  const auto value = [](double a, double b, double delta, double d) {
    return d <= delta ? 0.0 : a * std::pow(d, b) + constant_of(a, b, delta);
  };
  std::vector<Band> out;
  for (const double d : deltas) {
    std::vector<double> values;
    for (const auto& r : report.replicates) values.push_back(value(r[i], r[i + 1], r[2], d));
    const double at = value(best.a.value, best.b.value, best.delta.value, d);
    const auto [low, high] = interval_of(report, at, std::move(values));
    const bool none = at > 0.0 && tells_nothing(at, low, high);
    out.push_back(none ? Band{d, at, -kInfinity, kInfinity} : Band{d, at, low, high});
  }
  return out;
}

}  // namespace softgrain
