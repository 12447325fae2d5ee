// What the kinds say of a run directory, and every curve of several runs, in one drawing for each kind of curve.
#include "pipelines/report/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/results/kind_results.h"

namespace softgrain::report {

std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  for (const KindResults& kind : results_of_kinds()) {
    if (kind.values == nullptr) continue;
    for (RunValue& v : kind.values(run))
      if (std::isfinite(v.value)) out.push_back(std::move(v));
  }
  return out;
}

std::vector<RunCurve> curves_of(const std::string& directory) {
  const RunData run = load_run(directory);
  std::vector<RunCurve> out;
  for (const KindResults& kind : results_of_kinds()) {
    if (kind.curves == nullptr) continue;
    std::vector<RunCurve> more = kind.curves(run);
    std::move(more.begin(), more.end(), std::back_inserter(out));
  }
  return out;
}

static constexpr std::size_t kColours = 7;  ///< before dashes tell curves apart

SeriesStyle run_style(std::size_t index, bool one_of_many) {
  return {.color = palette::cycle(index),
          .width = one_of_many ? 0.8 : 1.6,
          .dash = index < kColours ? "" : "6 3",
          .opacity = one_of_many ? 0.55 : 1.0,
          .marker = one_of_many ? Marker::none : Marker::circle,
          .marker_size = 2.2};
}

namespace {

/// A curve and the run that it is of.
struct CurveOfRun {
  std::size_t run = 0;
  RunCurve curve;
};

struct CurvePlot {
  std::string title;
  std::vector<CurveOfRun> curves;
};

/// Whether there is nothing of a run that can be shown: it crashed, or was refused on its way.
bool left_nothing(const RunEntry& run, const std::filesystem::path& directory) {
  std::error_code ignored;
  return run.status != RunStatus::good && !std::filesystem::exists(directory / "summary.json", ignored);
}

/// Curves of all runs whose directories exist, grouped by the plot that they belong to.
std::vector<CurvePlot> plots_of(const RunData& run, const SetSummary& set) {
  std::vector<CurvePlot> plots;
  for (std::size_t k = 0; k < set.runs.size(); ++k) {
    const std::filesystem::path directory = std::filesystem::path(run.directory) / set.runs[k].directory;
    std::error_code ignored;
    if (!std::filesystem::is_directory(directory, ignored) || left_nothing(set.runs[k], directory)) continue;
    for (RunCurve& curve : curves_of(directory.string())) {
      const std::string title = curve.plot + (curve.name.empty() ? "" : ", " + curve.name);
      auto at = std::find_if(plots.begin(), plots.end(), [&](const CurvePlot& p) { return p.title == title; });
      if (at == plots.end()) at = plots.insert(plots.end(), {title, {}});
      at->curves.push_back({k, std::move(curve)});
    }
  }
  return plots;
}

/// Runs of one choice of values share a colour.
std::size_t point_of(const SetSummary& set, const RunEntry& run) {
  const auto at =
      std::find_if(set.points.begin(), set.points.end(), [&](const PointEntry& p) { return p.values == run.values; });
  return static_cast<std::size_t>(at - set.points.begin());
}

/// Mean of curves with the same abscissae, and a band of one standard deviation; nothing where they differ.
std::optional<Series> mean_of(const std::vector<const RunCurve*>& curves, double unit) {
  if (curves.size() < 2) return std::nullopt;
  const std::vector<double>& x = curves.front()->x;
  for (const RunCurve* c : curves) {
    if (c->x.size() != x.size()) return std::nullopt;
    for (std::size_t k = 0; k < x.size(); ++k)
      if (std::abs(c->x[k] - x[k]) > 1e-6 * std::abs(x.back() - x.front())) return std::nullopt;
  }
  Series s{.label = "", .hover = "", .x = x, .y = {}};
  for (std::size_t k = 0; k < x.size(); ++k) {
    std::vector<double> values;
    for (const RunCurve* c : curves) values.push_back(c->y[k] / unit);
    const MeanError m = mean_error(values);
    s.y.push_back(m.mean);
    s.band_low.push_back(m.mean - m.deviation);
    s.band_high.push_back(m.mean + m.deviation);
  }
  return s;
}

void add_means(Plot& plot, const SetSummary& set, const CurvePlot& of, double unit) {
  for (std::size_t p = 0; p < set.points.size(); ++p) {
    std::vector<const RunCurve*> curves;
    for (const CurveOfRun& one : of.curves)
      if (point_of(set, set.runs[one.run]) == p && set.runs[one.run].status == RunStatus::good)
        curves.push_back(&one.curve);
    auto mean = mean_of(curves, unit);
    if (!mean) continue;
    mean->label = set.points.size() > 1 ? set.points[p].name : "mean, and one standard deviation between seeds";
    mean->group = mean->label;
    mean->style = run_style(p, false);
    plot.add(std::move(*mean));
  }
}

std::string curve_figure(const SetSummary& set, const CurvePlot& of, std::size_t number) {
  double largest = 0.0;
  for (const CurveOfRun& one : of.curves)
    for (const double y : one.curve.y)
      if (std::isfinite(y)) largest = std::max(largest, std::abs(y));
  const RunCurve& first = of.curves.front().curve;
  const SiPrefix prefix = first.y_unit.empty() ? SiPrefix{} : si_prefix(largest);
  Plot plot(
      {.id = fmt::format("runs-{}", number),
       .title = of.title,
       .x = {.label = first.x_label},
       .y = {.label = first.y_unit.empty() ? first.y_label : first.y_label + " [" + prefix.symbol + first.y_unit + "]"},
       .width = 760.0,
       .height = 420.0});
  const bool seeds = set.seeds.size() > 1;
  for (const CurveOfRun& one : of.curves) {
    const RunEntry& run = set.runs[one.run];
    const std::size_t colour = set.points.empty() ? one.run : point_of(set, run);
    Series s{.label = seeds ? "" : run.name, .hover = run.name, .x = one.curve.x, .y = one.curve.y};
    for (double& y : s.y) y /= prefix.factor;
    s.style = run_style(colour, seeds);
    if (run.status != RunStatus::good) s.style.dash = "1 3", s.hover += " (" + to_string(run.status) + ")";
    if (seeds && set.points.size() > 1) s.group = set.points[colour].name;
    plot.add(std::move(s));
  }
  if (seeds) add_means(plot, set, of, prefix.factor);
  return figure(plot.svg(), seeds
                                ? "Thin: single runs; thick: their mean, with a band of one standard deviation between "
                                  "them. Means over the samples of each run."
                                : "One curve per run, the mean over its samples.");
}

}  // namespace

std::vector<std::string> run_curve_figures(const RunData& run, const SetSummary& set) {
  std::vector<std::string> figures;
  for (const CurvePlot& plot : plots_of(run, set)) figures.push_back(curve_figure(set, plot, figures.size()));
  return figures;
}

}  // namespace softgrain::report
