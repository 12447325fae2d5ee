// The reverse search: target and answer, the intervals, and the misfit of every evaluation over each parameter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/text.h"
#include "pipelines/kinds/inverse/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"

namespace softgrain::report {

namespace {

std::string range_text(const std::array<double, 2>& range) {
  return format_number(range[0]) + " .. " + format_number(range[1]);
}

std::string parameter_table(const SearchSummary& search) {
  HtmlTable table({"parameter", "answer", "95 % interval", "error from the curvature", "searched range"});
  for (const FoundParameter& p : search.parameters)
    table.row({p.name, format_number(p.value), range_text(p.interval) + (p.closed ? "" : " (open)"),
               p.standard_error > 0.0 ? format_number(p.standard_error, 2) : "at the end", range_text(p.range)});
  return table.html();
}

/// Evaluations with a misfit, best first.
std::vector<EvaluationSummary> ranked(const SearchSummary& search) {
  std::vector<EvaluationSummary> out = search.evaluations;
  std::erase_if(out, [](const EvaluationSummary& e) { return std::isnan(e.misfit); });
  std::stable_sort(out.begin(), out.end(),
                   [](const EvaluationSummary& a, const EvaluationSummary& b) { return a.misfit < b.misfit; });
  return out;
}

std::string curve_figure(const SearchSummary& search) {
  Plot plot({.id = "inverse-curve",
             .title = "Target and answer",
             .x = {.label = "normal overlap Δ = hn/Rs", .low = 0.0},
             .y = {.label = "normal force Fn [N]"}});
  const std::vector<double>& delta = search.target.delta;
  std::size_t thin = 0;
  for (const EvaluationSummary& e : ranked(search)) {
    Series s{.label = thin == 0 ? "other evaluations" : "", .hover = "evaluation", .x = delta, .y = e.force};
    if (s.y.size() != delta.size() || ++thin > 30) continue;
    s.hover = "misfit " + format_number(e.misfit, 3);
    s.style = {.color = palette::grey, .width = 0.7, .opacity = 0.5};
    s.sets_range = false;
    plot.add(std::move(s));
  }
  const std::vector<double>& mean = search.confirmed.force;
  const std::vector<double>& error = search.confirmed.error;
  if (mean.size() == delta.size() && error.size() == delta.size()) {
    Series band{
        .label = "answer, 95 % of its mean", .hover = "answer, measured with new packings", .x = delta, .y = {}};
    for (std::size_t j = 0; j < delta.size(); ++j) {
      const auto [low, high] = search.confirmed.interval(j);
      band.band_low.push_back(low);
      band.band_high.push_back(high);
    }
    band.style = {.color = palette::blue, .width = 0.0};
    plot.add(std::move(band));
    Series answer{.label = "answer, new packings", .hover = "answer, new packings", .x = delta, .y = mean};
    answer.style = {.color = palette::blue, .width = 2.0};
    plot.add(std::move(answer));
  }
  Series target{.label = "target ± standard error", .hover = "target", .x = delta, .y = search.target.force};
  target.y_error = search.target.error;
  target.style = {.color = palette::black, .width = 0.0, .marker = Marker::circle, .marker_size = 3.2};
  if (target.y.size() == delta.size() && target.y_error.size() == delta.size()) plot.add(std::move(target));
  return figure(plot.svg(), "Grey: evaluations of the search; the pointer shows their misfit.");
}

/// Misfit of all evaluations over one parameter; the interval as a band.
std::string misfit_figure(const SearchSummary& search, std::size_t index) {
  const FoundParameter& parameter = search.parameters[index];
  const std::string& name = parameter.name;
  Plot plot({.id = "inverse-misfit-" + std::to_string(index),
             .title = "Misfit over " + name,
             .x = {.label = name, .scale = parameter.logarithmic ? Scale::logarithmic : Scale::linear},
             .y = {.label = "misfit per point (1: as far as errors go)", .scale = Scale::logarithmic}});
  Series points{.label = "evaluation", .hover = "evaluation", .x = {}, .y = {}};
  double low = INFINITY;
  double high = 0.0;
  for (const EvaluationSummary& e : ranked(search)) {
    if (index >= e.values.size() || !(e.misfit > 0.0)) continue;
    points.x.push_back(e.values[index]);
    points.y.push_back(e.misfit);
    low = std::min(low, e.misfit);
    high = std::max(high, e.misfit);
  }
  if (points.x.empty()) return "";
  Series band{.label = "95 % interval",
              .hover = "95 % interval",
              .x = {parameter.interval.begin(), parameter.interval.end()},
              .y = {}};
  band.band_low.assign(2, low);
  band.band_high.assign(2, high);
  band.style = {.color = palette::sky, .width = 0.0};
  plot.add(std::move(band));
  points.style = {.color = palette::black, .width = 0.0, .marker = Marker::circle, .marker_size = 2.6};
  plot.add(std::move(points));
  Series answer{.label = "answer", .hover = "answer", .x = std::vector(2, parameter.value), .y = {low, high}};
  answer.style = {.color = palette::blue, .width = 1.6, .dash = "5 3"};
  plot.add(std::move(answer));
  return figure(plot.svg(), search.parameters.size() > 1
                                ? "The other parameters differ from point to point: the lower envelope is what counts."
                                : "");
}

std::string correlation_table(const SearchSummary& search) {
  std::vector<std::string> names{""};
  for (const FoundParameter& p : search.parameters) names.push_back(p.name);
  const std::size_t d = names.size() - 1;
  const std::vector<double>& all = search.correlation;
  if (d < 2 || all.size() != d * d) return "";
  HtmlTable table(names);
  for (std::size_t a = 0; a < d; ++a) {
    std::vector<std::string> row{names[a + 1]};
    for (std::size_t b = 0; b < d; ++b) row.push_back(fmt::format("{:.2f}", all[a * d + b]));
    table.row(std::move(row));
  }
  return paragraph(
             "Correlation of the answers over draws: near 1 or -1, the curve does not tell two parameters apart.") +
         table.html();
}

}  // namespace

std::string inverse_section(const RunData& run) {
  const auto summary = run.summary_as<InverseSummary>();
  if (!summary.inverse) return "";
  const SearchSummary& search = *summary.inverse;
  std::string body = paragraph(fmt::format(
      "Which soft particle gives the target curve ({} contact)? {} of {} each, the same random "
      "numbers at every point of the search; misfit per point of the answer, with {} that the search has not "
      "seen: {}.",
      to_string(search.contact), counted(search.evaluations.size(), "evaluation"), counted(search.packings, "packing"),
      counted(search.confirmed.packings, "packing"), format_number(search.confirmed.misfit, 3)));
  body += parameter_table(search);
  std::vector<std::string> figures{curve_figure(search)};
  for (std::size_t k = 0; k < search.parameters.size(); ++k)
    if (std::string one = misfit_figure(search, k); !one.empty()) figures.push_back(std::move(one));
  body += figure_row(figures) + correlation_table(search);
  body += paragraph(
      "Intervals: packings, evaluations and the target (by its errors) are drawn anew and the answer is found again, "
      "widened by Student's t for the number of packings and by every evaluation that is as good (chi² within 3.84 of "
      "the best); the error beside them is from the curvature of the quadratic "
      "surface at the answer alone. The misfit counts errors of target and mean, and a discrepancy of " +
      format_number(100.0 * search.target.discrepancy, 2) + " % of the force.");
  return section("inverse", "The soft particle behind a curve",
                 "The soft particle whose law comes closest to the measured curve, and how well the data determine it.",
                 body);
}

}  // namespace softgrain::report
