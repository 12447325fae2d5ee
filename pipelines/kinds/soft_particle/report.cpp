// Measured soft particles in the report. Normal force against overlap: every packing, their mean, the fitted law, the
// published law and the Hertz line. Two relaxations of the same packings side by side: means, their ratio, and what a
// point costs. Then what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/law_card_format.h"
#include "pipelines/compare/compare_inputs.h"
#include "pipelines/compare/compare_measurements.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/report/html.h"
#include "pipelines/report/law_curves.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain::report {

namespace {

double force_scale(const SoftParticleSpec& spec) { return spec.youngs_modulus * spec.shell_radius * spec.shell_radius; }

/// Text on how the soft particle differs from the published one; empty: not at all. E and Rs, which scale, and the
/// packing method, which was not published, are left out.
std::string unlike_published(const SoftParticleSpec& spec) {
  namespace law = published_soft_solid;
  SoftParticleSpec published = spec;
  published.poisson_ratio = law::poisson_ratio;
  published.friction = law::friction;
  published.exponent = law::exponent;
  published.polydispersity = law::polydispersity;
  return join_text(differences(spec, published).obstacles, "; ");
}

void add_reference_curves(Plot& plot, const SoftParticleSpec& spec, PairKind kind, double last) {
  const auto overlaps = spread(0.0, last, 161);
  Series hertz{.label = "solid grain of radius Rs (Hertz)", .hover = "", .x = overlaps, .y = {}};
  for (const double d : overlaps) hertz.y.push_back(hertz_force(d, spec, kind));
  hertz.style = {.color = palette::green, .width = 1.6, .dash = "2 3"};
  hertz.sets_range = false;
  plot.add(std::move(hertz));
  if (kind != PairKind::soft_solid) return;
  Series published{.label = unlike_published(spec).empty() ? "published law" : "published law (another soft particle)",
                   .hover = "published law, scaled by E Rs²",
                   .x = overlaps,
                   .y = {}};
  for (const double d : overlaps) published.y.push_back(published_normal_force(d, spec));
  published.style = {.color = palette::vermillion, .width = 1.8, .dash = "7 4"};
  published.sets_range = false;
  plot.add(std::move(published));
}

/// Points whose relaxation did not reach its own criterion.
Series unconverged(const std::vector<const PackingRun*>& runs) {
  Series s{.label = "point not converged", .hover = "not converged", .x = {}, .y = {}};
  for (const PackingRun* r : runs) {
    for (const NormalPoint& p : r->normal) {
      if (p.converged) continue;
      s.x.push_back(p.delta);
      s.y.push_back(p.force);
    }
  }
  s.style = {.color = palette::purple, .width = 0.0, .marker = Marker::hollow, .marker_size = 2.6};
  return s;
}

/// Lower end of the logarithmic axis: single packings reach down to the noise, which says nothing.
std::optional<double> least_shown(const ValuesByDelta& forces) {
  constexpr double kShown = 1e-4;
  const Series mean = mean_series(forces, 1.0, "", {});
  const double largest = mean.y.empty() ? 0.0 : *std::max_element(mean.y.begin(), mean.y.end());
  return largest > 0.0 ? std::optional(kShown * largest) : std::nullopt;
}

std::string force_figure(const RunData& run, PairKind kind, Scale scale) {
  const Measurements& data = *run.measurements;
  const auto runs = runs_of(data, kind, run.relaxation(kind));
  const auto forces = normal_forces(runs);
  const bool linear = scale == Scale::linear;
  // the logarithmic axis has room for the Hertz line, the linear one keeps to the measured forces
  const auto top = linear ? std::nullopt : std::optional(1.5 * hertz_force(last_delta(forces), data.spec, kind));
  PlotOptions options{.id = "normal-" + to_string(kind) + (linear ? "-linear" : "-log"),
                      .title = "Fn(Δ), " + describe(kind) + (linear ? "" : ", logarithmic"),
                      .x = {},
                      .y = {.label = "normal force Fn [N]",
                            .scale = scale,
                            .low = linear ? std::nullopt : least_shown(forces),
                            .high = top}};
  options.x = overlap_axis(last_delta(forces));
  options.shaded = fitted_range(run.law(kind), LawPart::normal);
  Plot plot(std::move(options));
  for (Series& s : packing_series(data, forces, 1.0, fmt::format("one packing ({})", runs.size())))
    plot.add(std::move(s));
  if (const PairLaw* law = run.law(kind))
    add_law(plot, *law, LawPart::normal, force_scale(data.spec), "fitted law", palette::blue);
  add_reference_curves(plot, data.spec, kind, last_delta(forces));
  Series failed = unconverged(runs);
  if (!failed.x.empty()) plot.add(std::move(failed));
  plot.add(mean_series(forces, 1.0, "mean ± standard error",
                       {.color = palette::black, .width = 0.0, .marker = Marker::circle, .marker_size = 3.2}));
  return figure(plot.svg(),
                linear ? "Grey: every packing. Shaded: where the law was fitted; dotted: what it does beyond."
                       : "The same data with a logarithmic force axis: the start of the force near the threshold.");
}

std::string kind_body(const RunData& run, PairKind kind) {
  const std::string relaxation = run.relaxation(kind);
  if (relaxation.empty()) return "";
  const auto runs = runs_of(*run.measurements, kind, relaxation);
  if (normal_forces(runs).empty()) return "";
  return "<h3>" + escape(describe(kind) + ", relaxation \"" + relaxation + "\"") + "</h3>\n" +
         figure_row({force_figure(run, kind, Scale::linear), force_figure(run, kind, Scale::logarithmic)});
}

std::string published_note(const SoftParticleSpec& spec) {
  namespace law = published_soft_solid;
  std::string scaled = spec.youngs_modulus == law::youngs_modulus && spec.shell_radius == law::shell_radius
                           ? "which are those of this run."
                           : "drawn here scaled by E Rs² to this run's E and Rs.";
  const std::string others = unlike_published(spec);
  if (!others.empty())
    scaled +=
        " It is of another soft particle than this run's, and the two need not agree (here against there: " + others +
        ").";
  return paragraph(
      fmt::format("Published law (soft-solid): Fn = a Δ^b + c above Δ = δ, with a = {} N, b = {}, c = {} N, δ = {}, "
                  "for E = 5×10⁵ Pa and Rs = 0.016 m, {} "
                  "The Hertz line is a solid grain of radius Rs of the grains' material at the same overlap.",
                  law::a, law::b, format_number(law::c), law::delta, scaled));
}

}  // namespace

