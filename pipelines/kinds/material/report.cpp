// Resolved packings in the report: pressure over solid fraction, stresses and their ratio over strain, who bears them.
// Then what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "common/data/law_words.h"
#include "macrosim/body_contacts.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro/summary.h"
#include "pipelines/kinds/material/scene.h"
#include "pipelines/kinds/material/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/law_curves.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

namespace {

struct Variant {
  std::string name;
  std::vector<MacroCurve> curves;
};

std::vector<Variant> variants_of(const RunData& run) {
  std::vector<Variant> out;
  for (const MaterialVariantSummary& v : run.summary_as<MaterialSummary>().variants) {
    if (v.file.empty()) continue;  // summaries of other kinds have variants too
    if (const auto* curves = run.file(v.file, load_macro)) out.push_back({v.name, *curves});
  }
  return out;
}

const std::vector<double>& more_of(const MacroCurve& c, const std::string& name) {
  static const std::vector<double> kNone;
  const auto found = c.more.find(name);
  return found == c.more.end() ? kNone : found->second;
}

using Column = std::function<std::vector<double>(const MacroCurve&)>;

/// One line per sample, one colour per variant.
void add_lines(Plot& plot, const std::vector<Variant>& variants, const Column& x, const Column& y) {
  for (std::size_t v = 0; v < variants.size(); ++v) {
    bool named = false;
    for (const MacroCurve& c : variants[v].curves) {
      Series s{.label = named ? "" : variants[v].name, .hover = "", .x = x(c), .y = y(c)};
      if (s.x.size() != s.y.size() || s.x.empty()) continue;
      named = true;
      s.hover = fmt::format("{}, sample {}{}", variants[v].name, c.sample, c.usable ? "" : " (not usable)");
      s.style = {.color = palette::cycle(v), .width = 1.4, .marker = Marker::circle, .marker_size = 2.2};
      if (!c.usable) s.style.opacity = 0.4;
      s.group = variants[v].name;
      plot.add(std::move(s));
    }
  }
}

std::vector<double> scaled(std::vector<double> values, double by) {
  for (double& v : values) v *= by;
  return values;
}

std::string line_figure(const std::vector<Variant>& variants, PlotOptions options, const char* caption, const Column& x,
                        const Column& y) {
  Plot plot(std::move(options));
  add_lines(plot, variants, x, y);
  return plot.empty() ? "" : figure(plot.svg(), caption);
}

/// Values at the points of a curve that belong to a part.
Column only_stages(const Column& column, StrainPart part) {
  return [=](const MacroCurve& c) { return values_at(column(c), points_of_stages(c, part)); };
}

/// A quantity over what drives the stages: over the strain of z, and where stages slide, as z stands still or dilates
/// then, in a figure of its own over the shear strain.
std::vector<std::string> figures_over_strain(const std::vector<Variant>& variants, const PlotOptions& options,
                                             const char* caption, const Column& y) {
  std::vector<std::string> figures;
  for (const StrainPart part : kPartsOfStages) {
    PlotOptions own = options;
    if (part == StrainPart::shear) {
      own.id += "-sliding";
      own.title += ", stages that slide";
    }
    own.x = {.label = strain_label(part, MacroTest::stages)};
    const Column strain = [=](const MacroCurve& c) { return scaled(strain_of_part(c, part), 100.0); };
    std::string one = line_figure(variants, std::move(own), caption, only_stages(strain, part), only_stages(y, part));
    if (!one.empty()) figures.push_back(std::move(one));
  }
  return figures;
}

/// How stresses of figures are given: of tests in stages, whose stresses are those of a laboratory, in Pa, else over E.
struct StressScale {
  double factor = 0.0;  ///< [Pa]; 0: E of each curve
  std::string text;

