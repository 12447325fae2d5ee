#include "pipelines/report/engine_style.h"

#include <fmt/format.h>

#include <set>

#include "common/core/text.h"
#include "common/data/macro_band.h"
#include "pipelines/report/html.h"

namespace softgrain::report {
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

SeriesStyle engine_style(const std::string& engine) {
  const Known* known = find(engine);
  if (known == nullptr) return {.color = palette::green, .width = 1.5, .marker = Marker::triangle, .marker_size = 2.6};
  return {.color = known->color, .width = 1.5, .dash = known->dash, .marker = known->marker, .marker_size = 2.6};
}

std::string law_paragraph(const std::vector<MacroCurve>& curves) {
  std::set<std::string> lines;
  for (const MacroCurve& c : curves)
    if (!c.twin()) lines.insert(engine_name(c.engine) + ": " + identity_text(c.law));
  std::set<std::string> pictures;
  for (const MacroCurve& c : curves)
    if (c.soft > 0 || !c.law.form) pictures.insert(picture_of(c.law));
  std::string text = lines.empty() ? "" : "Laws: " + join_text(lines, "; ");
  for (const std::string& picture : pictures)
    if (!picture.empty()) text += ". Which material: " + picture;
  return text.empty() ? "" : paragraph(text + ".");
}

namespace {

/// The error bars of the curve, of stresses that have them.
void add_band(const MacroCurve& c, Stress member, double unit, Series& s) {
  for (const BandOf of : {BandOf::axial, BandOf::lateral}) {
    if (&(c.*member) != &banded_stress(c, of)) continue;
    const auto band = band_of(c, of, BandPart::all);
    if (!band) continue;
    for (const double v : band->low) s.band_low.push_back(v / unit);
    for (const double v : band->high) s.band_high.push_back(v / unit);
  }
}

}  // namespace

void add_curves(Plot& plot, const std::vector<MacroCurve>& curves, Stress member, double unit) {
  std::set<std::string> named;
  for (const MacroCurve& c : curves) {
    if ((c.*member).size() != c.strain.size() || c.strain.empty()) continue;
    Series s{.label = named.insert(c.engine).second ? engine_name(c.engine) : "", .hover = "", .x = {}, .y = {}};
    s.hover = fmt::format("{}, sample {}{}", engine_name(c.engine), c.sample, c.usable ? "" : " (not usable)");
    for (const double e : c.strain) s.x.push_back(100.0 * e);
    for (const double v : c.*member) s.y.push_back(v / unit);
    s.style = engine_style(c.engine);
    if (!c.usable) s.style.opacity = 0.4;
    s.group = engine_name(c.engine);
    add_band(c, member, unit, s);
    plot.add(std::move(s));
  }
}

}  // namespace softgrain::report