std::string normal_section(const RunData& run) {
  if (!run.measurements) return "";
  std::string body;
  for (const PairKind kind : kPairKinds) body += kind_body(run, kind);
  return body.empty() ? ""
                      : section("normal", "Normal force",
                                "Normal force against overlap: points are means over packings, the line is the fitted "
                                "law, where there is one.",
                                body + published_note(run.measurements->spec));
}

namespace {

/// Means of one side.
Series side_series(const std::vector<RatioRow>& rows, bool candidate, const std::string& name) {
  Series s{.label = name + ", mean ± standard error", .hover = name, .x = {}, .y = {}};
  for (const RatioRow& row : rows) {
    const MeanError& m = candidate ? row.candidate : row.reference;
    s.x.push_back(row.delta);
    s.y.push_back(m.mean);
    s.y_error.push_back(m.error);
  }
  s.style = candidate
                ? SeriesStyle{.color = palette::blue, .width = 1.4, .marker = Marker::circle}
                : SeriesStyle{.color = palette::vermillion, .width = 1.4, .dash = "6 3", .marker = Marker::square};
  return s;
}

Series ratio_series(const std::vector<RatioRow>& rows, const std::string& label, const char* color, Marker marker) {
  Series s{.label = label, .hover = "", .x = {}, .y = {}};
  for (const RatioRow& row : rows) {
    s.x.push_back(row.delta);
    s.y.push_back(row.ratio.ratio);
    s.y_error.push_back(row.ratio.error);
  }
  s.style = {.color = color, .width = 1.2, .marker = marker};
  return s;
}

std::string means_figure(const RelaxationComparison& c) {
  Plot plot({.id = "relaxations-" + to_string(c.kind) + "-means",
             .title = "Fn(Δ) of both relaxations, " + to_string(c.kind),
             .x = {.label = "normal overlap Δ = hn/Rs", .low = 0.0},
             .y = {.label = "normal force Fn [N]", .scale = Scale::logarithmic}});
  plot.add(side_series(c.normal, false, c.reference));
  plot.add(side_series(c.normal, true, c.candidate));
  return figure(plot.svg(), "Packings that both relaxations measured.");
}

std::string ratio_figure(const RelaxationComparison& c) {
  Plot plot({.id = "relaxations-" + to_string(c.kind) + "-ratio",
             .title = "Ratio " + c.candidate + " / " + c.reference + ", " + to_string(c.kind),
             .x = {.label = "normal overlap Δ = hn/Rs", .low = 0.0},
             .y = {.label = "ratio of means"}});
  const double last = c.normal.empty() ? 1.0 : 1.1 * c.normal.back().delta;
  plot.add({.label = "",
            .hover = "equal",
            .x = {0.0, last},
            .y = {1.0, 1.0},
            .style = {.color = palette::black, .width = 1.0, .dash = "3 3"}});
  plot.add(ratio_series(c.normal, "normal force", palette::blue, Marker::circle));
  if (!c.stiffness_initial.empty())
    plot.add(ratio_series(c.stiffness_initial, "kt, initial slope", palette::vermillion, Marker::square));
  if (!c.stiffness_secant.empty())
    plot.add(ratio_series(c.stiffness_secant, "kt, secant", palette::green, Marker::triangle));
  return figure(plot.svg(), "Error bars: jackknife over packings.");
}

std::string mean_text(const MeanError& m) { return format_with_error(m.mean, m.error); }

void add_rows(HtmlTable& table, const std::string& quantity, const std::vector<RatioRow>& rows) {
  for (const RatioRow& row : rows) {
    table.row({quantity, format_fixed(row.delta, 3), format_count(static_cast<std::int64_t>(row.reference.n)),
               mean_text(row.reference), mean_text(row.candidate),
               format_with_error(row.ratio.ratio, row.ratio.error)});
  }
}

std::string ratio_table(const RelaxationComparison& c) {
  HtmlTable table({"quantity", "Δ", "packings", c.reference, c.candidate, "ratio"});
  add_rows(table, "Fn [N]", c.normal);
  add_rows(table, "kt initial [N/m]", c.stiffness_initial);
  add_rows(table, "kt secant [N/m]", c.stiffness_secant);
  return table.html();
}

void add_cost_row(HtmlTable& table, const std::string& points, const std::string& name, const PointCost& cost,
                  const PointCost& reference) {
  if (cost.points == 0) return;
  table.row({points, name, format_count(cost.points), format_count(std::llround(cost.loop_passes)),
             format_count(std::llround(cost.contact_evaluations)), format_number(cost.seconds, 3),
             format_number(reference.seconds / cost.seconds, 3)});
}

std::string cost_table(const RelaxationComparison& c) {
  HtmlTable table({"points", "relaxation", "number", "loop passes per point", "contact evaluations per point",
                   "seconds per point", "speed-up"},
                  2);
  add_cost_row(table, "normal", c.reference, c.reference_normal_cost, c.reference_normal_cost);
  add_cost_row(table, "normal", c.candidate, c.candidate_normal_cost, c.reference_normal_cost);
  add_cost_row(table, "tangential", c.reference, c.reference_tangential_cost, c.reference_tangential_cost);
  add_cost_row(table, "tangential", c.candidate, c.candidate_tangential_cost, c.reference_tangential_cost);
  return table.html();
}

/// The reference is the published relaxation when it is there; the candidate is the first other one.
std::string relaxations_of(const RunData& run, PairKind kind) {
  const auto names = relaxations_of(*run.measurements, kind);
  if (names.size() < 2) return "";
  const bool published = std::find(names.begin(), names.end(), "published") != names.end();
  const std::string reference = published ? "published" : names[0];
  const std::string candidate = names[0] == reference ? names[1] : names[0];
  try {
    const auto c = compare_relaxations(*run.measurements, reference, candidate, kind, run.angles(kind));
    return "<h3>" + escape(describe(kind)) + "</h3>\n" + figure_row({means_figure(c), ratio_figure(c)}) +
           ratio_table(c) + cost_table(c);
  } catch (const InputError& error) {
    return paragraph(error.what());
  }
}

}  // namespace

