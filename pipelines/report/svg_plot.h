// A small plotter that writes printable SVG: lines, markers, error bars and bands on linear or logarithmic axes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/report/axis.h"

namespace softgrain::report {

/// Colours that stay apart for colour-blind readers and in grey print (Okabe and Ito), without the light yellow.
namespace palette {
inline constexpr const char* black = "#000000";
inline constexpr const char* blue = "#0072b2";
inline constexpr const char* vermillion = "#d55e00";
inline constexpr const char* green = "#009e73";
inline constexpr const char* purple = "#cc79a7";
inline constexpr const char* orange = "#e69f00";
inline constexpr const char* sky = "#56b4e9";
inline constexpr const char* grey = "#8a8a8a";
/// The colours in the order of use, repeating.
const char* cycle(std::size_t index);
}  // namespace palette

enum class Marker { none, circle, square, triangle, diamond, hollow };

struct SeriesStyle {
  std::string color = palette::black;
  double width = 1.8;     ///< width of the line [px]; 0: no line
  std::string dash = {};  ///< SVG dash pattern, empty: solid
  double opacity = 1.0;
  Marker marker = Marker::none;
  double marker_size = 3.5;  ///< half width [px]
};

/// Data of one curve. Points that cannot be drawn (NaN; not positive on a logarithmic axis) leave a gap.
struct Series {
  std::string label;  ///< label in the legend; empty: not listed
  std::string hover;  ///< text shown when the pointer rests on the curve; empty: the label
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> y_error = {};   ///< half length of error bars; empty: none
  std::vector<double> band_low = {};  ///< a band between two curves over x, filled with the series' colour; empty: none
  std::vector<double> band_high = {};
  SeriesStyle style = {};
  bool sets_range = true;  ///< whether the axes make room for it; otherwise it is cut at the frame
  std::string group = {};  ///< label of the legend entry that it goes with (hidden and shown together); empty: its own
};

struct AxisOptions {
  std::string label;  ///< label with unit, e.g. "normal force Fn [N]"
  Scale scale = Scale::linear;
  std::optional<double> low = {};  ///< fixed ends; otherwise from the data
  std::optional<double> high = {};
};

/// Axis on the right with the quantity in another unit: right value = left value * factor.
struct RightAxis {
  std::string label;
  double factor = 1.0;
};

/// A range of x that is shaded behind the curves.
struct ShadedRange {
  double low = 0.0;
  double high = 0.0;
  std::string label;  ///< written at its top
};

struct PlotOptions {
  std::string id;  ///< unique in the page: letters, digits, '-'
  std::string title;
  AxisOptions x;
  AxisOptions y;
  std::optional<RightAxis> right = {};
  double width = 560.0;   ///< width of the whole drawing [px of the view box]
  double height = 370.0;  ///< height without the legend, which is added below [px of the view box]
  std::optional<ShadedRange> shaded = {};
  double left_margin = 0.0;  ///< [px] at least; plots above each other share one
};

class Plot {
 public:
  explicit Plot(PlotOptions options) : options_(std::move(options)) {}

  /// Later series are drawn over earlier ones. Throws std::invalid_argument when array lengths differ.
  void add(Series series);
  [[nodiscard]] bool empty() const { return series_.empty(); }

  /// The drawing as one svg element, scalable through its viewBox. Its attributes data-* hold axes and values, for
  /// the script of the page (assets/report.js). It carries the table of its values (figure_table.h).
  [[nodiscard]] std::string svg() const;

 private:
  [[nodiscard]] Axis make_axis(bool horizontal) const;

  PlotOptions options_;
  std::vector<Series> series_;
};

}  // namespace softgrain::report
