#include "pipelines/law/law_library_predict.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/core/few_samples.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

ProcessValue mean_and_scatter(const std::vector<double>& values, const std::vector<double>& errors) {
  const MeanError all = mean_error(values);
  const auto n = static_cast<double>(values.size());
  double noise = 0.0;
  for (const double e : errors) noise += e * e / n;
  const double scatter = std::max(all.deviation, std::sqrt(noise));
  return {all.mean, scatter * std::sqrt(1.0 + 1.0 / n) * student_over_normal(n - 1.0)};
}

std::vector<ProcessValue> means_of_others(const KnownNumber& known) {
  std::vector<ProcessValue> out;
  for (std::size_t k = 0; k < known.values.size(); ++k) {
    const auto but_one = [at = static_cast<std::ptrdiff_t>(k)](std::vector<double> all) {
      all.erase(all.begin() + at);
      return all;
    };
    out.push_back(mean_and_scatter(but_one(known.values), but_one(known.errors)));
  }
  return out;
}

double root_mean_square(const std::vector<ProcessValue>& predicted, const std::vector<double>& values) {
  double sum = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k)
    sum += (predicted[k].mean - values[k]) * (predicted[k].mean - values[k]);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Predictions of the materials left out, beside what was measured.
class LeftOut {
 public:
  /// `measured`: errors of the measured values; those that the deviations hold already are 0.
  LeftOut(const std::vector<ProcessValue>& predicted, const std::vector<double>& values,
          const std::vector<double>& measured)
      : predicted_(predicted), values_(values), measured_(measured) {}

  /// The factor f >= 1 at which the mean square of z(f) is 1, or 1 where it is less than that.
  [[nodiscard]] double factor() const {
    constexpr double kMost = 100.0;
    constexpr int kHalvings = 60;
    if (!(mean_square(1.0) > 1.0)) return 1.0;
    double low = 1.0;
    double high = kMost;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + high);
      (mean_square(middle) > 1.0 ? low : high) = middle;
    }
    return high;
  }
  [[nodiscard]] double share_within(double factor) const {
    double inside = 0.0;
    for (std::size_t k = 0; k < values_.size(); ++k) inside += std::abs(z(k, factor)) <= kNormal95 ? 1.0 : 0.0;
    return inside / static_cast<double>(values_.size());
  }

 private:
  [[nodiscard]] double z(std::size_t k, double factor) const {
    const double off = predicted_[k].mean - values_[k];
    return off == 0.0 ? 0.0 : off / std::hypot(factor * predicted_[k].deviation, measured_[k]);
  }
  [[nodiscard]] double mean_square(double factor) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < values_.size(); ++k) sum += z(k, factor) * z(k, factor);
    return sum / static_cast<double>(values_.size());
  }

  const std::vector<ProcessValue>& predicted_;
  const std::vector<double>& values_;
  const std::vector<double>& measured_;
};

}  // namespace

std::size_t least_materials() { return GaussianProcess::least_values(kLibraryVariables.size()) + 1; }

LibraryCheck checked_number(const std::string& name, const KnownNumber& known) {
  LibraryCheck out;
  out.name = name;
  if (known.values.size() < least_materials()) return out;
  out.materials = known.values.size();
  const std::vector<ProcessValue> process = leave_one_out(known.points, known.values, known.errors);
  const std::vector<ProcessValue> mean = means_of_others(known);
  out.error = root_mean_square(process, known.values);
  out.error_of_mean = root_mean_square(mean, known.values);
  const std::vector<double> none(known.values.size(), 0.0);
  const LeftOut left(out.by_mean() ? mean : process, known.values, out.by_mean() ? none : known.errors);
  out.factor = left.factor();
  out.coverage = left.share_within(out.factor);
  return out;
}

ProcessValue predicted_number(const LibraryCheck& check, const KnownNumber& known, const std::vector<double>& u) {
  ProcessValue out = check.by_mean() ? mean_and_scatter(known.values, known.errors)
                                     : GaussianProcess(known.points, known.values, known.errors).at(u);
  out.deviation *= check.factor;
  return out;
}

}  // namespace softgrain