  [[nodiscard]] double of(const MacroCurve& c) const { return factor > 0.0 ? factor : c.start.youngs_modulus; }
  [[nodiscard]] std::string label(const std::string& what) const {
    return factor > 0.0 ? what + " [" + text + "]" : what == "p" ? "p/E" : what + " over E";
  }
};

StressScale stress_scale(const std::vector<Variant>& variants) {
  double largest = 0.0;
  for (const Variant& v : variants)
    for (const MacroCurve& c : v.curves) {
      if (c.test != MacroTest::stages) return {};
      for (const double s : c.stress_axial) largest = std::max(largest, std::abs(s));
    }
  const SiPrefix prefix = si_prefix(largest);
  return {prefix.factor, prefix.symbol + "Pa"};
}

std::string state_figure(const std::vector<Variant>& variants, const StressScale& unit) {
  return line_figure(
      variants,
      {.id = "material-state",
       .title = "Mean stress over solid fraction",
       .x = {.label = "solid fraction"},
       .y = {.label = unit.label("p"), .scale = Scale::logarithmic}},
      "Full volume of all grains over that of the cell; p the mean stress from the contacts. One line per sample.",
      [](const MacroCurve& c) { return more_of(c, kSolidFraction); },
      [unit](const MacroCurve& c) { return scaled(mean_stresses(c), 1.0 / unit.of(c)); });
}

std::vector<std::string> stress_figures(const std::vector<Variant>& variants, const StressScale& unit) {
  return figures_over_strain(
      variants, {.id = "material-axial", .title = "Axial stress", .x = {}, .y = {.label = unit.label("axial stress")}},
      "Nominal strain from the start of the test.",
      [unit](const MacroCurve& c) { return scaled(c.stress_axial, 1.0 / unit.of(c)); });
}

std::vector<std::string> ratio_figures(const std::vector<Variant>& variants) {
  return figures_over_strain(variants,
                             {.id = "material-ratio", .title = "Stress ratio", .x = {}, .y = {.label = "q/p"}},
                             "q = √(3J₂), p the mean stress.", [](const MacroCurve& c) { return stress_ratios(c); });
}

std::vector<std::string> rattler_figures(const std::vector<Variant>& variants) {
  return figures_over_strain(
      variants, {.id = "material-rattlers", .title = "Rattlers", .x = {}, .y = {.label = "share of the grains [%]"}},
      "Grains with fewer than four contacts (with friction: two) to grains that do not rattle.",
      [](const MacroCurve& c) { return scaled(more_of(c, kRattlers), 100.0); });
}

/// All figures, two in a row.
std::string in_rows(const std::vector<std::string>& figures) {
  std::string out;
  for (std::size_t k = 0; k < figures.size(); k += 2)
    out += figure_row(k + 1 < figures.size() ? std::vector<std::string>{figures[k], figures[k + 1]}
                                             : std::vector<std::string>{figures[k]});
  return out;
}

/// Shares at start and end, mean over samples.
std::string share_table(const std::vector<Variant>& variants) {
  HtmlTable table({"variant", "contacts", "share of p at the start [%]", "share of p at the end [%]"}, 2);
  for (const Variant& v : variants) {
    if (v.curves.empty()) continue;
    for (const auto& [name, ignored] : v.curves.front().more) {
      if (name == kSolidFraction || name == kRattlers) continue;
      std::vector<double> first;
      std::vector<double> last;
      for (const MacroCurve& c : v.curves) {
        const auto& values = more_of(c, name);
        if (!c.usable || values.empty()) continue;
        first.push_back(100.0 * values.front());
        last.push_back(100.0 * values.back());
      }
      const MeanError a = mean_error(first);
      const MeanError b = mean_error(last);
      table.row({v.name, name, format_with_error(a.mean, a.error), format_with_error(b.mean, b.error)});
    }
  }
  if (table.empty()) return "";
  return table.html() +
         paragraph(
             "Shares of the mean stress by the virial of the contacts; a grain is coarse above the named "
             "share of the largest radius. Mean over samples ± standard error.");
}

std::string interval(const Estimate& e, int digits = 4) {
  return fmt::format("{} ({})", format_number(e.value, digits),
                     ends_text(e.low, e.high, {format_number, digits, " to ", "interval not determined", true}));
}

/// p/E over x, every sample with the onset of its variant, and the curve that all share.
std::string collapse_figure(const std::vector<Variant>& variants, const EquationSummary& s) {
  const bool porosity = s.form == StateForm::porosity;
  const auto loss = [&](double phi, double onset) {
    return porosity ? (phi - onset) / (1.0 - onset) : 1.0 - (1.0 - phi) / phi * onset / (1.0 - onset);
  };
  Plot plot({.id = "material-collapse",
             .title = "Equation of state",
             .x = {.label = porosity ? "x = (φ − φ_J)/(1 − φ_J)" : "x = 1 − Vp/Vp_J", .scale = Scale::logarithmic},
             .y = {.label = "p/E", .scale = Scale::logarithmic}});
  std::vector<Variant> fitted;
  double largest = 0.0;
  for (const Variant& v : variants)
    for (const OnsetSummary& o : s.onsets)
      if (o.name == v.name) {
        fitted.push_back({v.name, {}});
        for (const MacroCurve& c : v.curves) {
          const StateCurve part = state_curve(c, v.name, o.span);
          MacroCurve reduced;
          reduced.sample = c.sample;
          for (std::size_t k = 0; k < part.phi.size(); ++k) {
            reduced.strain.push_back(loss(part.phi[k], o.onset.value));
            reduced.stress_axial.push_back(part.pressure[k]);
            largest = std::max(largest, reduced.strain.back());
          }
          fitted.back().curves.push_back(std::move(reduced));
        }
      }
  add_lines(
      plot, fitted, [](const MacroCurve& c) { return c.strain; }, [](const MacroCurve& c) { return c.stress_axial; });
  if (plot.empty() || !(largest > 0.0)) return "";
  Series fit{.label = "K xⁿ", .hover = "", .x = {}, .y = {}};
  for (const double share : spread(-0.9, 0.0, 40)) {
    fit.x.push_back(largest * std::pow(10.0, share));
    fit.y.push_back(s.modulus.value * std::pow(fit.x.back(), s.exponent.value));
  }
  fit.style = {.color = palette::black, .width = 1.2, .dash = "6 3"};
  plot.add(std::move(fit));
  return figure(plot.svg(), "All samples over their relative loss of pores, and what is fitted to all.");
}

std::string equation_part(const std::vector<Variant>& variants, const RunData& run) {
  const auto summary = run.summary_as<MaterialSummary>();
  if (!summary.equation) return "";
  const EquationSummary& s = *summary.equation;
  if (!s.usable) return paragraph("Equation of state: not usable: " + s.message + ".");
  std::string out = figure_row({collapse_figure(variants, s)});
  out += paragraph(fmt::format(
      "Equation of state, {} form: K = {}, n = {}; pressures follow it to {} % (95 % intervals in brackets).",
      to_string(s.form), interval(s.modulus), interval(s.exponent), format_number(100.0 * s.pressure_deviation, 2)));
  if (s.message != "fitted") out += paragraph(s.message + ".");
  HtmlTable onsets({"variant", "span", "samples", "φ_J", "K by itself"});
  for (const OnsetSummary& o : s.onsets)
    onsets.row({o.name, format_number(o.span, 3), std::to_string(o.samples), interval(o.onset),
                format_number(o.own_modulus, 3)});
  for (const KnownOnset& k : s.known)
    onsets.row({"measured elsewhere", format_number(k.span, 3), "–", format_with_error(k.value, k.standard_error), "–"});
  out += onsets.html();
  if (s.onsets.size() > 1)
    out += paragraph(fmt::format(
        "K of the variants scatters by {} %; as much or more comes with a probability of {} if there is one K.",
        format_number(100.0 * s.modulus_scatter, 2), format_number(s.collapse_probability, 2)));
  HtmlTable beyond({"materials", "span", "fitted up to", "φ_J extrapolated", "φ_J measured"});
  for (const ExtrapolationSummary& e : s.extrapolations)
    beyond.row({e.family, format_number(e.span, 5), format_number(e.largest_fitted, 3),
                e.onset ? interval(*e.onset) : e.message, e.measured ? interval(*e.measured) : "–"});
  return out + (beyond.empty() ? "" : beyond.html());
}

PredictedValue value_of(const PredictedPoint& p, StageKind kind) {
  return keeps_volume(kind) ? p.deviator : kind == StageKind::isotropic ? p.pressure : p.axial;
}

std::string quantity(StageKind kind) {
  return keeps_volume(kind) ? "q/p" : kind == StageKind::isotropic ? "p/E" : "axial stress over E";
}

/// Bands of all spans under one loading, and dots where there is a variant of that span.
std::string prediction_figure(const std::vector<const PredictionSummary*>& spans, std::size_t number) {
  const PredictionSummary& first = *spans.front();
  const bool shear = keeps_volume(first.kind);
  Plot plot({.id = fmt::format("material-predicted-{}", number),
             .title = "Predicted from smaller spans" + (first.loading.empty() ? "" : ", " + first.loading),
             .x = {.label = "axial strain [%]"},
             .y = {.label = quantity(first.kind), .scale = shear ? Scale::linear : Scale::logarithmic}});
  for (std::size_t k = 0; k < spans.size(); ++k) {
    Series band{.label = fmt::format("span {:g}", spans[k]->span), .hover = "", .x = {}, .y = {}};
    Series dots{.label = "", .hover = fmt::format("span {:g}, measured", spans[k]->span), .x = {}, .y = {}};
    for (const PredictedPoint& p : spans[k]->points) {
      const PredictedValue v = value_of(p, first.kind);
      band.x.push_back(100.0 * p.strain);
      band.y.push_back(v.predicted.value);
      band.band_low.push_back(v.predicted.low);
      band.band_high.push_back(v.predicted.high);
      if (!v.measured) continue;
      dots.x.push_back(100.0 * p.strain);
      dots.y.push_back(v.measured->mean);
      dots.y_error.push_back(v.measured->error_or_zero());
    }
    band.style = {.color = palette::cycle(k), .width = 1.4};
    dots.style = {.color = palette::cycle(k), .width = 0.0, .marker = Marker::circle, .marker_size = 2.6};
    dots.group = band.label;
    plot.add(std::move(band));
    if (!dots.x.empty()) plot.add(std::move(dots));
  }
  return figure(plot.svg(), escape(first.family) + ": 95 % intervals; dots: what variants of that span measured.");
}

std::string interval_cell(const PredictedValue& v) {
  return fmt::format("{} ({:.0f} % wide)", interval(v.predicted, 3), 100.0 * v.width());
}

std::string prediction_part(const RunData& run) {
  const auto summary = run.summary_as<MaterialSummary>();
  if (summary.predictions.empty()) return "";
  std::map<std::pair<std::string, std::string>, std::vector<const PredictionSummary*>> groups;
  HtmlTable table({"materials", "loading", "span", "strain [%]", "quantity", "predicted", "measured", "inside"});
  std::string refused;
  for (const PredictionSummary& s : summary.predictions) {
    if (!s.usable || s.points.empty()) {
      refused += paragraph(
          escape(fmt::format("{} {}, span {:g}: not predicted: {}.", s.family, s.loading, s.span, s.message)));
      continue;
    }
    groups[{s.family, s.loading}].push_back(&s);
    const PredictedPoint& p = point_near(s, 0.05);
    const PredictedValue v = value_of(p, s.kind);
    table.row({s.family, s.loading, format_number(s.span, 5), format_number(100.0 * p.strain, 3), quantity(s.kind),
               interval_cell(v) + (p.beyond && !keeps_volume(s.kind) ? ", beyond the pressures that were fitted" : ""),
               v.measured ? format_with_error(v.measured->mean, v.measured->error_or_zero()) : "–",
               !v.measured  ? "–"
               : v.inside() ? "yes"
                            : "no"});
  }
  std::vector<std::string> figures;
  for (const auto& [key, spans] : groups) figures.push_back(prediction_figure(spans, figures.size()));
  std::string out = "<h3>Larger spans, predicted</h3>\n";
  for (const std::string& f : figures) out += figure_row({f});
  return out + (table.empty() ? "" : table.html()) + refused;
}

}  // namespace

