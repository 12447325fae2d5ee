// Series that several sections draw alike, and the engines of macro runs.
#include "pipelines/report/plot_helpers.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/macro_band.h"
#include "pipelines/report/html.h"
#include "pipelines/report/law_curves.h"
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

namespace {

struct Known {
  const char* engine;
  const char* name;
  const char* color;
  const char* dash;
  Marker marker;
};

constexpr Known kKnown[] = {
    {"law", "soft particles with their law", palette::blue, "", Marker::circle},
    {"pair", "pair law (one contact)", palette::green, "", Marker::triangle},
    {"isotropic", "isotropic law", palette::purple, "", Marker::diamond},
    {"directional", "directional law", palette::black, "", Marker::hollow},
    {"shelled", "resolved twin (shelled)", palette::vermillion, "6 3", Marker::square},
    {"free", "resolved twin (free)", palette::orange, "2 3", Marker::triangle},
};

const Known* find(const std::string& engine) {
  for (const Known& k : kKnown)
    if (engine == k.engine) return &k;
  return nullptr;
}

}  // namespace

std::string engine_name(const std::string& engine) {
  const Known* known = find(engine);
  return known != nullptr ? known->name : engine;
}

bool is_of_cells(const MacroCurve& curve) { return !curve.law.form && !curve.law.hash.empty(); }

std::string engine_name(const MacroCurve& curve) {
  return is_of_cells(curve) ? "cells of fines" : engine_name(curve.engine);
}

SeriesStyle engine_style(const std::string& engine) {
  const Known* known = find(engine);
  if (known == nullptr) return {.color = palette::green, .width = 1.5, .marker = Marker::triangle, .marker_size = 2.6};
  return {.color = known->color, .width = 1.5, .dash = known->dash, .marker = known->marker, .marker_size = 2.6};
}

std::string law_paragraph(const std::vector<MacroCurve>& curves) {
  std::set<std::string> lines;
  for (const MacroCurve& c : curves)
    if (!c.twin()) lines.insert(engine_name(c) + ": " + identity_text(c.law));
  std::set<std::string> pictures;
  for (const MacroCurve& c : curves)
    if (c.soft > 0 || !c.law.form) pictures.insert(picture_of(c.law));
  std::string text = lines.empty() ? "" : "Laws: " + join_text(lines, "; ");
  for (const std::string& picture : pictures)
    if (!picture.empty()) text += ". Which material: " + picture;
  return text.empty() ? "" : paragraph(text + ".");
}

namespace {

/// The error bars of the curve at these points, of stresses that have them.
void add_band(const MacroCurve& c, Stress member, double unit, const std::vector<std::size_t>& points, Series& s) {
  for (const BandOf of : {BandOf::axial, BandOf::lateral}) {
    if (&(c.*member) != &banded_stress(c, of)) continue;
    const auto band = band_of(c, of, BandPart::all);
    if (!band) continue;
    for (const double v : values_at(band->low, points)) s.band_low.push_back(v / unit);
    for (const double v : values_at(band->high, points)) s.band_high.push_back(v / unit);
  }
}

}  // namespace

void add_curves(Plot& plot, const std::vector<MacroCurve>& curves, Stress member, double unit, StrainPart part) {
  std::set<std::string> named;
  for (const MacroCurve& c : curves) {
    const std::vector<std::size_t> points = points_of_stages(c, part);
    const std::vector<double>& strain = strain_of_part(c, part);
    if ((c.*member).size() != c.strain.size() || strain.size() != c.strain.size() || points.empty()) continue;
    Series s{.label = named.insert(c.engine).second ? engine_name(c) : "", .hover = "", .x = {}, .y = {}};
    s.hover = fmt::format("{}, sample {}{}", engine_name(c), c.sample, c.usable ? "" : " (not usable)");
    for (const double e : values_at(strain, points)) s.x.push_back(100.0 * e);
    for (const double v : values_at(c.*member, points)) s.y.push_back(v / unit);
    s.style = engine_style(c.engine);
    if (!c.usable) s.style.opacity = 0.4;
    s.group = engine_name(c);
    add_band(c, member, unit, points, s);
    plot.add(std::move(s));
  }
}

Series outline(const Histogram& h) {
  const std::vector<double> density = h.density();
  Series s{.label = "", .hover = "", .x = {}, .y = {}};
  for (std::size_t k = 0; k < density.size(); ++k) {
    s.x.insert(s.x.end(), {h.low + h.width() * static_cast<double>(k), h.low + h.width() * static_cast<double>(k + 1)});
    s.y.insert(s.y.end(), {density[k], density[k]});
  }
  return s;
}

}  // namespace softgrain::report
