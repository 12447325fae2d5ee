// Grid, frame, ticks and labels of a plot.
#include <fmt/format.h>

#include <algorithm>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/svg_draw.h"

namespace softgrain::report::svg {
namespace {

constexpr double kTickSize = 11.5;
constexpr double kLabelSize = 12.5;

std::string stroke(const std::string& data, const std::string& color, double width) {
  if (data.empty()) return "";
  return fmt::format("<path d=\"{}\" stroke=\"{}\" stroke-width=\"{}\" fill=\"none\"/>\n", data, color, number(width));
}

/// "×10⁻⁵" at the end of an axis whose labels had a power of ten taken out.
std::string factor_text(const Axis& axis) {
  return axis.exponent() == 0 ? "" : "\u00d710" + superscript(axis.exponent());
}

std::string draw_x(const Frame& f) {
  std::string grid;
  std::string marks;
  std::string labels;
  double free_from = -1e9;  // right end of the last label: a label that would touch it is left out
  for (const Tick& tick : f.x.ticks(7)) {
    const double px = f.px(tick.value);
    const bool major = !tick.label.empty();
    if (major) grid += fmt::format("M{} {}V{}", number(px), number(f.top), number(f.bottom()));
    marks += fmt::format("M{} {}v{}", number(px), number(f.bottom()), major ? -5 : -3);
    const double half = 0.5 * text_width(tick.label, kTickSize);
    if (!major || px - half < free_from + 4.0) continue;
    labels += text(px, f.bottom() + 16.0, tick.label, {.size = kTickSize});
    free_from = px + half;
  }
  const std::string factor = factor_text(f.x);
  if (!factor.empty()) labels += text(f.right(), f.bottom() + 31.0, factor, {.size = kTickSize, .anchor = "end"});
  return stroke(grid, "#e4e4e4", 1.0) + stroke(marks, "#333333", 1.0) + labels;
}

std::string draw_y(const Frame& f) {
  std::string grid;
  std::string marks;
  std::string labels;
  double free_from = 1e9;
  for (const Tick& tick : f.y.ticks(6)) {
    const double py = f.py(tick.value);
    const bool major = !tick.label.empty();
    if (major) grid += fmt::format("M{} {}H{}", number(f.left), number(py), number(f.right()));
    marks += fmt::format("M{} {}h{}", number(f.left), number(py), major ? 5 : 3);
    if (!major || py > free_from - kTickSize) continue;
    labels += text(f.left - 6.0, py + 4.0, tick.label, {.size = kTickSize, .anchor = "end"});
    free_from = py;
  }
  const std::string factor = factor_text(f.y);
  if (!factor.empty()) labels += text(f.left, f.top - 5.0, factor, {.size = kTickSize, .anchor = "start"});
  return stroke(grid, "#e4e4e4", 1.0) + stroke(marks, "#333333", 1.0) + labels;
}

Axis right_axis(const Frame& f, const RightAxis& right) {
  return {f.y.scale(), f.y.low() * right.factor, f.y.high() * right.factor};
}

std::string draw_right(const Frame& f, const RightAxis& right) {
  const Axis axis = right_axis(f, right);
  std::string marks;
  std::string labels;
  for (const Tick& tick : axis.ticks(6)) {
    const double py = f.top + f.height * (1.0 - axis.position(tick.value));
    marks += fmt::format("M{} {}h{}", number(f.right()), number(py), tick.label.empty() ? -3 : -5);
    if (!tick.label.empty())
      labels += text(f.right() + 6.0, py + 4.0, tick.label, {.size = kTickSize, .anchor = "start"});
  }
  const std::string factor = factor_text(axis);
  if (!factor.empty()) labels += text(f.right(), f.top - 5.0, factor, {.size = kTickSize, .anchor = "end"});
  const double x = f.right() + 6.0 + tick_label_width(axis) + 16.0;
  labels += text(x, f.top + 0.5 * f.height, right.label, {.size = kLabelSize, .vertical = true});
  return stroke(marks, "#333333", 1.0) + labels;
}

std::string axis_text(const Axis& axis) {
  const bool logarithmic = axis.scale() == Scale::logarithmic;
  std::string text = fmt::format("{},{:.6g},{:.6g}", logarithmic ? "log" : "linear", axis.low(), axis.high());
  std::erase(text, '+');
  return text;
}

}  // namespace

std::string axis_data(const Frame& frame, const PlotOptions& options) {
  return fmt::format(
      " data-frame=\"{},{},{},{}\" data-x-axis=\"{}\" data-y-axis=\"{}\" data-x-label=\"{}\" data-y-label=\"{}\"",
      number(frame.left), number(frame.top), number(frame.width), number(frame.height), axis_text(frame.x),
      axis_text(frame.y), escape(options.x.label), escape(options.y.label));
}

std::string draw_shaded(const Frame& frame, const ShadedRange& range) {
  const double low = std::clamp(frame.px(range.low), frame.left, frame.right());
  const double high = std::clamp(frame.px(range.high), frame.left, frame.right());
  if (!(high > low)) return "";
  std::string out = fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#f0f4f8\"/>\n", number(low),
                                number(frame.top), number(high - low), number(frame.height));
  for (const double px : {low, high}) {
    if (px <= frame.left || px >= frame.right()) continue;
    out += fmt::format("<path d=\"M{} {}V{}\" stroke=\"#9fb3c4\" stroke-width=\"1\" stroke-dasharray=\"2 3\"/>\n",
                       number(px), number(frame.top), number(frame.bottom()));
  }
  return out + "<g fill=\"#56606a\">" +
         text(low + 6.0, frame.top + 14.0, range.label, {.size = 11.0, .anchor = "start"}) + "</g>\n";
}

double tick_label_width(const Axis& axis) {
  double widest = 0.0;
  for (const Tick& tick : axis.ticks(6)) widest = std::max(widest, text_width(tick.label, kTickSize));
  return widest;
}

std::string draw_axes(const Frame& frame, const PlotOptions& options) {
  std::string out = draw_x(frame) + draw_y(frame);
  if (options.right) out += draw_right(frame, *options.right);
  out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#333333\"/>\n",
                     number(frame.left), number(frame.top), number(frame.width), number(frame.height));
  out += text(frame.left + 0.5 * frame.width, frame.bottom() + 35.0, options.x.label, {.size = kLabelSize});
  const double label_x = frame.left - 6.0 - tick_label_width(frame.y) - 8.0;
  return out + text(label_x, frame.top + 0.5 * frame.height, options.y.label, {.size = kLabelSize, .vertical = true});
}

}  // namespace softgrain::report::svg
