#include "pipelines/report/svg_draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/text.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"

namespace softgrain::report::svg {
namespace {

constexpr double kFarAway = 1e4;

std::string title(const std::string& text) { return text.empty() ? "" : "<title>" + escape(text) + "</title>"; }

/// Path through the points, broken where one cannot be drawn.
std::string path_data(const std::vector<double>& x, const std::vector<double>& y, const Frame& frame) {
  std::string data;
  bool pen_down = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double px = frame.px(x[i]);
    const double py = frame.py(y[i]);
    const bool good = std::isfinite(px) && std::isfinite(py);
    if (good) data += fmt::format("{}{} {}", pen_down ? 'L' : 'M', number(px), number(py));
    pen_down = good;
  }
  return data;
}

/// Values at or below zero on a logarithmic axis are drawn at its lower end: bands and error bars stay closed.
double lifted(double value, const Axis& axis) {
  return std::isfinite(value) && !axis.drawable(value) ? axis.low() : value;
}

std::string draw_band(const Series& s, const Frame& frame) {
  std::string upper;
  std::string lower;
  for (std::size_t i = 0; i < s.band_low.size(); ++i) {
    const double px = frame.px(s.x[i]);
    const double low = frame.py(lifted(s.band_low[i], frame.y));
    const double high = frame.py(lifted(s.band_high[i], frame.y));
    if (!std::isfinite(px) || !std::isfinite(low) || !std::isfinite(high)) continue;
    upper += fmt::format("{}{} {}", upper.empty() ? 'M' : 'L', number(px), number(high));
    lower.insert(0, fmt::format("L{} {}", number(px), number(low)));
  }
  if (upper.empty()) return "";
  return fmt::format("<path d=\"{}{}Z\" fill=\"{}\" fill-opacity=\"0.18\" stroke=\"none\">{}</path>\n", upper, lower,
                     s.style.color, title(hover_of(s)));
}

/// The visible line and, under the pointer, a wider invisible one that makes it easy to hit.
std::string draw_line(const Series& s, const Frame& frame) {
  if (s.style.width <= 0.0) return "";
  const std::string data = path_data(s.x, s.y, frame);
  if (data.empty()) return "";
  const std::string dash = s.style.dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", s.style.dash);
  const std::string visible =
      fmt::format("<path class=\"line\" d=\"{}\" stroke=\"{}\" stroke-width=\"{}\" stroke-opacity=\"{}\"{}/>", data,
                  s.style.color, number(s.style.width), number(s.style.opacity), dash);
  const std::string hover = title(hover_of(s));
  const std::string hit = hover.empty() ? "" : fmt::format("<path d=\"{}\" class=\"hit\"/>", data);
  return "<g fill=\"none\" stroke-linejoin=\"round\">" + hover + visible + hit + "</g>\n";
}

std::string marker_shape(Marker marker, double x, double y, double r, const std::string& color) {
  const std::string fill = marker == Marker::hollow ? "#ffffff" : color;
  const std::string paint = fmt::format("fill=\"{}\" stroke=\"{}\"", fill, color);
  if (marker == Marker::square) {
    return fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {}/>", number(x - r), number(y - r),
                       number(2 * r), number(2 * r), paint);
  }
  if (marker == Marker::triangle) {
    return fmt::format("<path d=\"M{} {}L{} {}L{} {}Z\" {}/>", number(x), number(y - 1.2 * r), number(x - 1.15 * r),
                       number(y + 0.9 * r), number(x + 1.15 * r), number(y + 0.9 * r), paint);
  }
  if (marker == Marker::diamond) {
    return fmt::format("<path d=\"M{} {}L{} {}L{} {}L{} {}Z\" {}/>", number(x), number(y - 1.3 * r),
                       number(x + 1.3 * r), number(y), number(x), number(y + 1.3 * r), number(x - 1.3 * r), number(y),
                       paint);
  }
  return fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {}/>", number(x), number(y), number(r), paint);
}

std::string draw_error_bar(double px, double low, double high, const std::string& color) {
  constexpr double cap = 3.0;
  return fmt::format(
      "<path d=\"M{0} {1}V{2}M{3} {1}H{4}M{3} {2}H{4}\" stroke=\"{5}\" stroke-width=\"1.2\" fill=\"none\"/>",
      number(px), number(low), number(high), number(px - cap), number(px + cap), color);
}

std::string point_hover(const Series& s, std::size_t i) {
  const std::string value = s.y_error.empty() ? format_number(s.y[i]) : format_with_error(s.y[i], s.y_error[i]);
  const std::string name = hover_of(s);
  return (name.empty() ? "" : name + ": ") + "x = " + format_number(s.x[i]) + ", y = " + value;
}