std::string relaxations_section(const RunData& run) {
  if (!run.measurements) return "";
  std::string body;
  for (const PairKind kind : kPairKinds) body += relaxations_of(run, kind);
  return section("relaxations", "Relaxation protocols compared",
                 "The same packings relaxed by two protocols, and how far their forces differ.", body);
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

using namespace report;

void check_measurements_file(const std::string& path, Findings& out) {
  const Measurements data = load_measurements(path);
  std::size_t open = 0;
  for (const PackingRun& run : data.runs) {
    open += static_cast<std::size_t>(
        std::count_if(run.normal.begin(), run.normal.end(), [](const NormalPoint& p) { return !p.converged; }));
    open += static_cast<std::size_t>(std::count_if(run.tangential.begin(), run.tangential.end(),
                                                   [](const TangentialPoint& p) { return !p.converged; }));
  }
  out.add(
      "kind", "measurements",
      fmt::format("measurements: {}, {}", counted(data.packings.size(), "packing"), counted(data.runs.size(), "run")));
  if (open > 0) out.warn(fmt::format("left out of fits: {} did not converge", counted(open, "recorded point")));
}

std::string measured_line(const Measurements& data) {
  std::size_t points = 0;
  std::vector<double> fraction;
  for (const PackingRun& r : data.runs) points += r.normal.size() + r.tangential.size();
  for (const PackingInfo& p : data.packings) fraction.push_back(p.solid_fraction);
  const MeanError m = mean_error(fraction);
  return fmt::format("{} at solid fraction {}, {} relaxed states.", counted(data.packings.size(), "packing"),
                     format_with_error(m.mean, m.error), format_count(static_cast<std::int64_t>(points)));
}

std::string law_line(const PairLaw& law, const SoftParticleSpec& spec) {
  if (law.status != LawStatus::good || !has_part(law, LawPart::normal))
    return fmt::format("{}: {}{}", to_string(law.kind), to_string(law.status),
                       law.reason.empty() ? "." : ": " + law.reason);
  const double force = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const ThresholdPowerLaw& n = law.normal;
  return fmt::format("{}: Fn = a Δ^b + c above δ; a = {} N, b = {}, c = {} N, δ = {}; fitted for Δ = {} to {}.",
                     to_string(law.kind), format_with_error(n.a.value * force, n.a.standard_error * force),
                     format_with_error(n.b.value, n.b.standard_error), format_number(n.c.value * force, 2),
                     format_with_error(n.delta.value, n.delta.standard_error), format_number(law.delta_min),
                     format_number(law.delta_max));
}

std::vector<HeadLine> lines_of(const RunData& run) {
  std::vector<HeadLine> lines;
  if (run.measurements) lines.emplace_back("Measured", measured_line(*run.measurements));
  if (run.card)
    for (const PairLaw& law : run.card->pairs) lines.emplace_back("Single-contact law", law_line(law, run.card->spec));
  return lines;
}

/// Measured forces of the relaxation that the law comes from.
ValuesByDelta measured_forces(const RunData& run, PairKind kind) {
  const std::string relaxation = run.relaxation(kind);
  return relaxation.empty() ? ValuesByDelta{} : normal_forces(runs_of(*run.measurements, kind, relaxation));
}

std::vector<double> of_packings(const std::map<std::int64_t, double>& by_packing) {
  std::vector<double> out;
  for (const auto& [ignored, value] : by_packing) out.push_back(value);
  return out;
}

/// The force at the largest overlap, and where it begins.
std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  for (const PairKind kind : kPairKinds) {
    const ValuesByDelta forces = measured_forces(run, kind);
    if (!forces.empty()) {
      const MeanError m = mean_error(of_packings(forces.rbegin()->second));
      out.push_back({fmt::format("Fn at Delta = {:g} ({})", key_delta(forces.rbegin()->first), to_string(kind)), "N",
                     m.mean, m.error});
    }
    if (const PairLaw* law = run.law(kind))
      out.push_back({fmt::format("threshold delta ({})", to_string(kind)), "", law->normal.delta.value,
                     law->normal.delta.standard_error});
  }
  return out;
}

