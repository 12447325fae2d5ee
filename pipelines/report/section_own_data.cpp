// A law fitted to measurements of an experiment: the points as measured and the law with its interval.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipelines/law/law_fit.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

constexpr std::array kMarkers{Marker::circle, Marker::square, Marker::triangle, Marker::diamond, Marker::hollow};

/// Samples of one kind as markers; error bars where errors were given.
std::vector<Series> sample_series(const std::vector<DrawnSample>& samples, PairKind kind) {
  std::vector<Series> out;
  for (const DrawnSample& sample : samples) {
    if (sample.kind != kind || sample.delta.size() != sample.force.size()) continue;
    const std::string name = "sample " + sample.name;
    Series s{.label = name, .hover = name, .x = sample.delta, .y = sample.force};
    if (sample.error.size() == s.x.size())
      for (const double e : sample.error) s.y_error.push_back(std::isnan(e) ? 0.0 : e);
    s.style = {.color = palette::cycle(out.size() + 1),
               .width = 0.0,
               .marker = kMarkers[out.size() % kMarkers.size()],
               .marker_size = s.x.size() > 60 ? 1.8 : 2.8};
    out.push_back(std::move(s));
  }
  return out;
}

void add_samples(Plot& plot, const std::vector<DrawnSample>& samples, PairKind kind) {
  constexpr std::size_t kInLegend = 8;
  std::size_t n = 0;
  for (Series& s : sample_series(samples, kind)) {
    if (n++ >= kInLegend) s.label.clear();  // named under the pointer
    plot.add(std::move(s));
  }
}

double force_unit(const SoftParticleSpec& spec) { return spec.youngs_modulus * spec.shell_radius * spec.shell_radius; }

/// "Points as measured", or how many of them are drawn: of every stretch the lowest and the highest.
std::string points_text(const std::vector<DrawnSample>& samples, PairKind kind) {
  std::size_t all = 0;
  std::size_t drawn = 0;
  for (const DrawnSample& sample : samples) {
    if (sample.kind != kind) continue;
    drawn += sample.delta.size();
    all += sample.points.value_or(sample.delta.size());
  }
  if (drawn >= all) return "Points as measured";
  return fmt::format("{} of {} measured points, of every stretch the lowest and the highest force (the fit is to all)",
                     format_count(static_cast<std::int64_t>(drawn)), format_count(static_cast<std::int64_t>(all)));
}

std::string curve_figure(const RunData& run, const std::vector<DrawnSample>& samples, const PairLaw& law) {
  const std::string kind = to_string(law.kind);
  Plot plot({.id = "own-" + kind,
             .title = "Fn(Δ), " + describe(law.kind) + ", as measured",
             .x = {.label = "normal overlap Δ = hn/Rs", .low = 0.0},
             .y = {.label = "normal force Fn [N]"}});
  add_samples(plot, samples, law.kind);
  const double unit = force_unit(run.card->spec);
  add_law(plot, law, LawPart::normal, unit, "fitted law", palette::blue);
  const bool measured = law.points > 0;
  return figure(plot.svg(), measured ? points_text(samples, law.kind) + "; the law is continuous and zero below δ."
                                     : "No points: this law follows from the other kind by symmetry.");
}

/// Distance of every point from the law: what the law does not say shows here first.
std::string residual_figure(const RunData& run, const std::vector<DrawnSample>& samples, const PairLaw& law) {
  const std::string kind = to_string(law.kind);
  Plot plot({.id = "own-residual-" + kind,
             .title = "Measured force minus law",
             .x = {.label = "normal overlap Δ = hn/Rs", .low = 0.0},
             .y = {.label = "Fn - law [N]"}});
  const double unit = force_unit(run.card->spec);
  Series zero{.label = "", .hover = "law", .x = {0.0, law.delta_max}, .y = {0.0, 0.0}};
  zero.style = {.color = palette::blue, .width = 1.2};
  plot.add(std::move(zero));
  for (Series& s : sample_series(samples, law.kind)) {
    for (std::size_t k = 0; k < s.x.size(); ++k) s.y[k] -= unit * law.normal.value(s.x[k]);
    s.label.clear();
    plot.add(std::move(s));
  }
  return figure(plot.svg(), "Points scattered evenly about zero: the form of the law holds. A pattern: it does not.");
}

}  // namespace

std::string own_data_section(const RunData& run) {
  const auto summary = run.summary_as<ExperimentSummary>();
  if (summary.experiment.empty() || !run.card) return "";
  std::string body;
  for (const PairLaw& law : run.card->pairs) {
    std::vector<std::string> figures{curve_figure(run, summary.experiment, law)};
    if (law.points > 0 && has_part(law, LawPart::normal))
      figures.push_back(residual_figure(run, summary.experiment, law));
    body += "<h3>" + escape(describe(law.kind)) + "</h3>\n" + figure_row(figures);
  }
  body += paragraph(fmt::format(
      "Measured outside, made dimensionless with Rs = {} m and E = {} Pa. 95 % intervals: {}.",
      format_number(run.card->spec.shell_radius), format_number(run.card->spec.youngs_modulus), summary.intervals));
  return section("own-data", "Measured curves", "The measured curves as they were read, and the law fitted to them.",
                 body);
}

}  // namespace softgrain::report