std::string draw_points(const Series& s, const Frame& frame) {
  std::string out;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const double px = frame.px(s.x[i]);
    const double py = frame.py(s.y[i]);
    if (!std::isfinite(px) || !std::isfinite(py)) continue;
    out += "<g opacity=\"" + number(s.style.opacity) + "\">" + title(point_hover(s, i));
    if (!s.y_error.empty() && std::isfinite(s.y_error[i]) && s.y_error[i] > 0.0) {
      const double low = frame.py(lifted(s.y[i] - s.y_error[i], frame.y));
      out += draw_error_bar(px, low, frame.py(s.y[i] + s.y_error[i]), s.style.color);
    }
    if (s.style.marker != Marker::none) out += marker_shape(s.style.marker, px, py, s.style.marker_size, s.style.color);
    out += "</g>\n";
  }
  return out;
}

/// A value with five digits for the script; nothing for what cannot be shown.
std::string data_value(double value) {
  if (!std::isfinite(value)) return "";
  std::string text = fmt::format("{:.5g}", value);
  std::erase(text, '+');
  return text;
}

std::string data_list(const std::string& name, const std::vector<double>& values) {
  if (values.empty()) return "";
  return " data-" + name + "=\"" + join_text(values, ",", data_value) + "\"";
}

/// Values are separated by commas, so that those that cannot be shown leave a gap.
std::string series_data(const Series& s) {
  std::string out = " data-entry=\"" + escape(entry_of(s)) + "\" data-name=\"" + escape(hover_of(s)) + "\"";
  return out + data_list("x", s.x) + data_list("y", s.y) + data_list("error", s.y_error) +
         data_list("low", s.band_low) + data_list("high", s.band_high);
}

/// What stands for a series in the legend, 26 px wide, centred on y.
std::string legend_sample(const Series& s, double x, double y) {
  std::string out;
  if (!s.band_low.empty()) {
    out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"26\" height=\"10\" fill=\"{}\" fill-opacity=\"0.25\"/>",
                       number(x), number(y - 5), s.style.color);
  }
  if (s.style.width > 0.0 && !s.y.empty()) {
    const std::string dash = s.style.dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", s.style.dash);
    out += fmt::format("<path d=\"M{} {}h26\" stroke=\"{}\" stroke-width=\"{}\" stroke-opacity=\"{}\"{}/>", number(x),
                       number(y), s.style.color, number(std::max(1.0, s.style.width)),
                       number(std::max(0.5, s.style.opacity)), dash);
  }
  if (s.style.marker != Marker::none)
    out += marker_shape(s.style.marker, x + 13, y, s.style.marker_size, s.style.color);
  return out;
}

}  // namespace

const std::string& hover_of(const Series& series) { return series.hover.empty() ? series.label : series.hover; }
const std::string& entry_of(const Series& series) { return series.group.empty() ? series.label : series.group; }

double Frame::px(double value) const { return std::clamp(left + width * x.position(value), -kFarAway, kFarAway); }
double Frame::py(double value) const {
  return std::clamp(top + height * (1.0 - y.position(value)), -kFarAway, kFarAway);
}

std::string number(double pixels) {
  std::string text = without_trailing_zeros(fmt::format("{:.2f}", pixels));
  return text == "-0" ? "0" : text;
}

double text_width(const std::string& utf8, double font_size) {
  const auto continuation = [](char ch) { return (static_cast<unsigned char>(ch) & 0xc0U) == 0x80U; };
  const auto letters = utf8.size() - static_cast<std::size_t>(std::ranges::count_if(utf8, continuation));
  return 0.6 * font_size * static_cast<double>(letters);
}

std::string text(double x, double y, const std::string& content, const TextStyle& style) {
  const std::string turn = style.vertical ? fmt::format(" transform=\"rotate(-90 {} {})\"", number(x), number(y)) : "";
  return fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\"{}{}>{}</text>\n", number(x),
                     number(y), number(style.size), style.anchor, style.bold ? " font-weight=\"600\"" : "", turn,
                     escape(content));
}

std::string draw_series(const Series& series, const Frame& frame) {
  std::string out = draw_band(series, frame) + draw_line(series, frame);
  if (series.style.marker != Marker::none || !series.y_error.empty()) out += draw_points(series, frame);
  return "<g class=\"series\"" + series_data(series) + ">\n" + out + "</g>\n";
}

Legend draw_legend(const std::vector<Series>& series, double left, double top, double width) {
  constexpr double row = 18.0;
  constexpr double size = 11.5;
  Legend legend;
  double x = left;
  double y = top + 0.5 * row;
  for (const Series& s : series) {
    if (s.label.empty()) continue;
    const double need = 26.0 + 6.0 + text_width(s.label, size);
    if (x > left && x + need > left + width) {
      x = left;
      y += row;
    }
    legend.drawing += "<g class=\"entry\" data-entry=\"" + escape(s.label) + "\">" + legend_sample(s, x, y) +
                      text(x + 32.0, y + 4.0, s.label, {.size = size, .anchor = "start"}) + "</g>\n";
    x += need + 16.0;
    legend.height = y + 0.5 * row - top;
  }
  return legend;
}

}  // namespace softgrain::report::svg
