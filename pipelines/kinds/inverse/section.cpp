// The reverse search: target and answer, the intervals, and the misfit of every evaluation over each parameter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/statistics.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

using nlohmann::json;

double number_at(const json& entry, const std::string& path) { return find_number(entry, path).value_or(NAN); }

std::vector<double> list_at(const json& entry, const std::string& path) {
  std::vector<double> out;
  const json* list = find_value(entry, path);
  if (list == nullptr || !list->is_array()) return out;
  for (const json& x : *list) out.push_back(x.is_number() ? x.get<double>() : NAN);
  return out;
}

const json& entries_at(const json& entry, const char* key) {
  static const json none = json::array();
  const json* list = find_value(entry, key);
  return list != nullptr && list->is_array() ? *list : none;
}

std::string parameter_table(const json& inverse) {
  HtmlTable table({"parameter", "answer", "95 % interval", "error from the curvature", "searched range"});
  for (const json& p : entries_at(inverse, "parameters")) {
    const std::vector<double> interval = list_at(p, "interval");
    const std::vector<double> range = list_at(p, "range");
    if (interval.size() != 2 || range.size() != 2) continue;
    const bool closed = find_text(p, "closed") == "true";
    table.row({find_text(p, "name"), format_number(number_at(p, "value")),
               format_number(interval[0]) + " .. " + format_number(interval[1]) + (closed ? "" : " (open)"),
               number_at(p, "standard_error") > 0.0 ? format_number(number_at(p, "standard_error"), 2) : "at the end",
               format_number(range[0]) + " .. " + format_number(range[1])});
  }
  return table.html();
}

/// Evaluations by misfit, best first.
std::vector<const json*> ranked(const json& inverse) {
  std::vector<const json*> out;
  for (const json& e : entries_at(inverse, "evaluations"))
    if (find_number(e, "misfit")) out.push_back(&e);
  std::stable_sort(out.begin(), out.end(),
                   [](const json* a, const json* b) { return number_at(*a, "misfit") < number_at(*b, "misfit"); });
  return out;
}

std::string curve_figure(const json& inverse) {
  Plot plot({.id = "inverse-curve",
             .title = "Target and answer",
             .x = {.label = "normal overlap Δ = hn/Rs", .low = 0.0},
             .y = {.label = "normal force Fn [N]"}});
  const std::vector<double> delta = list_at(inverse, "target.delta");
  std::size_t thin = 0;
  for (const json* e : ranked(inverse)) {
    Series s{
        .label = thin == 0 ? "other evaluations" : "", .hover = "evaluation", .x = delta, .y = list_at(*e, "force")};
    if (s.y.size() != delta.size() || ++thin > 30) continue;
    s.hover = "misfit " + format_number(number_at(*e, "misfit"), 3);
    s.style = {.color = palette::grey, .width = 0.7, .opacity = 0.5};
    s.sets_range = false;
    plot.add(std::move(s));
  }
  const std::vector<double> mean = list_at(inverse, "confirmed.force");
  const std::vector<double> error = list_at(inverse, "confirmed.error");
  if (mean.size() == delta.size() && error.size() == delta.size()) {
    Series band{
        .label = "answer, 95 % of its mean", .hover = "answer, measured with new packings", .x = delta, .y = {}};
    for (std::size_t j = 0; j < delta.size(); ++j) {
      band.band_low.push_back(mean[j] - kNormal95 * error[j]);
      band.band_high.push_back(mean[j] + kNormal95 * error[j]);
    }
    band.style = {.color = palette::blue, .width = 0.0};
    plot.add(std::move(band));
    Series answer{.label = "answer, new packings", .hover = "answer, new packings", .x = delta, .y = mean};
    answer.style = {.color = palette::blue, .width = 2.0};
    plot.add(std::move(answer));
  }
  Series target{
      .label = "target ± standard error", .hover = "target", .x = delta, .y = list_at(inverse, "target.force")};
  target.y_error = list_at(inverse, "target.error");
  target.style = {.color = palette::black, .width = 0.0, .marker = Marker::circle, .marker_size = 3.2};
  if (target.y.size() == delta.size() && target.y_error.size() == delta.size()) plot.add(std::move(target));
  return figure(plot.svg(), "Grey: evaluations of the search; the pointer shows their misfit.");
}

