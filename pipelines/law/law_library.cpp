#include "pipelines/law/law_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrate/draws.h"
#include "calibrate/gaussian_process.h"
#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "pipelines/law/law_library_numbers.h"

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

/// What is known of one number: the materials that have it.
struct KnownNumber {
  std::vector<std::size_t> materials;
  std::vector<std::vector<double>> points;
  std::vector<double> values;
  std::vector<double> errors;
};

KnownNumber known_number(const LawLibrary& library, const UnitBox& box, std::size_t k) {
  KnownNumber out;
  for (std::size_t i = 0; i < library.materials.size(); ++i) {
    const LibraryMaterial& m = library.materials[i];
    if (!std::isfinite(m.numbers[k]) || !std::isfinite(m.errors[k])) continue;
    out.materials.push_back(i);
    out.points.push_back(box(m.at));
    out.values.push_back(m.numbers[k]);
    out.errors.push_back(m.errors[k]);
  }
  return out;
}

GaussianProcess process_of(const KnownNumber& n) { return {n.points, n.values, n.errors}; }

/// Mean of the correlations of all materials: that of positive matrices is one.
std::vector<double> mean_correlations(const LawLibrary& library) {
  const std::size_t size = library.law_numbers() * library.law_numbers();
  std::vector<double> out(size, 0.0);
  for (const LibraryMaterial& m : library.materials)
    for (std::size_t k = 0; k < size; ++k) out[k] += m.correlations[k] / static_cast<double>(library.materials.size());
  return out;
}

void require_materials(const LawLibrary& library) {
  const std::size_t least = GaussianProcess::least_values(kLibraryVariables.size());
  if (library.materials.size() < least)
    throw InputError(fmt::format("law library: {} materials; it needs at least {}", library.materials.size(), least));
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
  LibraryAnswer out;
  out.at = at;
  const std::vector<double> u = box(at);
  const std::vector<std::string> names = library.names();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const KnownNumber known = known_number(library, box, k);
    LibraryNumber number{names[k], std::nan(""), std::nan("")};
    if (known.values.size() >= GaussianProcess::least_values(u.size())) {
      const ProcessValue z = process_of(known).at(u);
      number.value = z.mean;
      number.deviation = z.deviation;
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
  for (std::size_t k = 0; k < names.size(); ++k) {
    const KnownNumber known = known_number(library, box, k);
    const auto n = static_cast<double>(known.values.size());
    if (known.values.size() < GaussianProcess::least_values(kLibraryVariables.size())) continue;
    const std::vector<ProcessValue> others = process_of(known).leave_one_out();
    LibraryCheck c{names[k], 0.0, mean_error(known.values).deviation, 0.0, known.values.size()};
    for (std::size_t i = 0; i < others.size(); ++i) {
      const double off = others[i].mean - known.values[i];
      c.error += off * off / n;
      c.coverage += std::abs(off) <= kNormal95 * std::hypot(others[i].deviation, known.errors[i]) ? 1.0 / n : 0.0;
    }
    c.error = std::sqrt(c.error);
    out.push_back(c);
  }
  return out;
}

std::string nearest_text(const LawLibrary& library, const LibraryAnswer& answer) {
  return fmt::format("nearest measured material: {}; distance {:.2f} (1: the whole measured range of one variable)",
                     point_text(library.materials[answer.nearest].at), answer.distance);
}

}  // namespace softgrain
