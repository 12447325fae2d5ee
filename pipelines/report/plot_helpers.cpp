#include "pipelines/report/plot_helpers.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/core/statistics.h"
#include "pipelines/report/number_format.h"

namespace softgrain::report {

/// How far plots reach beyond the last overlap, to show what a law does there.
constexpr double kBeyond = 1.12;

std::string describe(PairKind kind) {
  return kind == PairKind::soft_solid ? "soft particle on a solid plane" : "two equal soft particles";
}

std::string packing_name(const Measurements& data, std::int64_t packing) {
  const auto index = static_cast<std::size_t>(packing);
  if (packing < 0 || index >= data.packings.size()) return fmt::format("packing {}", packing);
  return fmt::format("packing {} (seed {})", packing, data.packings[index].seed);
}

Series mean_series(const ValuesByDelta& values, double unit, const std::string& label, const SeriesStyle& style) {
  Series s{.label = label, .hover = label, .x = {}, .y = {}};
  for (const auto& [key, by_packing] : values) {
    std::vector<double> column;
    for (const auto& [packing, value] : by_packing) column.push_back(value * unit);
    const MeanError m = mean_error(column);
    s.x.push_back(key_delta(key));
    s.y.push_back(m.mean);
    s.y_error.push_back(m.error);
  }
  s.style = style;
  return s;
}

std::vector<Series> packing_series(const Measurements& data, const ValuesByDelta& values, double unit,
                                   const std::string& label) {
  std::map<std::int64_t, Series> curves;
  for (const auto& [key, by_packing] : values) {
    for (const auto& [packing, value] : by_packing) {
      curves[packing].x.push_back(key_delta(key));
      curves[packing].y.push_back(value * unit);
    }
  }
  std::vector<Series> result;
  for (auto& [packing, s] : curves) {
    s.label = result.empty() ? label : "";
    s.hover = packing_name(data, packing);
    s.style = {.color = palette::grey, .width = 0.8, .opacity = 0.6};
    s.group = label;
    result.push_back(std::move(s));
  }
  return result;
}

namespace {

Series law_line(const PairLaw& law, LawPart part, double unit, double low, double high) {
  Series s{.label = "", .hover = "", .x = spread(low, high, 161), .y = {}};
  for (const double overlap : s.x) {
    // as contacts use it: a clamped law stays at the force of the end of its range
    const double asked = law.beyond == Extrapolation::clamp ? std::min(overlap, law.delta_max) : overlap;
    s.y.push_back(part_of(law, part).value(asked) * unit);
  }
  s.sets_range = false;
  return s;
}

}  // namespace

void add_law(Plot& plot, const PairLaw& law, LawPart part, double unit, const std::string& label, const char* color) {
  if (!has_part(law, part) || law.delta_max <= 0.0) return;
  if (const auto band = law_band(law, part)) {
    Series s{.label = "95 % interval (" + band->origin + ")",
             .hover = "95 % interval of the " + label,
             .x = band->delta,
             .y = {}};
    for (std::size_t i = 0; i < band->delta.size(); ++i) {
      s.band_low.push_back(band->low[i] * unit);
      s.band_high.push_back(band->high[i] * unit);
    }
    s.style = {.color = color, .width = 0.0};
    s.sets_range = false;
    plot.add(std::move(s));
  }
  Series s = law_line(law, part, unit, 0.0, law.delta_max);
  s.label = label;
  s.style = {.color = color, .width = 2.0};
  plot.add(std::move(s));
  if (law.beyond == Extrapolation::error) return;
  Series beyond = law_line(law, part, unit, law.delta_max, kBeyond * law.delta_max);
  beyond.hover =
      label + (law.beyond == Extrapolation::clamp ? ", clamped beyond its range" : ", extrapolated beyond its range");
  beyond.style = {.color = color, .width = 1.6, .dash = "2 3"};
  beyond.group = label;
  plot.add(std::move(beyond));
}

std::optional<ShadedRange> fitted_range(const PairLaw* law, LawPart part) {
  if (law == nullptr || !has_part(*law, part) || !(law->delta_max > law->delta_min)) return std::nullopt;
  return ShadedRange{law->delta_min, law->delta_max,
                     "fitted: Δ = " + format_number(law->delta_min) + " to " + format_number(law->delta_max)};
}

AxisOptions overlap_axis(double last) {
  return {.label = "normal overlap Δ = hn/Rs", .low = 0.0, .high = kBeyond * last};
}

double last_delta(const ValuesByDelta& values) { return values.empty() ? 0.0 : key_delta(values.rbegin()->first); }

}  // namespace softgrain::report
