#include "pipelines/law/law_library_predict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/statistics.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr double kReachOfRange = 0.02;  ///< how far beyond the range of a variable a library serves, over it

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
class LeftOutMaterials {
 public:
  /// `measured`: errors of the measured values; those that the deviations hold already are 0.
  LeftOutMaterials(const std::vector<ProcessValue>& predicted, const std::vector<double>& values,
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

double apart(const std::vector<double>& u, const std::vector<double>& v) {
  double square = 0.0;
  for (std::size_t a = 0; a < u.size(); ++a) square += (u[a] - v[a]) * (u[a] - v[a]);
  return std::sqrt(square);
}

/// Mean of the correlations of all materials: that of positive matrices is one.
std::vector<double> mean_correlations(const LawLibrary& library) {
  const std::size_t size = library.law_numbers() * library.law_numbers();
  std::vector<double> out(size, 0.0);
  for (const LibraryMaterial& m : library.materials)
    for (std::size_t k = 0; k < size; ++k) out[k] += m.correlations[k] / static_cast<double>(library.materials.size());
  return out;
}

/// Root mean square by which the other means differ from the first.
double off_the_first(const std::vector<ProcessValue>& z) {
  double sum = 0.0;
  for (std::size_t k = 1; k < z.size(); ++k) sum += (z[k].mean - z.front().mean) * (z[k].mean - z.front().mean);
  return z.size() > 1 ? std::sqrt(sum / static_cast<double>(z.size() - 1)) : 0.0;
}

void require_materials(const LawLibrary& library) {
  if (library.materials.size() < least_materials())
    throw InputError(fmt::format("law library: {}; it needs at least {}", counted(library.materials.size(), "material"),
                                 least_materials()));
}

}  // namespace

UnitBox::UnitBox(const std::vector<std::vector<double>>& rows) {
  for (std::size_t a = 0; !rows.empty() && a < rows.front().size(); ++a) {
    const auto [low, high] = std::ranges::minmax(rows, {}, [a](const std::vector<double>& row) { return row[a]; });
    low_.push_back(low[a]);
    high_.push_back(high[a]);
  }
  for (const std::vector<double>& row : rows) points_.push_back((*this)(row));
}

std::vector<double> UnitBox::operator()(const std::vector<double>& row) const {
  std::vector<double> out;
  for (std::size_t a = 0; a < low_.size(); ++a)
    out.push_back(high_[a] > low_[a] ? (row[a] - low_[a]) / (high_[a] - low_[a]) : 0.5);
  return out;
}

std::vector<double> UnitBox::row(const std::vector<double>& u) const {
  std::vector<double> out;
  for (std::size_t a = 0; a < u.size(); ++a)
    out.push_back(high_[a] > low_[a] ? low_[a] + u[a] * (high_[a] - low_[a]) : low_[a]);
  return out;
}

KnownNumber known_number(const LawLibrary& library, const UnitBox& box, std::size_t k) {
  KnownNumber out;
  for (std::size_t i = 0; i < library.materials.size(); ++i) {
    const LibraryMaterial& m = library.materials[i];
    if (!std::isfinite(m.numbers[k]) || !std::isfinite(m.errors[k])) continue;
    out.points.push_back(box.points()[i]);
    out.values.push_back(m.numbers[k]);
    out.errors.push_back(m.errors[k]);
  }
  return out;
}

std::string outside_text(const LibraryVariable& v, double low, double high, double value, double u) {
  if (high > low) {
    if (u >= -kReachOfRange && u <= 1.0 + kReachOfRange) return "";
    return fmt::format("{} = {:g}: measured from {:.3g} to {:.3g}", v.name, value, low, high);
  }
  if (std::abs(value - low) <= kReachOfNumbers * std::max(1.0, std::abs(low))) return "";
  return fmt::format("{} = {:g}: all materials of this library have {:.4g}", v.name, value, low);
}

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
  const LeftOutMaterials left(out.by_mean() ? mean : process, known.values, out.by_mean() ? none : known.errors);
  out.factor = left.factor();
  out.coverage = left.share_within(out.factor);
  return out;
}

std::vector<ProcessValue> predicted_number(const LibraryCheck& check, const KnownNumber& known,
                                           const std::vector<std::vector<double>>& points) {
  std::vector<ProcessValue> out(points.size(), mean_and_scatter(known.values, known.errors));
  if (!check.by_mean()) {
    const GaussianProcess process(known.points, known.values, known.errors);
    for (std::size_t k = 0; k < points.size(); ++k) out[k] = process.at(points[k]);
  }
  for (ProcessValue& z : out) z.deviation *= check.factor;
  return out;
}

ProcessValue predicted_value(const LibraryCheck& check, const KnownNumber& known,
                             const std::vector<std::vector<double>>& points) {
  const std::vector<ProcessValue> z = predicted_number(check, known, points);
  return {z.front().mean, std::hypot(z.front().deviation, off_the_first(z))};
}

std::vector<LibraryCheck> check_numbers(const LawLibrary& library, const UnitBox& box) {
  require_materials(library);
  const std::vector<std::string> names = library.names();
  std::vector<LibraryCheck> out;
  for (std::size_t k = 0; k < names.size(); ++k) out.push_back(checked_number(names[k], known_number(library, box, k)));
  return out;
}

LibraryAnswer answer_at(const LawLibrary& library, const std::vector<LibraryCheck>& checks, const UnitBox& box,
                        const std::vector<double>& u, const std::vector<std::vector<double>>& scatter) {
  require_materials(library);
  const std::vector<std::string> names = library.names();
  std::vector<std::vector<double>> points{u};
  points.insert(points.end(), scatter.begin(), scatter.end());
  LibraryAnswer out;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const KnownNumber known = known_number(library, box, k);
    LibraryNumber number{names[k], std::nan(""), std::nan("")};
    if (known.values.size() >= least_materials()) {
      const ProcessValue z = predicted_value(checks[k], known, points);
      number.value = z.mean;
      number.deviation = z.deviation;
      if (checks[k].by_mean()) out.by_mean.push_back(names[k]);
    } else if (k < library.law_numbers()) {
      throw InputError(fmt::format("law library: too few materials have the number \"{}\"", names[k]));
    }
    out.numbers.push_back(number);
  }
  out.correlations = mean_correlations(library);
  out.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < box.points().size(); ++i) {
    const double d = apart(u, box.points()[i]);
    if (d >= out.distance) continue;
    out.distance = d;
    out.nearest = i;
  }
  const LibraryMaterial& nearest = library.materials[out.nearest];
  out.range = {nearest.packings, nearest.volume_max, nearest.overlap_max, nearest.grain_overlap_max,
               nearest.partner_overlap_max};
  return out;
}

}  // namespace softgrain
