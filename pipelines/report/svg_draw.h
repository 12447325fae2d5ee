// The drawing of series, axes and legend inside a frame. Used by Plot only.
#pragma once

#include <string>
#include <vector>

#include "pipelines/report/svg_plot.h"

namespace softgrain::report::svg {

/// The rectangle between the axes [px] and the mapping of data into it.
struct Frame {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
  Axis x;
  Axis y;

  [[nodiscard]] double right() const { return left + width; }
  [[nodiscard]] double bottom() const { return top + height; }
  /// Pixel positions; NaN for values that cannot be drawn; far-away values stay within 1e4 px so that files remain
  /// readable.
  [[nodiscard]] double px(double value) const;
  [[nodiscard]] double py(double value) const;
};

/// A pixel length with at most two decimals.
std::string number(double pixels);

/// Approximate width of a text [px] in the sans-serif font of the plots.
double text_width(const std::string& utf8, double font_size);

struct TextStyle {
  double size = 12.0;
  std::string anchor = "middle";  ///< "start", "middle" or "end"
  bool bold = false;
  bool vertical = false;  ///< turned to read upwards
};
std::string text(double x, double y, const std::string& content, const TextStyle& style = {});

/// Where the axes lie and what they mean, as attributes data-frame, data-x-axis, data-x-label ... of the drawing.
std::string axis_data(const Frame& frame, const PlotOptions& options);

/// A range of x behind everything else, with its label at the top.
std::string draw_shaded(const Frame& frame, const ShadedRange& range);

/// Band, line, error bars and markers of a series, each with its tooltip, in one group that holds the values as data-*.
std::string draw_series(const Series& series, const Frame& frame);

/// Grid, frame, ticks and labels. `right` may be absent.
std::string draw_axes(const Frame& frame, const PlotOptions& options);

/// What a curve is called under the pointer.
const std::string& hover_of(const Series& series);

/// The legend entry that hides and shows it.
const std::string& entry_of(const Series& series);

/// Rows of legend entries, wrapped to the width.
struct Legend {
  std::string drawing;
  double height = 0.0;  ///< [px], 0 when no series has a label
};
Legend draw_legend(const std::vector<Series>& series, double left, double top, double width);

/// Space [px] that the tick labels of an axis need to its side.
double tick_label_width(const Axis& axis);

}  // namespace softgrain::report::svg
