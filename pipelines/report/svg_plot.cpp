#include "pipelines/report/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "pipelines/report/figure_table.h"
#include "pipelines/report/html.h"
#include "pipelines/report/svg_draw.h"

namespace softgrain::report {
namespace {

constexpr double kTitleHeight = 30.0;
constexpr double kBottomMargin = 44.0;

void require_length(const std::vector<double>& values, std::size_t length, bool may_be_empty, const char* name) {
  if (values.size() == length || (may_be_empty && values.empty())) return;
  throw std::invalid_argument(std::string("plot series: ") + name + " differs in length from x");
}

void collect_y(const Series& s, std::vector<double>& values) {
  for (std::size_t i = 0; i < s.y.size(); ++i) {
    values.push_back(s.y[i]);
    const double error = s.y_error.empty() || !std::isfinite(s.y_error[i]) ? 0.0 : s.y_error[i];
    values.push_back(s.y[i] + error);
    values.push_back(s.y[i] - error);
  }
  values.insert(values.end(), s.band_low.begin(), s.band_low.end());
  values.insert(values.end(), s.band_high.begin(), s.band_high.end());
}

/// Keeps one outlying lower end of an error bar or band from stretching a logarithmic axis over many empty decades.
void drop_small_errors(const std::vector<Series>& series, std::vector<double>& values) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Series& s : series) {
    if (!s.sets_range) continue;
    for (const double y : s.y) {
      if (y > 0.0) smallest = std::min(smallest, y);
    }
  }
  if (!std::isfinite(smallest)) return;
  std::erase_if(values, [&](double v) { return v < 0.5 * smallest; });
}

Axis with_fixed_ends(const Axis& free_axis, const AxisOptions& options) {
  const double low = options.low.value_or(free_axis.low());
  double high = options.high.value_or(free_axis.high());
  if (!(high > low)) high = options.scale == Scale::logarithmic ? 10.0 * low : low + 1.0;
  return {options.scale, low, high};
}

}  // namespace

const char* palette::cycle(std::size_t index) {
  static constexpr std::array<const char*, 7> colors{blue, vermillion, green, purple, orange, sky, black};
  return colors[index % colors.size()];
}

void Plot::add(Series series) {
  require_length(series.y, series.x.size(), !series.band_low.empty(), "y");
  require_length(series.y_error, series.y.size(), true, "y_error");
  require_length(series.band_low, series.x.size(), true, "band_low");
  require_length(series.band_high, series.band_low.size(), false, "band_high");
  if (series.y.empty()) series.style.width = 0.0;
  series_.push_back(std::move(series));
}

Axis Plot::make_axis(bool horizontal) const {
  const AxisOptions& options = horizontal ? options_.x : options_.y;
  std::vector<double> values;
  for (const Series& s : series_) {
    if (!s.sets_range) continue;
    if (horizontal) {
      values.insert(values.end(), s.x.begin(), s.x.end());
    } else {
      collect_y(s, values);
    }
  }
  if (!horizontal && options.scale == Scale::logarithmic) drop_small_errors(series_, values);
  return with_fixed_ends(Axis::around(options.scale, values), options);
}

std::string Plot::svg() const {
  const Axis x = make_axis(true);
  const Axis y = make_axis(false);
  const double left = std::max(options_.left_margin, 34.0 + svg::tick_label_width(y));
  double right = 16.0;
  if (options_.right) {
    right =
        36.0 + svg::tick_label_width({y.scale(), y.low() * options_.right->factor, y.high() * options_.right->factor});
  }
  const svg::Frame frame{
      left, kTitleHeight, options_.width - left - right, options_.height - kTitleHeight - kBottomMargin, x, y};
  const svg::Legend legend = svg::draw_legend(series_, left, options_.height + 2.0, options_.width - left - 8.0);
  const double height = options_.height + legend.height + 8.0;

  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\" "
      "font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" fill=\"#1c2126\" class=\"plot\"{3}>\n",
      svg::number(options_.width), svg::number(height), escape(options_.title), svg::axis_data(frame, options_));
  out += "<style>.hit{stroke:#000;stroke-opacity:0;stroke-width:9;pointer-events:stroke}</style>\n";
  out += fmt::format("<clipPath id=\"{0}-clip\"><rect x=\"{1}\" y=\"{2}\" width=\"{3}\" height=\"{4}\"/></clipPath>\n",
                     escape(options_.id), svg::number(frame.left), svg::number(frame.top), svg::number(frame.width),
                     svg::number(frame.height));
  if (options_.shaded) out += svg::draw_shaded(frame, *options_.shaded);
  out += svg::text(frame.left, 16.0, options_.title, {.size = 13.5, .anchor = "start", .bold = true});
  out += svg::draw_axes(frame, options_);
  out += fmt::format("<g clip-path=\"url(#{}-clip)\">\n", escape(options_.id));
  for (const Series& s : series_) out += svg::draw_series(s, frame);
  return out + "</g>\n" + legend.drawing + table_element(curve_table(options_, series_)) + "</svg>\n";
}

}  // namespace softgrain::report