std::string material_section(const RunData& run) {
  const std::vector<Variant> variants = variants_of(run);
  if (variants.empty()) return "";
  const StressScale unit = stress_scale(variants);
  std::vector<std::string> figures{state_figure(variants, unit)};
  for (std::vector<std::string> more :
       {stress_figures(variants, unit), ratio_figures(variants), rattler_figures(variants)})
    figures.insert(figures.end(), more.begin(), more.end());
  std::string body = in_rows(figures);
  body += equation_part(variants, run);
  body += prediction_part(run);
  for (std::size_t k = 0; k < variants.size(); ++k) {
    const Variant& v = variants[k];
    if (v.curves.empty()) continue;
    if (variants.size() > 1) body += "<h3>" + escape(v.name) + "</h3>\n";
    body += stage_parts(v.curves, MacroTest::oedometric) + tensor_parts(v.curves, fmt::format("material-{}", k + 1));
  }
  return section("material", "Material",
                 "Stress against strain of the material with every grain resolved, for each variant.",
                 body + share_table(variants));
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

using namespace report;

/// ", axial stress 1.00 ± 0.01 MPa (1.4×10⁻⁵ E) and K0 0.45 ± 0.01 at the end of loading".
std::string end_text(const StageMeans& stage, double modulus) {
  const SiPrefix unit = si_prefix(stage.axial_end->mean);
  const auto mean_text = [](const MeanError& m, double factor) {
    return format_with_error(m.mean / factor, m.n > 1 ? m.error / factor : 0.0);
  };
  return fmt::format(", axial stress {} {}Pa ({} E){} at the end of {}", mean_text(*stage.axial_end, unit.factor),
                     unit.symbol, format_number(stage.axial_end->mean / modulus, 3),
                     stage.lateral_ratio ? " and K0 " + mean_text(*stage.lateral_ratio, 1.0) : "", stage.record.name);
}

std::vector<HeadLine> lines_of(const RunData& run) {
  std::vector<HeadLine> lines;
  const auto summary = run.summary_as<MaterialSummary>();
  for (const MaterialVariantSummary& v : summary.variants) {
    if (v.runs.stages.empty() || !v.solid_fraction_start) continue;
    const StageMeans& last = v.runs.stages.back();
    const double modulus = modulus_of(summary, v);
    std::string text = fmt::format(
        "{} grains with E = {} MPa, mu = {:g}{}, largest over smallest {}; solid fraction {} at the start",
        format_count(v.grains), format_number(1e-6 * modulus), v.friction,
        v.rolling_friction ? fmt::format(", mu_r = {:g}", *v.rolling_friction) : "", format_number(v.size_ratio, 3),
        format_with_error(v.solid_fraction_start->mean, v.solid_fraction_start->error));
    if (v.runs.density) text += "; " + density_text(*v.runs.density);
    if (last.axial_end) text += end_text(last, modulus);
    lines.emplace_back(v.name == "material" ? "Material" : "Material " + v.name, text + ".");
  }
  if (lines.size() > 4) return {{"Material", fmt::format("{} variants.", lines.size())}};
  return lines;
}

/// Curves of the tests of materials. Summaries of other kinds have variants too, which are left out.
std::vector<NamedCurves> tests_of(const RunData& run) {
  std::vector<NamedCurves> out;
  for (const MaterialVariantSummary& v : run.summary_as<MaterialSummary>().variants) {
    if (v.file.empty()) continue;
    if (const auto* curves = run.file(v.file, load_macro)) out.push_back({v.name, *curves});
  }
  if (out.size() == 1) out.front().name.clear();
  return out;
}

std::vector<RunValue> values_of(const RunData& run) {
  const std::vector<NamedCurves> tests = tests_of(run);
  std::vector<RunValue> out;
  if (tests.empty()) return out;
  for (const MaterialVariantSummary& v : run.summary_as<MaterialSummary>().variants) {
    const std::string of = tests.size() > 1 ? " (" + v.name + ")" : "";
    const auto add = [&](const char* what, const std::optional<MeanError>& m) {
      if (m) out.push_back({what + of, "", m->mean, m->error});
    };
    add("solid fraction at the start", v.solid_fraction_start);
    add("coordination number at the start", v.coordination_start);
  }
  const std::vector<RunValue> stresses = stress_values(tests);
  out.insert(out.begin(), stresses.begin(), stresses.end());
  return out;
}

std::vector<RunCurve> curves_of_run(const RunData& run) { return stress_curves(tests_of(run)); }

NextSteps next_of(const RunData&) {
  return {
      "How far from converged: `softgrain run SCENE.toml --seeds 1..8` for the scatter, `softgrain sweep SCENE.toml "
      "--over grains.count=1000,2000,4000` for the size.",
      "A law of this material for larger spans: `softgrain run pipelines/material_law.toml` with the same [material] "
      "and [grains]; models beside it: `softgrain run pipelines/material_vs_models.toml`."};
}

}  // namespace

std::vector<double> mean_stresses(const MacroCurve& c) {
  // Curves that name no stages may not have the stress on each axis.
  const bool each_axis = c.stress_x.size() == c.strain.size() && c.stress_y.size() == c.strain.size();
  std::vector<double> p;
  for (std::size_t k = 0; k < c.strain.size(); ++k)
    p.push_back(each_axis ? (c.stress_x[k] + c.stress_y[k] + c.stress_axial[k]) / 3.0
                          : (2.0 * c.stress_lateral[k] + c.stress_axial[k]) / 3.0);
  return p;
}

KindResults material_results() {
  return {.files = {{.names = "material\\.csv"},
                    {.names = "(material|states_material)(_.+)?\\.h5", .says_so = true},
                    {.names = "lammps-(.+-)?[0-9]+"}},
          .sections = {{Part::tests, material_section}},
          .lines = lines_of,
          .values = values_of,
          .curves = curves_of_run,
          .differences = material_differences,
          .next = next_of};
}

}  // namespace softgrain
