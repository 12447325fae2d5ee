// Stress and strain of the macro runs in the report: the law engine, the shelled twin, and their difference. Then what
// runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/io/hdf5_file.h"
#include "macrosim/macro_packing.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/stage_match.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/run/findings.h"

namespace softgrain::report {

namespace {

double largest_stress(const std::vector<MacroCurve>& curves) {
  double largest = 0.0;
  for (const MacroCurve& c : curves) {
    for (const double s : c.stress_axial) largest = std::max(largest, std::abs(s));
  }
  return largest;
}

double last_strain(const std::vector<MacroCurve>& curves) {
  double last = 0.0;
  for (const MacroCurve& c : curves)
    if (!c.strain.empty()) last = std::max(last, c.strain.back());
  return last;
}

std::vector<MacroCurve> of_test(const std::vector<MacroCurve>& curves, MacroTest test) {
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

/// Shorter plots that stand above each other in one figure, with the same horizontal axis.
constexpr double kStressHeight = 310.0;
constexpr double kDifferenceHeight = 210.0;
constexpr double kLeftMargin = 66.0;  // [px] for labels of either

/// What figures show: one test of all engines, as far as it is drawn over one strain.
struct DrawnTest {
  const std::vector<MacroCurve>& curves;
  MacroTest test{};
  StrainPart part{};

  [[nodiscard]] std::string id(const char* what) const {
    return "macro-" + to_string(test) + what + (part == StrainPart::shear ? "-sliding" : "");
  }
  [[nodiscard]] std::string title() const { return to_string(test) + (part == StrainPart::shear ? " that slide" : ""); }
};

/// Strain, from end to end of all curves; of tests in stages, which go forth and back, as the data ask.
AxisOptions strain_axis(const DrawnTest& drawn) {
  const auto& [curves, test, part] = drawn;
  if (part != StrainPart::whole) return {.label = strain_label(part, test)};
  return {.label = "strain [%]", .low = 100.0 * first_strain(curves), .high = 102.0 * last_strain(curves)};
}

Plot stress_plot(const DrawnTest& drawn, bool axial) {
  const SiPrefix prefix = si_prefix(largest_stress(drawn.curves));
  Plot plot({.id = drawn.id(axial ? "-axial" : "-lateral"),
             .title = std::string(axial ? "Axial" : "Lateral") + " stress, " + drawn.title(),
             .x = strain_axis(drawn),
             .y = {.label = fmt::format("{} stress [{}Pa]", axial ? "axial" : "lateral", prefix.symbol)},
             .height = kStressHeight,
             .left_margin = kLeftMargin});
  add_curves(plot, drawn.curves, axial ? &MacroCurve::stress_axial : &MacroCurve::stress_lateral, prefix.factor,
             drawn.part);
  return plot;
}

/// Stress of the law run at the points of the twin. Not a number where a test in stages imposes it, or where the law
/// run does not reach the point.
std::vector<double> values_of_law(const MacroCurve& law, const MacroCurve& twin, Stress member) {
  const ComparedStress what = member == &MacroCurve::stress_axial ? ComparedStress::axial : ComparedStress::lateral;
  try {
    std::vector<double> out = values_at_points(law, law.*member, twin);
    const std::vector<bool> given = imposed_points(twin, what);
    for (std::size_t i = 0; i < out.size(); ++i)
      if (given[i]) out[i] = kNaN;
    return out;
  } catch (const InputError&) {  // said below
    return std::vector<double>(twin.strain.size(), kNaN);
  }
}

/// (law - twin)/twin at the points of the twin in this part, where the twin's stress is above 2 % of its largest.
Series difference_series(const MacroCurve& law, const MacroCurve& twin, Stress member, StrainPart part) {
  Series s;
  const std::vector<double> by_law = values_of_law(law, twin, member);
  const double floor = std::max(0.02 * *std::max_element((twin.*member).begin(), (twin.*member).end()), 0.0);
  const std::vector<double>& strain = strain_of_part(twin, part);
  if (strain.size() != twin.strain.size()) return s;
  for (const std::size_t i : points_of_stages(twin, part)) {
    const double reference = (twin.*member)[i];
    if (reference <= floor || !std::isfinite(by_law[i])) continue;
    s.x.push_back(100.0 * strain[i]);
    s.y.push_back(100.0 * (by_law[i] / reference - 1.0));
  }
  return s;
}

bool complete(const MacroCurve& c, Stress member) {
  return c.strain.size() > 1 && (c.*member).size() == c.strain.size();
}

/// One line per sample, each compared with its own twin.
void add_differences(Plot& plot, const std::vector<MacroCurve>& laws, const std::vector<MacroCurve>& twins,
                     Stress member, StrainPart part) {
  static constexpr Marker markers[] = {Marker::circle, Marker::triangle, Marker::square, Marker::diamond};
  std::size_t index = 0;
  for (const MacroCurve& law : laws) {
    for (const MacroCurve& twin : twins) {
      if (law.sample != twin.sample || !complete(law, member) || !complete(twin, member)) continue;
      Series s = difference_series(law, twin, member, part);
      if (s.x.empty()) continue;
      s.label = fmt::format("sample {}", law.sample);
      s.style = {.color = palette::black, .width = 1.3, .marker = markers[index++ % 4], .marker_size = 2.6};
      plot.add(std::move(s));
    }
  }
}

/// From end to end of the drawn strains.
std::pair<double, double> drawn_range(const DrawnTest& drawn) {
  if (drawn.part == StrainPart::whole) return {first_strain(drawn.curves), last_strain(drawn.curves)};
  double last = 0.0;
  for (const MacroCurve& c : drawn.curves)
    for (const double e : values_at(strain_of_part(c, drawn.part), points_of_stages(c, drawn.part)))
      last = std::max(last, e);
  return {0.0, last};
}

Plot difference_plot(const DrawnTest& drawn, bool axial) {
  const auto laws = curves_of(drawn.curves, "law");
  const auto twins = curves_of(drawn.curves, "shelled");
  const auto [first, last] = drawn_range(drawn);
  Plot plot({.id = drawn.id(axial ? "-axial-difference" : "-lateral-difference"),
             .title = std::string("Law minus resolved twin, ") + (axial ? "axial" : "lateral"),
             .x = strain_axis(drawn),
             .y = {.label = "difference [%]"},
             .height = kDifferenceHeight,
             .left_margin = kLeftMargin});
  add_differences(plot, laws, twins, axial ? &MacroCurve::stress_axial : &MacroCurve::stress_lateral, drawn.part);
  if (plot.empty()) return plot;
  plot.add({.label = "",
            .hover = "no difference",
            .x = {100.0 * first, 102.0 * last},
            .y = {0.0, 0.0},
            .style = {.color = palette::vermillion, .width = 1.0, .dash = "6 3"}});
  return plot;
}

std::string stress_source(const std::vector<MacroCurve>& curves) {
  const bool periodic = !curves.empty() && curves.front().boundary == Boundary::periodic;
  if (!curves.empty() && is_of_cells(curves.front())) return "Stress of the cells";
  return periodic ? "Stress from the contacts of a periodic cell" : "Stress from the wall forces";
}

/// Stress above, and below how far the law is from the twin.
std::string stress_figure(const DrawnTest& drawn, bool axial) {
  const Plot stress = stress_plot(drawn, axial);
  if (stress.empty()) return "";
  const Plot difference = difference_plot(drawn, axial);
  std::string caption =
      axial ? stress_source(drawn.curves) + "; one line per sample." : "Mean of both lateral directions.";
  if (!difference.empty())
    caption += " Below: relative to the twin of the same sample, where its stress exceeds 2 % of its largest value.";
  return figure(stress.svg() + (difference.empty() ? "" : difference.svg()), caption);
}

std::string coordination_figure(const DrawnTest& drawn) {
  Plot plot({.id = drawn.id("-coordination"),
             .title = "Coordination number, " + drawn.title(),
             .x = strain_axis(drawn),
             .y = {.label = "neighbours per body"},
             .height = kStressHeight});
  add_curves(plot, drawn.curves, &MacroCurve::coordination_bodies, 1.0, drawn.part);
  return plot.empty() ? ""
                      : figure(plot.svg(), "Bodies and walls that a body touches, a soft particle being one body.");
}

std::string mean_text(const MeanError& m, double unit) { return format_with_error(m.mean * unit, m.error * unit); }

/// Common strains in percent, with those of stages that slide.
std::string range_text(const SampleComparison& s) {
  const auto text = [](double low, double high) {
    return format_number(100 * low, 3) + " .. " + format_number(100 * high, 3);
  };
  const std::string axial = text(s.strain_low, s.strain_high);
  return std::isfinite(s.shear_high) ? axial + ", shear " + text(s.shear_low, s.shear_high) : axial;
}

std::string comparison_table(const Comparison& c) {
  HtmlTable table({"sample", "strain range [%]", "axial difference [%]", "lateral difference [%]", "axial ratio at end",
                   "lateral/axial, law", "lateral/axial, twin"});
  for (const SampleComparison& s : c.samples) {
    table.row({std::to_string(s.sample), range_text(s), format_number(100 * s.axial_difference, 3),
               format_number(100 * s.lateral_difference, 3), format_number(s.axial_end_ratio, 3),
               format_number(s.lateral_stress_ratio_candidate, 3), format_number(s.lateral_stress_ratio_reference, 3)});
  }
  table.row({"mean", "", mean_text(c.axial_difference, 100), mean_text(c.lateral_difference, 100),
             mean_text(c.axial_end_ratio, 1), mean_text(c.lateral_stress_ratio_candidate, 1),
             mean_text(c.lateral_stress_ratio_reference, 1)});
  std::string out = table.html();
  out += paragraph(
      "Difference: square root of ∫(law − twin)² over ∫ twin², over the common strain range, of tests in stages stage "
      "by stage without those that impose it. Mean over samples ± standard error.");
  for (const ComparedQuantity& q : headline_of(c)) {
    if (c.samples.front().test != MacroTest::stages) break;
    out += paragraph("In stages, " + q.what + ": " +
                     (q.is_ratio ? mean_text(q.value, 1) : "difference " + mean_text(q.value, 100) + " %") + ".");
  }
  if (std::isfinite(c.speedup_seconds)) {
    out +=
        paragraph(fmt::format("Speed-up of the law over the resolved twin: {} in seconds, {} in contact evaluations.",
                              format_number(c.speedup_seconds, 3), format_number(c.speedup_contact_evaluations, 3)));
  }
  for (const std::string& reason : c.left_out) out += paragraph("Left out: " + reason + ".");
  for (const std::string& one : c.undefined) out += paragraph("Undefined: " + one + ".");
  return out;
}

std::string comparison_part(const std::vector<MacroCurve>& laws, const std::vector<MacroCurve>& twins) {
  if (laws.empty() || twins.empty()) return "";
  try {
    return comparison_table(compare_curves(laws, twins));
  } catch (const InputError& error) {
    return paragraph(std::string("No comparison: ") + error.what());
  }
}

std::string bodies_table(const std::vector<MacroCurve>& curves) {
  HtmlTable table({"engine", "sample", "bodies", "soft particles", "volume share of soft", "grains inside",
                   "solid fraction", "usable", "note"});
  for (const MacroCurve& c : curves) {
    table.row({engine_name(c), std::to_string(c.sample), format_count(c.bodies), format_count(c.soft),
               format_number(c.soft_volume_share, 3), c.grains > 0 ? format_count(c.grains) : "–",
               format_number(c.solid_fraction, 3), c.usable ? "yes" : "no", c.note});
  }
  return table.html();
}

}  // namespace

std::string macro_section(const RunData& run) {
  std::set<MacroTest> tests;
  for (const MacroCurve& c : run.macro) tests.insert(c.test);
  std::string body;
  for (const MacroTest test : tests) {
    const auto curves = of_test(run.macro, test);
    const auto laws = curves_of(curves, "law");
    const auto twins = curves_of(curves, "shelled");
    if (tests.size() > 1) body += "<h3>" + escape(to_string(test)) + "</h3>\n";
    std::vector<std::string> coordination;
    for (const StrainPart part : strain_parts(test)) {
      const DrawnTest drawn{curves, test, part};
      body += figure_row({stress_figure(drawn, true), stress_figure(drawn, false)});
      coordination.push_back(coordination_figure(drawn));
    }
    body += stage_parts(curves, test) + figure_row(coordination);
    body += tensor_parts(curves, "macro-" + to_string(test));
    body += comparison_part(laws, twins) + bodies_table(curves) + law_paragraph(curves);
  }
  return section(
      "macro", "Macro scene",
      "Stress against strain by each engine and, where there is a resolved twin, its difference from the law.", body);
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

using namespace report;

void check_macro_file(const std::string& path, Findings& out) {
  const std::vector<MacroCurve> curves = load_macro(path);
  out.add("kind", "macro curves", fmt::format("macro curves: {}", curves.size()));
  out.facts["curves"] = nlohmann::json::array();
  for (const MacroCurve& c : curves) {
    const bool recorded = !c.strain.empty() && !c.stress_axial.empty();
    out.facts["curves"].push_back({{"engine", c.engine}, {"sample", c.sample}, {"usable", c.usable}});
    if (recorded)
      out.lines += fmt::format("    {} sample {}: {} bodies, {} to a strain of {:.3g}, axial stress {:.4g} Pa{}\n",
                               c.engine, c.sample, c.bodies, counted(c.strain.size(), "point"), c.strain.back(),
                               c.stress_axial.back(), c.usable ? "" : ", not usable");
    if (!c.usable) out.warn(fmt::format("{} sample {} is not usable: {}", c.engine, c.sample, c.note));
    if (!c.law_beyond.empty() && c.law_beyond.back() > 0.0)
      out.warn(fmt::format("{} sample {}: {:.0f} of {:.0f} uses of its law lay beyond what was measured at the end",
                           c.engine, c.sample, c.law_beyond.back(),
                           c.law_evaluations.empty() ? 0.0 : c.law_evaluations.back()));
  }
}

void check_packings_file(const std::string& path, Findings& out) {
  std::size_t samples = 0;
  std::size_t bodies = 0;
  h5::naming_file(path, [&] {
    const h5::Group root = h5::open_file(path);
    for (std::string name = "sample_0"; root.has(name); name = fmt::format("sample_{}", ++samples))
      bodies += read_macro_packing(root.open(name)).bodies.size();
  });
  out.add("kind", "packings", fmt::format("packings: {}, with {} bodies in all", samples, bodies));
}

/// Where usable runs of one engine ended, when there is nothing to compare with. Strains of tests in stages may differ
/// between samples.
std::string end_line(const std::vector<MacroCurve>& curves) {
  std::vector<double> stress;
  std::vector<double> strain;
  for (const MacroCurve& c : curves) {
    if (!c.usable || c.stress_axial.empty()) continue;
    stress.push_back(c.stress_axial.back());
    strain.push_back(strain_at_end(c).value);
  }
  const std::size_t left_out = curves.size() - stress.size();
  if (stress.empty()) return left_out > 0 ? "No usable run." : "";
  const MeanError mean = mean_error(stress);
  return fmt::format("Axial stress {} Pa at {} {} ({}; {} {}{}).",
                     stress.size() > 1 ? format_with_error(mean.mean, mean.error) : format_number(mean.mean, 4),
                     strain_at_end(curves.front()).name, format_number(mean_error(strain).mean, 3),
                     to_string(curves.front().test), stress.size(), stress.size() > 1 ? "samples, mean" : "sample",
                     left_out > 0 ? fmt::format("; {} not usable", left_out) : "");
}

/// What law and twin differ by, of tests in stages in what these do not impose.
std::string difference_line(const Comparison& c) {
  const std::vector<ComparedQuantity> all = headline_of(c);
  if (all.size() == 1 && all.front().what == "stress")
    return fmt::format("Stress by the law differs from the resolved twin by {} %",
                       format_with_error(100 * c.axial_difference.mean, 100 * c.axial_difference.error));
  std::string text = "Law and resolved twin differ";
  const char* before = ": ";
  for (const ComparedQuantity& q : all) {
    text += before + q.what +
            (q.is_ratio ? " " + format_with_error(q.value.mean, q.value.error)
                        : fmt::format(" {} %", format_with_error(100 * q.value.mean, 100 * q.value.error)));
    before = ", ";
  }
  return all.empty() ? "Law and resolved twin: the test imposes all that could differ" : text;
}

std::string macro_line(const std::vector<MacroCurve>& macro) {
  const auto laws = curves_of(macro, "law");
  const auto twins = curves_of(macro, "shelled");
  if (laws.empty() || twins.empty()) return end_line(laws.empty() ? macro : laws);
  try {
    const Comparison c = compare_curves(laws, twins);
    if (!c.undefined.empty()) return "Law and resolved twin: " + c.undefined.front() + ".";
    return fmt::format("{} ({}); {} times fewer contact evaluations, {} times faster.", difference_line(c),
                       counted(c.samples.size(), "sample"), format_number(c.speedup_contact_evaluations, 3),
                       format_number(c.speedup_seconds, 3));
  } catch (const InputError& error) {
    return error.what();
  }
}

std::vector<HeadLine> lines_of(const RunData& run) {
  if (run.macro.empty()) return {};
  return {{kResultLabel, macro_line(run.macro)}};
}

/// What the law is off by, and what it saves, beside the shelled twin.
void add_comparison(const std::vector<MacroCurve>& macro, std::vector<RunValue>& out) {
  const auto laws = curves_of(macro, "law");
  const auto twins = curves_of(macro, "shelled");
  if (laws.empty() || twins.empty()) return;
  try {
    const Comparison c = compare_curves(laws, twins);
    if (!c.undefined.empty()) return;
    for (const ComparedQuantity& q : headline_of(c)) {
      const double unit = q.is_ratio ? 1.0 : 100.0;
      out.push_back({q.is_ratio ? q.what : q.what + " of the law, off from the twin", q.is_ratio ? "" : "%",
                     unit * q.value.mean, unit * q.value.error});
    }
    out.push_back({"contact evaluations of the twin over those of the law", "", c.speedup_contact_evaluations});
  } catch (const InputError&) {  // no sample with two usable curves: said elsewhere
  }
}

std::vector<RunValue> values_beside(const RunData& run) {
  std::vector<RunValue> out = stress_values(by_engine(run.macro));
  add_comparison(run.macro, out);
  return out;
}

std::vector<RunCurve> curves_beside(const RunData& run) { return stress_curves(by_engine(run.macro)); }

NextSteps next_of(const RunData& run) {
  const auto any = [&](auto&& is) { return std::any_of(run.macro.begin(), run.macro.end(), is); };
  const bool twin = any([](const MacroCurve& c) { return c.twin() == Twin::shelled; });
  const bool pair = any([](const MacroCurve& c) { return c.law.form == LawForm::pair; });
  const bool several = any([](const MacroCurve& c) { return c.sample > 0; });
  const char* law = !twin ? "How far the law is off: the resolved twin of the same scene (`--set macro.resolved=true`; "
                            "`softgrain check` says "
                            "what it takes), or error bars from the law itself (`--bands 64`)."
                    : pair ? "The pair law knows one contact: take one that knows all, `softgrain macrosim SCENE.toml "
                             "--law LAW_TABLE.toml` (one "
                             "comes along, `results/law_table`; `softgrain run pipelines/law_table.toml` measures one)."
                           : "Where law and twin differ: `--bands 64` shows what the law is not sure of, `softgrain "
                             "law plan LAW_TABLE.toml --for "
                             "SCENE.toml` what to measure next.";
  return {
      law,
      several
          ? "What the result depends on: `softgrain sweep SCENE.toml --over macro.bodies=40,80,160 --seeds 1..4`."
          : "One sample tells nothing of scatter: `softgrain macrosim SCENE.toml --seeds 1..8` gives mean, spread and "
            "standard error."};
}

}  // namespace

KindResults macro_results() {
  return {.files = {{.names = "macro\\.h5",
                     .is = [](const h5::Group& root) { return root.has("curves"); },
                     .check = check_macro_file},
                    {.names = "macro_initial\\.h5",
                     .is = [](const h5::Group& root) { return root.has("sample_0") && !root.has("spec"); },
                     .check = check_packings_file},
                    {.names = "states_macro\\.h5|lammps-[0-9]+"}},
          .sections = {{Part::macro, macro_section}},
          .lines = lines_of,
          .values = values_beside,
          .curves = curves_beside,
          .next = next_of};
}

}  // namespace softgrain
