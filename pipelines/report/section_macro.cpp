// Stress and strain of the macro runs: the law engine, the shelled twin, and their difference.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/core/error.h"
#include "pipelines/compare/compare.h"
#include "pipelines/report/engine_style.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {
namespace {

double largest_stress(const std::vector<MacroCurve>& curves) {
  double largest = 0.0;
  for (const MacroCurve& c : curves) {
    for (const double s : c.stress_axial) largest = std::max(largest, std::abs(s));
  }
  return largest;
}

std::vector<MacroCurve> of_test(const std::vector<MacroCurve>& curves, const std::string& test) {
  std::vector<MacroCurve> result;
  std::copy_if(curves.begin(), curves.end(), std::back_inserter(result),
               [&](const MacroCurve& c) { return c.test == test; });
  return result;
}

/// 0, or where the preload of a shear test begins.
double first_strain(const std::vector<MacroCurve>& curves) {
  double first = 0.0;
  for (const MacroCurve& c : curves)
    if (!c.strain.empty()) first = std::min(first, c.strain.front());
  return first;
}

std::string stress_figure(const std::vector<MacroCurve>& curves, const std::string& test, bool axial) {
  const SiPrefix prefix = si_prefix(largest_stress(curves));
  const double first = first_strain(curves);
  Plot plot({.id = "macro-" + test + (axial ? "-axial" : "-lateral"),
             .title = std::string(axial ? "Axial" : "Lateral") + " stress, " + test,
             .x = {.label = "strain [%]", .low = 100.0 * first},
             .y = {.label = fmt::format("{} stress [{}Pa]", axial ? "axial" : "lateral", prefix.symbol)}});
  const Stress member = axial ? &MacroCurve::stress_axial : &MacroCurve::stress_lateral;
  add_curves(plot, curves, member, prefix.factor);
  return plot.empty() ? ""
                      : figure(plot.svg(), axial ? "Stress from the wall forces; one line per sample."
                                                 : "Mean of both lateral directions.");
}

/// (law - twin)/twin at the strains of the twin, where the twin's stress is above 2 % of its largest.
Series difference_series(const MacroCurve& law, const MacroCurve& twin, Stress member) {
  Series s;
  const double floor = 0.02 * *std::max_element((twin.*member).begin(), (twin.*member).end());
  for (std::size_t i = 0; i < twin.strain.size(); ++i) {
    const double reference = (twin.*member)[i];
    if (reference <= floor || twin.strain[i] < law.strain.front() || twin.strain[i] > law.strain.back()) continue;
    s.x.push_back(100.0 * twin.strain[i]);
    s.y.push_back(100.0 * (interpolate_linear(law.strain, law.*member, twin.strain[i]) / reference - 1.0));
  }
  return s;
}

bool complete(const MacroCurve& c, Stress member) {
  return c.strain.size() > 1 && (c.*member).size() == c.strain.size();
}

void add_differences(Plot& plot, const std::vector<MacroCurve>& laws, const std::vector<MacroCurve>& twins,
                     Stress member, bool axial) {
  bool first = true;
  for (const MacroCurve& law : laws) {
    for (const MacroCurve& twin : twins) {
      if (law.sample != twin.sample || !complete(law, member) || !complete(twin, member)) continue;
      Series s = difference_series(law, twin, member);
      if (s.x.empty()) continue;
      s.label = first ? (axial ? "axial" : "lateral") : "";
      s.hover = fmt::format("sample {}, {}", law.sample, axial ? "axial" : "lateral");
      s.style = {.color = axial ? palette::black : palette::green,
                 .width = 1.4,
                 .dash = axial ? "" : "5 3",
                 .marker = axial ? Marker::circle : Marker::triangle,
                 .marker_size = 2.6};
      plot.add(std::move(s));
      first = false;
    }
  }
}

std::string difference_figure(const std::vector<MacroCurve>& laws, const std::vector<MacroCurve>& twins,
                              const std::string& test) {
  Plot plot({.id = "macro-" + test + "-difference",
             .title = "Law minus resolved twin, " + test,
             .x = {.label = "strain [%]", .low = 0.0},
             .y = {.label = "difference of stress [%]"}});
  add_differences(plot, laws, twins, &MacroCurve::stress_axial, true);
  add_differences(plot, laws, twins, &MacroCurve::stress_lateral, false);
  return plot.empty() ? ""
                      : figure(plot.svg(), "Relative to the twin, where its stress exceeds 2 % of its largest value.");
}

std::string mean_text(const MeanError& m, double unit) { return format_with_error(m.mean * unit, m.error * unit); }

std::string comparison_table(const Comparison& c) {
  HtmlTable table({"sample", "strain range [%]", "axial difference [%]", "lateral difference [%]", "axial ratio at end",
                   "lateral/axial, law", "lateral/axial, twin"});
  for (const SampleComparison& s : c.samples) {
    table.row({std::to_string(s.sample),
               format_number(100 * s.strain_low, 3) + " .. " + format_number(100 * s.strain_high, 3),
               format_number(100 * s.axial_difference, 3), format_number(100 * s.lateral_difference, 3),
               format_number(s.axial_end_ratio, 3), format_number(s.lateral_stress_ratio_candidate, 3),
               format_number(s.lateral_stress_ratio_reference, 3)});
  }
  table.row({"mean", "", mean_text(c.axial_difference, 100), mean_text(c.lateral_difference, 100),
             mean_text(c.axial_end_ratio, 1), mean_text(c.lateral_stress_ratio_candidate, 1),
             mean_text(c.lateral_stress_ratio_reference, 1)});
  std::string out = table.html();
  out += paragraph(
      "Difference: square root of ∫(law − twin)² over ∫ twin², over the common strain range. Mean over samples ± "
      "standard error.");
  if (std::isfinite(c.speedup_seconds)) {
    out +=
        paragraph(fmt::format("Speed-up of the law over the resolved twin: {} in seconds, {} in contact evaluations.",
                              format_number(c.speedup_seconds, 3), format_number(c.speedup_contact_evaluations, 3)));
  }
  for (const std::string& reason : c.left_out) out += paragraph("Left out: " + reason + ".");
  return out;
}

std::string comparison_part(const std::vector<MacroCurve>& laws, const std::vector<MacroCurve>& twins) {
  if (laws.empty() || twins.empty()) return "";
  try {
    return comparison_table(compare_curves(laws, twins));
  } catch (const BadInput& error) {
    return paragraph(std::string("No comparison: ") + error.what());
  }
}

std::string bodies_table(const std::vector<MacroCurve>& curves) {
  HtmlTable table({"engine", "sample", "bodies", "soft particles", "volume share of soft", "grains inside",
                   "solid fraction", "usable", "note"});
  for (const MacroCurve& c : curves) {
    table.row({engine_name(c.engine), std::to_string(c.sample), format_count(c.bodies), format_count(c.soft),
               format_number(c.soft_volume_share, 3), c.grains > 0 ? format_count(c.grains) : "–",
               format_number(c.solid_fraction, 3), c.usable ? "yes" : "no", c.note});
  }
  return table.html();
}

}  // namespace

std::string macro_section(const RunData& run) {
  std::set<std::string> tests;
  for (const MacroCurve& c : run.macro) tests.insert(c.test);
  std::string body;
  for (const std::string& test : tests) {
    const auto curves = of_test(run.macro, test);
    const auto laws = curves_of(curves, "law");
    const auto twins = curves_of(curves, "shelled");
    if (tests.size() > 1) body += "<h3>" + escape(test) + "</h3>\n";
    body += figure_row(
        {stress_figure(curves, test, true), stress_figure(curves, test, false), difference_figure(laws, twins, test)});
    body += comparison_part(laws, twins) + bodies_table(curves);
  }
  return section("macro", "Macro scene", body);
}

}  // namespace softgrain::report