/// Misfit of all evaluations over one parameter; the interval as a band.
std::string misfit_figure(const json& inverse, const json& parameter, std::size_t index) {
  const std::string name = find_text(parameter, "name");
  const bool logarithmic = find_text(parameter, "logarithmic") == "true";
  Plot plot({.id = "inverse-misfit-" + std::to_string(index),
             .title = "Misfit over " + name,
             .x = {.label = name, .scale = logarithmic ? Scale::logarithmic : Scale::linear},
             .y = {.label = "misfit per point (1: as far as errors go)", .scale = Scale::logarithmic}});
  Series points{.label = "evaluation", .hover = "evaluation", .x = {}, .y = {}};
  double low = INFINITY;
  double high = 0.0;
  for (const json* e : ranked(inverse)) {
    const std::vector<double> values = list_at(*e, "values");
    const double misfit = number_at(*e, "misfit");
    if (index >= values.size() || !(misfit > 0.0)) continue;
    points.x.push_back(values[index]);
    points.y.push_back(misfit);
    low = std::min(low, misfit);
    high = std::max(high, misfit);
  }
  if (points.x.empty()) return "";
  const std::vector<double> interval = list_at(parameter, "interval");
  if (interval.size() == 2) {
    Series band{.label = "95 % interval", .hover = "95 % interval", .x = interval, .y = {}};
    band.band_low.assign(2, low);
    band.band_high.assign(2, high);
    band.style = {.color = palette::sky, .width = 0.0};
    plot.add(std::move(band));
  }
  points.style = {.color = palette::black, .width = 0.0, .marker = Marker::circle, .marker_size = 2.6};
  plot.add(std::move(points));
  Series answer{
      .label = "answer", .hover = "answer", .x = std::vector(2, number_at(parameter, "value")), .y = {low, high}};
  answer.style = {.color = palette::blue, .width = 1.6, .dash = "5 3"};
  plot.add(std::move(answer));
  return figure(plot.svg(), entries_at(inverse, "parameters").size() > 1
                                ? "The other parameters differ from point to point: the lower envelope is what counts."
                                : "");
}

std::string correlation_table(const json& inverse) {
  std::vector<std::string> names{""};
  for (const json& p : entries_at(inverse, "parameters")) names.push_back(find_text(p, "name"));
  const std::size_t d = names.size() - 1;
  const std::vector<double> all = list_at(inverse, "correlation");
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
  const json* found = find_value(run.summary, "inverse");
  if (found == nullptr || !found->is_object()) return "";
  const json& inverse = *found;
  std::string body = paragraph(fmt::format(
      "Which soft particle gives the target curve ({} contact)? {} evaluations of {} packings each, the same random "
      "numbers at every point of the search; misfit per point of the answer, with {} packings that the search has not "
      "seen: {}.",
      find_text(inverse, "contact"), entries_at(inverse, "evaluations").size(), find_text(inverse, "packings"),
      find_text(inverse, "confirmed.packings"), format_number(number_at(inverse, "confirmed.misfit"), 3)));
  body += parameter_table(inverse);
  std::vector<std::string> figures{curve_figure(inverse)};
  std::size_t index = 0;
  for (const json& p : entries_at(inverse, "parameters"))
    if (std::string one = misfit_figure(inverse, p, index++); !one.empty()) figures.push_back(std::move(one));
  body += figure_row(figures) + correlation_table(inverse);
  body += paragraph(
      "Intervals: packings, evaluations and the target (by its errors) are drawn anew and the answer is found again, "
      "widened by Student's t for the number of packings and by every evaluation that is as good (chi² within 3.84 of "
      "the best); the error beside them is from the curvature of the quadratic "
      "surface at the answer alone. The misfit counts errors of target and mean, and a discrepancy of " +
      format_number(100.0 * number_at(inverse, "discrepancy"), 2) + " % of the force.");
  return section("inverse", "The soft particle behind a curve", body);
}

}  // namespace softgrain::report