std::vector<RunCurve> curves_of_run(const RunData& run) {
  std::vector<RunCurve> out;
  for (const PairKind kind : kPairKinds) {
    RunCurve curve{"Normal force", "overlap Delta = hn/Rs", "normal force Fn", "N", to_string(kind), {}, {}};
    for (const auto& [key, by_packing] : measured_forces(run, kind)) {
      curve.x.push_back(key_delta(key));
      curve.y.push_back(mean_error(of_packings(by_packing)).mean);
    }
    if (!curve.x.empty()) out.push_back(std::move(curve));
  }
  return out;
}

NextSteps next_of(const RunData& run) {
  return {
      "Fit a law to it: `softgrain calibrate " + run.directory + "/measurements.h5`.",
      "Whether more packings or overlaps are needed shows in its intervals; other grains: `softgrain sweep SCENE.toml "
      "--over material.mu=0.1,0.3,0.5`."};
}

void check_card_table(const std::string& path, Findings& out) {
  check_table(path);
  out.add("kind", "law card values", "measured curves and bands of a law card");
}

}  // namespace

KindResults soft_particle_results() {
  return {.files = {{.names = "measurements\\.h5",
                     .is = [](const h5::Group& root) { return root.has("runs") && !root.has("configurations"); },
                     .check = check_measurements_file},
                    {.names = "law\\.h5",
                     .is =
                         [](const h5::Group& root) {
                           return root.has_attribute("format") && root.text("format") == kLawFormat;
                         },
                     .check = check_card_table},
                    {.names = "states_measurements\\.h5"}},
          .sections = {{Part::measurements, normal_section},
                       {Part::measurements, tangential_section},
                       {Part::measurements, stiffness_section},
                       {Part::methods, relaxations_section}},
          .lines = lines_of,
          .values = values_of,
          .curves = curves_of_run,
          .next = next_of};
}

}  // namespace softgrain
