#include "common/core/sensitivity.h"

#include <gsl/gsl_multifit.h>
#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "common/core/few_samples.h"
#include "common/core/random.h"
#include "common/core/statistics.h"

namespace softgrain {

bool varies(std::span<const double> values) {
  return !values.empty() && std::ranges::any_of(values, [&](double v) { return v != values.front(); });
}

std::size_t least_regressed(std::size_t columns) { return std::max(kLeastRegressed, 3 * (columns + 1)); }

namespace {

using Column = std::vector<double>;

/// (x - mean)/deviation.
Column standardised(std::span<const double> values) {
  const MeanError m = mean_error(values);
  Column out;
  for (const double v : values) out.push_back((v - m.mean) / m.deviation);
  return out;
}

struct FreeFit {
  void operator()(gsl_matrix* m) const { gsl_matrix_free(m); }
  void operator()(gsl_vector* v) const { gsl_vector_free(v); }
  void operator()(gsl_multifit_linear_workspace* w) const { gsl_multifit_linear_free(w); }
};
template <class T>
using FitPart = std::unique_ptr<T, FreeFit>;

/// Least squares without a constant term.
struct LinearFit {
  Column coefficients;
  Column variances;      ///< of the coefficients, for n - k degrees of freedom
  double squares = 0.0;  ///< sum of the squared residuals
  std::size_t rank = 0;
};

LinearFit fit_columns(const std::vector<Column>& columns, const Column& y) {
  const std::size_t n = y.size();
  const std::size_t k = columns.size();
  const FitPart<gsl_matrix> x(gsl_matrix_alloc(n, k));
  const FitPart<gsl_matrix> covariance(gsl_matrix_alloc(k, k));
  const FitPart<gsl_vector> right(gsl_vector_alloc(n));
  const FitPart<gsl_vector> found(gsl_vector_alloc(k));
  const FitPart<gsl_multifit_linear_workspace> work(gsl_multifit_linear_alloc(n, k));
  for (std::size_t r = 0; r < n; ++r) {
    gsl_vector_set(right.get(), r, y[r]);
    for (std::size_t c = 0; c < k; ++c) gsl_matrix_set(x.get(), r, c, columns[c][r]);
  }
  LinearFit out;
  constexpr double kDependent = 1e-8;  // relative singular value
  gsl_multifit_linear_tsvd(x.get(), right.get(), kDependent, found.get(), covariance.get(), &out.squares, &out.rank,
                           work.get());
  for (std::size_t c = 0; c < k; ++c) {
    out.coefficients.push_back(gsl_vector_get(found.get(), c));
    out.variances.push_back(gsl_matrix_get(covariance.get(), c, c));
  }
  return out;
}

/// Half the sum of (u - v)^2 over base points, each as often as it was drawn.
double half_squares(const Column& u, const Column& v, const std::vector<std::size_t>& points) {
  double sum = 0.0;
  for (const std::size_t p : points) sum += (u[p] - v[p]) * (u[p] - v[p]);
  return 0.5 * sum;
}

double variance_of(const SobolSample& s, const std::vector<std::size_t>& points) {
  Column all;
  for (const std::size_t p : points) all.insert(all.end(), {s.a[p], s.b[p]});
  return gsl_stats_variance(all.data(), 1, all.size());
}

/// First and total indices of all inputs from these base points; empty without variance.
std::vector<std::pair<double, double>> indices_of(const SobolSample& s, const std::vector<std::size_t>& points) {
  const double scale = variance_of(s, points) * static_cast<double>(points.size());
  std::vector<std::pair<double, double>> out;
  if (scale <= 0.0) return out;
  for (const Column& ab : s.mixed)
    out.emplace_back(1.0 - half_squares(s.b, ab, points) / scale, half_squares(s.a, ab, points) / scale);
  return out;
}

EffectSize with_replicates(double value, const Column& replicates, std::size_t points) {
  constexpr double kTail = 0.025;
  const auto [low, high] =
      widened(value, quantile(replicates, kTail), quantile(replicates, 1.0 - kTail), few_samples_factor(points), false);
  return {value, std::min(low, value), std::max(high, value)};
}

}  // namespace

std::optional<EffectSize> rank_correlation(std::span<const double> x, std::span<const double> y) {
  const std::size_t n = x.size();
  if (n < kLeastRanked || !varies(x) || !varies(y)) return std::nullopt;
  Column work(2 * n);
  const double r = std::clamp(gsl_stats_spearman(x.data(), 1, y.data(), 1, n, work.data()), -1.0, 1.0);
  const double count = static_cast<double>(n);
  const double most = 1.0 - 6.0 / (count * count * count - count);
  const double z = std::atanh(std::clamp(r, -most, most));
  const double half = kNormal95 * std::sqrt((1.0 + 0.5 * r * r) / (count - 3.0));
  return EffectSize{r, std::min(std::tanh(z - half), r), std::max(std::tanh(z + half), r)};
}

std::optional<Regression> standardised_regression(const std::vector<std::vector<double>>& columns,
                                                  std::span<const double> y) {
  const std::size_t n = y.size();
  const std::size_t k = columns.size();
  if (k == 0 || n < least_regressed(k) || !varies(y)) return std::nullopt;
  std::vector<Column> x;
  for (const Column& column : columns) {
    if (!varies(column)) return std::nullopt;
    x.push_back(standardised(column));
  }
  const LinearFit fit = fit_columns(x, standardised(y));
  if (fit.rank < k) return std::nullopt;
  Regression out;
  out.determination = 1.0 - fit.squares / static_cast<double>(n - 1);
  const double degrees = static_cast<double>(n - k - 1);  // one went into the mean
  const double correction = static_cast<double>(n - k) / degrees;
  for (std::size_t c = 0; c < k; ++c) {
    const double half = student95(degrees) * std::sqrt(fit.variances[c] * correction);
    out.coefficients.push_back({fit.coefficients[c], fit.coefficients[c] - half, fit.coefficients[c] + half});
  }
  return out;
}

std::optional<SobolIndices> sobol_indices(const SobolSample& sample, std::uint64_t seed, std::uint64_t stream) {
  constexpr std::uint64_t kReplicates = 1000;
  const std::size_t n = sample.a.size();
  if (n < kLeastBasePoints) return std::nullopt;
  std::vector<std::size_t> points(n);
  for (std::size_t p = 0; p < n; ++p) points[p] = p;
  const auto values = indices_of(sample, points);
  if (values.empty()) return std::nullopt;
  std::vector<Column> first(values.size());
  std::vector<Column> total(values.size());
  RandomStream random(seed, RandomPurpose::bootstrap, stream);
  for (std::uint64_t replicate = 0; replicate < kReplicates; ++replicate) {
    for (std::size_t& p : points) p = random.below(n);
    const auto drawn = indices_of(sample, points);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      first[i].push_back(drawn[i].first);
      total[i].push_back(drawn[i].second);
    }
  }
  SobolIndices out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    out.first.push_back(with_replicates(values[i].first, first[i], n));
    out.total.push_back(with_replicates(values[i].second, total[i], n));
  }
  return out;
}

}  // namespace softgrain
