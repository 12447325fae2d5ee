// The values of a figure as a table for spreadsheets. A table travels inside its drawing until the page is written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

/// CSV with a row for each point: title of the figure, "curve", and the labels of the axes with their units in the
/// header, then "error bar", "band low" and "band high" where a curve has them. The first column names the legend
/// entry, the second the curve. Numbers read back to the same bits; cells of what is no finite number are empty.
std::string curve_table(const PlotOptions& options, const std::vector<Series>& series);

/// What a figure is called in the header of its table; nothing for a text that is no such table.
std::optional<std::string> title_of_table(const std::string& csv);

/// The element of a drawing that carries a table.
std::string table_element(const std::string& csv);

struct DrawingAndTable {
  std::string svg;
  std::string table;  ///< empty: the drawing carries none
};

/// Takes the element out of a drawing.
DrawingAndTable without_table(const std::string& svg);

}  // namespace softgrain::report
