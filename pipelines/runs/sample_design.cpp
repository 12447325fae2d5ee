#include "pipelines/runs/sample_design.h"

#include <fmt/format.h>
#include <gsl/gsl_qrng.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <numeric>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/core/sensitivity.h"
#include "common/core/text.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

constexpr RandomPurpose kLatinStrata{60};
constexpr RandomPurpose kSobolShift{61};

using Points = std::vector<std::vector<double>>;

/// Column c of a Latin hypercube: the strata in random order, and a place in each.
Points latin_hypercube(const SampleDesign& design, std::size_t keys) {
  const std::size_t n = design.points;
  Points points(n, std::vector<double>(keys));
  for (std::size_t c = 0; c < keys; ++c) {
    RandomStream random(design.seed, kLatinStrata, c);
    std::vector<std::size_t> strata(n);
    std::iota(strata.begin(), strata.end(), std::size_t{0});
    for (std::size_t k = n; k > 1; --k) std::swap(strata[k - 1], strata[random.below(k)]);
    for (std::size_t p = 0; p < n; ++p)
      points[p][c] = (static_cast<double>(strata[p]) + random.uniform()) / static_cast<double>(n);
  }
  return points;
}

/// GSL leaves out the first point, the origin, without which 2^m points are not even.
Points sobol_sequence(const SampleDesign& design, std::size_t columns) {
  constexpr int kBits = 30;  // of a coordinate from GSL
  const double cells = std::ldexp(1.0, kBits);
  const std::unique_ptr<gsl_qrng, decltype(&gsl_qrng_free)> sequence(
      gsl_qrng_alloc(gsl_qrng_sobol, static_cast<unsigned>(columns)), &gsl_qrng_free);
  std::vector<std::uint64_t> shift;
  for (std::size_t c = 0; c < columns; ++c)
    shift.push_back(RandomStream(design.seed, kSobolShift, c).below(std::uint64_t{1} << kBits));
  Points points;
  std::vector<double> unshifted(columns, 0.0);
  for (std::size_t p = 0; p < design.points; ++p) {
    if (p > 0) gsl_qrng_get(sequence.get(), unshifted.data());
    std::vector<double> point;
    for (std::size_t c = 0; c < columns; ++c) {
      const auto cell = static_cast<std::uint64_t>(unshifted[c] * cells) ^ shift[c];
      point.push_back((static_cast<double>(cell) + 0.5) / cells);
    }
    points.push_back(std::move(point));
  }
  return points;
}

Points saltelli_points(const SampleDesign& design, std::size_t keys) {
  Points out;
  for (const std::vector<double>& both : sobol_sequence(design, 2 * keys)) {
    const auto middle = both.begin() + static_cast<std::ptrdiff_t>(keys);
    const std::vector<double> a(both.begin(), middle);
    const std::vector<double> b(middle, both.end());
    out.insert(out.end(), {a, b});
    for (std::size_t k = 0; k < keys; ++k) {
      out.push_back(a);
      out.back()[k] = b[k];
    }
  }
  return out;
}

/// One end of a range: a number, and what stands behind it.
struct RangeEnd {
  double value = 0.0;
  std::string unit;
};

std::optional<RangeEnd> end_of(std::string text) {
  std::erase_if(text, [](char c) { return c == '"' || c == '\''; });
  text = trimmed(text);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  const std::string unit = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  if (!unit.empty() && !quantity_of_any_unit("1 " + unit)) return std::nullopt;
  return RangeEnd{value, unit};
}

/// With eight digits, and within the range all the same.
std::string number_within(const SweptRange& range, double value) {
  const std::string text = fmt::format("{:.8g}", value);
  const double written = std::stod(text);
  if (written < range.low) return fmt::format("{}", range.low);
  return written > range.high ? fmt::format("{}", range.high) : text;
}

double between(double low, double high, bool logarithmic, double u) {
  return logarithmic ? low * std::pow(high / low, u) : low + (high - low) * u;
}

}  // namespace

std::string SampleDesign::text() const { return fmt::format("{}:{}", to_string(form), points); }

std::size_t SampleDesign::runs(std::size_t keys) const {
  return form == SampleForm::saltelli ? points * (keys + 2) : points;
}

SampleDesign read_design(const std::string& text, std::uint64_t seed) {
  constexpr std::size_t kMostPoints = 10000;
  const std::size_t colon = text.find(':');
  const auto form = parse_enum<SampleForm>(text.substr(0, colon));
  const std::string number = colon == std::string::npos ? "" : text.substr(colon + 1);
  SampleDesign design{.form = form.value_or(SampleForm::lhs), .points = 0, .seed = seed};
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), design.points);
  const bool whole = error == std::errc{} && end == number.data() + number.size();
  if (!form || !whole || design.points < 2 || design.points > kMostPoints)
    throw InputError(
        fmt::format("--sample {}: must be lhs:N, sobol:N or saltelli:N with N from 2 to {}", text, kMostPoints));
  return design;
}

std::vector<std::vector<double>> unit_points(const SampleDesign& design, std::size_t keys) {
  if (design.form == SampleForm::lhs) return latin_hypercube(design, keys);
  const bool saltelli = design.form == SampleForm::saltelli;
  const std::size_t most = saltelli ? kMostSobolColumns / 2 : kMostSobolColumns;
  if (keys > most)
    throw InputError(
        fmt::format("--sample {}: {}, at most {} go into this design", design.text(), counted(keys, "key"), most));
  return saltelli ? saltelli_points(design, keys) : sobol_sequence(design, keys);
}

std::optional<SweptRange> range_of(const std::string& text, std::string& problem) {
  const std::string logarithmic = ":log";
  SweptRange range{.logarithmic = text.ends_with(logarithmic)};
  const std::string ends = range.logarithmic ? text.substr(0, text.size() - logarithmic.size()) : text;
  const std::size_t dots = ends.find("..");
  if (dots == std::string::npos) return std::nullopt;
  const auto low = end_of(ends.substr(0, dots));
  const auto high = end_of(ends.substr(dots + 2));
  if (!low || !high) return std::nullopt;
  range.low = low->value;
  range.high = high->value;
  range.unit = high->unit;
  if (!low->unit.empty() && low->unit != high->unit)
    problem = fmt::format("{}: both ends must have one unit", text);
  else if (range.high <= range.low)
    problem = fmt::format("{}: must rise", text);
  else if (range.logarithmic && range.low <= 0.0)
    problem = fmt::format("{}: a logarithmic range must be above 0", text);
  return range;
}

std::string value_at(const SweptRange& range, double u) {
  if (range.whole) {
    const double value = std::floor(between(range.low, range.high + 1.0, range.logarithmic, u));
    return fmt::format("{:.0f}", std::clamp(value, range.low, range.high));
  }
  const std::string number = number_within(range, between(range.low, range.high, range.logarithmic, u));
  return range.unit.empty() ? number : fmt::format("\"{} {}\"", number, range.unit);
}

}  // namespace softgrain
