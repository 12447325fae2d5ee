#include "calibrate/curve_samples.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

/// Values that may be absent (NaN), averaged over a window of +-`reach` entries.
std::vector<double> windowed_mean(const std::vector<double>& x, std::size_t reach) {
  std::vector<double> out(x.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < x.size(); ++k) {
    double sum = 0.0;
    double n = 0.0;
    for (std::size_t i = k > reach ? k - reach : 0; i <= k + reach && i < x.size(); ++i) {
      if (std::isnan(x[i])) continue;
      sum += x[i];
      n += 1.0;
    }
    if (n > 0.0) out[k] = sum / n;
  }
  return out;
}

/// Mean over samples of the square distance of a value from the line through its neighbours, as variance of a value.
std::vector<double> roughness(const CurveSamples& s) {
  const std::size_t n = s.delta.size();
  std::vector<double> sum(n, 0.0);
  std::vector<double> count(n, 0.0);
  for (std::size_t i = 0; i < s.packings; ++i) {
    std::vector<std::size_t> there;
    for (std::size_t k = 0; k < n; ++k)
      if (!std::isnan(s.at(i, k))) there.push_back(k);
    for (std::size_t m = 1; m + 1 < there.size(); ++m) {
      const std::size_t a = there[m - 1];
      const std::size_t b = there[m];
      const std::size_t c = there[m + 1];
      const double w = (s.delta[b] - s.delta[a]) / (s.delta[c] - s.delta[a]);
      const double distance = s.at(i, b) - ((1.0 - w) * s.at(i, a) + w * s.at(i, c));
      sum[b] += distance * distance / (1.0 + w * w + (1.0 - w) * (1.0 - w));
      count[b] += 1.0;
    }
  }
  for (std::size_t k = 0; k < n; ++k)
    sum[k] = count[k] > 0.0 ? sum[k] / count[k] : std::numeric_limits<double>::quiet_NaN();
  return sum;
}

double given_at(const std::vector<GivenError>& given, double delta) {
  for (const GivenError& g : given)
    if (std::abs(g.delta - delta) < 1e-7) return g.error;
  return 0.0;
}

}  // namespace

std::vector<double> experiment_errors(const CurveSamples& samples, const CurveMeans& means,
                                      const std::vector<GivenError>& given, double scatter_floor) {
  const std::size_t n = means.delta.size();
  std::vector<double> scatter(n, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < n; ++k)
    if (means.count[k] > 1.0) scatter[k] = means.deviation[k] * means.deviation[k];
  scatter = windowed_mean(scatter, 2);
  // Given errors say more about a single point than its distance from its neighbours, which holds the curve's own bend.
  const std::vector<double> rough =
      given.empty() ? windowed_mean(roughness(samples), std::max<std::size_t>(3, n / 8)) : std::vector<double>(n, 0.0);
  CurveMeans known = means;
  for (std::size_t k = 0; k < n; ++k) {
    const double outside = given_at(given, means.delta[k]);
    double variance = outside * outside;
    for (const double v : {scatter[k], rough[k]})
      if (!std::isnan(v)) variance = std::max(variance, v);
    known.deviation[k] = std::sqrt(variance);
  }
  return floored_deviations(known, scatter_floor);
}

std::size_t correlation_length(const std::vector<double>& residuals, std::size_t samples) {
  constexpr double kUncorrelated = 0.3;
  const std::size_t n = samples > 0 ? residuals.size() / samples : 0;
  std::vector<std::vector<double>> series(samples);
  std::size_t longest = 1;
  double power = 0.0;
  double values = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    for (std::size_t k = 0; k < n; ++k)
      if (const double r = residuals[i * n + k]; !std::isnan(r)) series[i].push_back(r);
    for (const double r : series[i]) power += r * r;
    values += static_cast<double>(series[i].size());
    longest = std::max(longest, series[i].size());
  }
  if (!(power > 0.0)) return 1;
  for (std::size_t lag = 1; lag < longest; ++lag) {
    double product = 0.0;
    double pairs = 0.0;
    for (const std::vector<double>& s : series)
      for (std::size_t k = 0; k + lag < s.size(); ++k) {
        product += s[k] * s[k + lag];
        pairs += 1.0;
      }
    if (pairs > 0.0 && product / pairs < kUncorrelated * power / values)
      return std::min(longest, lag == 1 ? std::size_t{1} : 2 * lag);
  }
  return longest;
}

}  // namespace softgrain
