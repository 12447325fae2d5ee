// Normal force against overlap: every packing, their mean, the fitted law, the published law and the Hertz line.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "common/core/text.h"
#include "pipelines/compare/compare_inputs.h"
#include "pipelines/kinds/soft_particle/results.h"
#include "pipelines/report/html.h"
#include "pipelines/report/law_curves.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"

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

}  // namespace softgrain::report
