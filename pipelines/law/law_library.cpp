#include "pipelines/law/law_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrate/gaussian_process.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "pipelines/law/law_library_predict.h"

namespace softgrain {

namespace {

/// How far beyond the convex hull of the measured materials a library serves, over the ranges of the variables. The
/// errors of leaving one out hold there: materials at corners are predicted from farther away.
constexpr double kReachOfHull = 0.1;
constexpr double kReachOfRange = 0.02;

struct VariableRange {
  double low = 0.0;
  double high = 0.0;
};

double on_axis(const LibraryVariable& v, double x) { return v.logarithm ? std::log(x) : x; }

std::array<VariableRange, kLibraryVariables.size()> ranges_of(const LawLibrary& library) {
  std::array<VariableRange, kLibraryVariables.size()> out;
  for (std::size_t a = 0; a < out.size(); ++a) {
    const auto of = [&](const LibraryMaterial& m) { return m.at.*kLibraryVariables[a].value; };
    const auto [low, high] = std::ranges::minmax(library.materials, {}, of);
    out[a] = {of(low), of(high)};
  }
  return out;
}

/// A point with every variable from 0 to 1 over the measured range.
class UnitBox {
 public:
  explicit UnitBox(const LawLibrary& library) : ranges_(ranges_of(library)) {}

  [[nodiscard]] std::vector<double> operator()(const LibraryPoint& at) const {
    std::vector<double> u;
    for (std::size_t a = 0; a < ranges_.size(); ++a) {
      const LibraryVariable& v = kLibraryVariables[a];
      const double low = on_axis(v, ranges_[a].low);
      const double width = on_axis(v, ranges_[a].high) - low;
      u.push_back(width > 0.0 ? (on_axis(v, at.*v.value) - low) / width : 0.5);
    }
    return u;
  }
  [[nodiscard]] std::vector<std::vector<double>> all(const LawLibrary& library) const {
    std::vector<std::vector<double>> out;
    for (const LibraryMaterial& m : library.materials) out.push_back((*this)(m.at));
    return out;
  }
  [[nodiscard]] const VariableRange& range(std::size_t a) const { return ranges_[a]; }

