#include "pipelines/report/figure_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/text.h"
#include "pipelines/report/html.h"
#include "pipelines/report/svg_draw.h"

namespace softgrain::report {

namespace {

// The script of the page (assets/report.js) makes the same table from what the page holds: change both.
constexpr const char* kCurveColumn = "curve";

struct OptionalColumn {
  const char* name;
  std::vector<double> Series::*values;
};

constexpr std::array<OptionalColumn, 3> kOptionalColumns{
    {{"error bar", &Series::y_error}, {"band low", &Series::band_low}, {"band high", &Series::band_high}}};

constexpr const char* kTableBegin = "<metadata class=\"table\">";
constexpr const char* kTableEnd = "</metadata>\n";

/// " [N]" of "normal force Fn [N]".
std::string unit_of_label(const std::string& label) {
  const std::size_t begin = label.find('[');
  const std::size_t end = label.find(']', begin == std::string::npos ? 0 : begin);
  return begin == std::string::npos || end == std::string::npos ? "" : " " + label.substr(begin, end - begin + 1);
}

std::string number_cell(const std::vector<double>& values, std::size_t row) {
  return row < values.size() && std::isfinite(values[row]) ? fmt::format("{}", values[row]) : "";
}

}  // namespace

std::string curve_table(const PlotOptions& options, const std::vector<Series>& series) {
  std::vector<OptionalColumn> columns;
  for (const OptionalColumn& c : kOptionalColumns)
    if (std::ranges::any_of(series, [&](const Series& s) { return !(s.*c.values).empty(); })) columns.push_back(c);
  TextTable table{{options.title, kCurveColumn, options.x.label, options.y.label}, {}};
  for (const OptionalColumn& c : columns) table.header.push_back(c.name + unit_of_label(options.y.label));
  for (const Series& s : series) {
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      table.rows.push_back({svg::entry_of(s), svg::hover_of(s), number_cell(s.x, i), number_cell(s.y, i)});
      for (const OptionalColumn& c : columns) table.rows.back().push_back(number_cell(s.*c.values, i));
    }
  }
  return as_csv(table);
}

std::optional<std::string> title_of_table(const std::string& csv) {
  const std::size_t end = csv.find(std::string(",") + kCurveColumn + ",");
  if (end == std::string::npos || csv.find('\n') < end) return std::nullopt;
  std::string title = csv.substr(0, end);
  if (!title.starts_with('"') || !title.ends_with('"') || title.size() < 2) return title;
  title = title.substr(1, title.size() - 2);
  for (std::size_t at = title.find("\"\""); at != std::string::npos; at = title.find("\"\"", at + 1))
    title.erase(at, 1);
  return title;
}

std::string table_element(const std::string& csv) { return kTableBegin + escape(csv) + kTableEnd; }

DrawingAndTable without_table(const std::string& svg) {
  const std::string begin = kTableBegin;
  const std::string end = kTableEnd;
  const std::size_t at = svg.find(begin);
  const std::size_t stop = svg.find(end, at == std::string::npos ? 0 : at);
  if (at == std::string::npos || stop == std::string::npos) return {svg, ""};
  const std::size_t text = at + begin.size();
  return {svg.substr(0, at) + svg.substr(stop + end.size()), unescape(svg.substr(text, stop - text))};
}

}  // namespace softgrain::report
