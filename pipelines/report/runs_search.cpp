// Where a search found the largest or smallest result: points, fitted curve, optimum.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "common/core/text.h"
#include "common/data/law_words.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {

namespace {

std::string searched_range(double low, double high) {
  return ends_text(low, high, {format_number, 4, " to ", "–", true});
}

/// Means over seeds with their errors.
Series searched_points(const SetSummary& set) {
  Series s{.label = set.seeds.size() > 1 ? "points, mean over seeds" : "points", .hover = "", .x = {}, .y = {}};
  for (const PointEntry& point : set.points)
    for (const NumberOverRuns& n : point.numbers) {
      if (n.name != set.search->number || !std::isfinite(n.mean)) continue;
      std::string text = point.values.at(set.search->keys.front().key);
      std::erase(text, '"');
      s.x.push_back(std::strtod(text.c_str(), nullptr));
      s.y.push_back(n.mean);
      s.y_error.push_back(set.seeds.size() > 1 ? n.error : kNaN);
    }
  s.style = {.color = palette::blue, .width = 0.0, .marker = Marker::circle};
  return s;
}

std::string search_figure(const SetSummary& set) {
  const OptimumSummary& search = *set.search;
  const SearchedKey& key = search.keys.front();
  Plot plot(
      {.id = "search",
       .title = search.number,
       .x = {.label = with_unit(key.key, key.unit), .scale = key.logarithmic ? Scale::logarithmic : Scale::linear},
       .y = {.label = with_unit(search.number, search.unit)},
       .shaded = ShadedRange{key.low, key.high, "95 %"}});
  Series fit{.label = "fitted, 95 %",
             .hover = "",
             .x = search.curve.x,
             .y = search.curve.y,
             .band_low = search.curve.low,
             .band_high = search.curve.high};
  fit.style = {.color = palette::vermillion, .width = 1.8};
  plot.add(std::move(fit));
  plot.add(searched_points(set));
  Series best{.label = "optimum", .hover = "", .x = {key.value}, .y = {search.value}};
  best.style = {.color = palette::black, .width = 0.0, .marker = Marker::diamond, .marker_size = 5.0};
  plot.add(std::move(best));
  return figure(plot.svg(),
                "The surface is fitted to the points nearest to its optimum; shaded: 95 % interval of the optimum.");
}

}  // namespace

std::string search_part(const SetSummary& set) {
  if (!set.search || !set.search->usable) return "";
  const OptimumSummary& s = *set.search;
  HtmlTable table({"key", s.maximise ? "best value (largest)" : "best value (smallest)", "95 %", "range searched"}, 1);
  for (const SearchedKey& key : s.keys)
    table.row({with_unit(key.key, key.unit), format_number(key.value, 4), searched_range(key.low, key.high),
               searched_range(key.from, key.to)});
  std::string text = fmt::format(
      "{} there: {} ({}). {} of {} points are fitted; {} % of the replicates have the optimum inside the range. ",
      with_unit(s.number, s.unit), format_number(s.value, 5), searched_range(s.low, s.high), s.fitted, s.points,
      format_number(100.0 * s.inside, 3));
  text += s.over_seeds ? "Intervals: bootstrap over seeds, which are the same at all points."
                       : "Intervals: bootstrap of the scatter about the surface, with one seed or two.";
  return "<h3>Optimum</h3>\n" + table.html() + paragraph(text) + (s.curve.x.empty() ? "" : search_figure(set));
}

}  // namespace softgrain::report