 private:
  std::array<VariableRange, kLibraryVariables.size()> ranges_;
};

double apart(const std::vector<double>& u, const std::vector<double>& v) {
  double square = 0.0;
  for (std::size_t a = 0; a < u.size(); ++a) square += (u[a] - v[a]) * (u[a] - v[a]);
  return std::sqrt(square);
}

/// Solid fractions that are inside with all else as in `at`; empty text: none.
std::string fractions_inside(const LawLibrary& library, const UnitBox& box, LibraryPoint at) {
  constexpr double kStep = 0.005;
  const VariableRange range = box.range(3);
  const std::vector<std::vector<double>> points = box.all(library);
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (double f = range.low; f <= range.high + 0.5 * kStep; f += kStep) {
    at.solid_fraction = f;
    if (distance_from_hull(points, box(at)) > kReachOfHull) continue;
    low = std::min(low, f);
    high = std::max(high, f);
  }
  return high > 0.0 ? fmt::format("with the other three, solid fractions from {:.3f} to {:.3f} are", low, high)
                    : "the combination of the other three is not";
}

/// What is wrong with one variable; empty: nothing. One that never varied serves its own value, but for rounding.
std::string outside_text(const LibraryVariable& v, const VariableRange& range, double value, double u) {
  if (range.high > range.low) {
    if (u >= -kReachOfRange && u <= 1.0 + kReachOfRange) return "";
    return fmt::format("{} = {:g}: measured from {:.3g} to {:.3g}", v.name, value, range.low, range.high);
  }
  if (std::abs(value - range.low) <= kReachOfNumbers * std::max(1.0, std::abs(range.low))) return "";
  return fmt::format("{} = {:g}: all materials of this library have {:.4g}", v.name, value, range.low);
}

void require_inside(const LawLibrary& library, const UnitBox& box, const LibraryPoint& at) {
  std::string wrong;
  const std::vector<double> u = box(at);
  for (std::size_t a = 0; a < u.size(); ++a) {
    const LibraryVariable& v = kLibraryVariables[a];
    if (const std::string why = outside_text(v, box.range(a), at.*v.value, u[a]); !why.empty()) append_part(wrong, why);
  }
  if (!wrong.empty()) throw InputError("law library: " + wrong);
  if (distance_from_hull(box.all(library), u) <= kReachOfHull) return;
  throw InputError(fmt::format("law library: {}: no such combination was measured; {} inside", point_text(at),
                               fractions_inside(library, box, at)));
}

KnownNumber known_number(const LawLibrary& library, const UnitBox& box, std::size_t k) {
  KnownNumber out;
  for (const LibraryMaterial& m : library.materials) {
    if (!std::isfinite(m.numbers[k]) || !std::isfinite(m.errors[k])) continue;
    out.points.push_back(box(m.at));
    out.values.push_back(m.numbers[k]);
    out.errors.push_back(m.errors[k]);
  }
  return out;
}

/// Mean of the correlations of all materials: that of positive matrices is one.
std::vector<double> mean_correlations(const LawLibrary& library) {
  const std::size_t size = library.law_numbers() * library.law_numbers();
  std::vector<double> out(size, 0.0);
  for (const LibraryMaterial& m : library.materials)
    for (std::size_t k = 0; k < size; ++k) out[k] += m.correlations[k] / static_cast<double>(library.materials.size());
  return out;
}

void require_materials(const LawLibrary& library) {
  if (library.materials.size() < least_materials())
    throw InputError(
        fmt::format("law library: {} materials; it needs at least {}", library.materials.size(), least_materials()));
}

}  // namespace

std::string point_text(const LibraryPoint& at) {
  return join_text(kLibraryVariables, ", ",
                   [&](const LibraryVariable& v) { return fmt::format("{} = {:.4g}", v.name, at.*v.value); });
}

LibraryAnswer ask_library(const LawLibrary& library, const LibraryPoint& at) {
  require_materials(library);
  const UnitBox box(library);
  require_inside(library, box, at);
  const std::vector<std::string> names = library.names();
  if (library.checks.size() != names.size()) throw InputError("law library: it is not checked");
  LibraryAnswer out;
  out.at = at;
  const std::vector<double> u = box(at);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const KnownNumber known = known_number(library, box, k);
    LibraryNumber number{names[k], std::nan(""), std::nan("")};
    if (known.values.size() >= least_materials()) {
      const ProcessValue z = predicted_number(library.checks[k], known, u);
      number.value = z.mean;
      number.deviation = z.deviation;
      if (library.checks[k].by_mean()) out.by_mean.push_back(names[k]);
    } else if (k < library.law_numbers()) {
      throw InputError(fmt::format("law library: too few materials have the number \"{}\"", names[k]));
    }
    out.numbers.push_back(number);
  }
  out.correlations = mean_correlations(library);
  out.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < library.materials.size(); ++i) {
    const double d = apart(u, box(library.materials[i].at));
    if (d >= out.distance) continue;
    out.distance = d;
    out.nearest = i;
  }
  return out;
}

std::vector<LibraryCheck> check_library(const LawLibrary& library) {
  require_materials(library);
  const UnitBox box(library);
  const std::vector<std::string> names = library.names();
  std::vector<LibraryCheck> out;
  for (std::size_t k = 0; k < names.size(); ++k) out.push_back(checked_number(names[k], known_number(library, box, k)));
  return out;
}

std::string means_text(const LibraryAnswer& answer) {
  if (answer.by_mean.empty()) return "";
  return "mean and scatter of all materials, which predict no better: " + join_text(answer.by_mean, "; ");
}

std::string nearest_text(const LawLibrary& library, const LibraryAnswer& answer) {
  return fmt::format("nearest measured material: {}; distance {:.2f} (1: the whole measured range of one variable)",
                     point_text(library.materials[answer.nearest].at), answer.distance);
}

}  // namespace softgrain
