// The report of a run: one self-contained page with figures and tables, readable without a network and printable; its
// figures as separate SVG files, for papers and slides, and as tables, for spreadsheets; its style sheet and scripts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace softgrain {

/// Reads what DIR holds (summary.json, measurements.h5, law.toml, law.h5, macro.h5, grain_box.h5) and writes
/// DIR/report.html with the figures and curves beside it. Sections without data are left out. Throws IoError for
/// missing, damaged or unwritable files.
void write_report(const std::string& run_directory);

}  // namespace softgrain

namespace softgrain::report {

struct Figure {
  std::string name;   ///< file name without extension, from the figure's title
  std::string svg;    ///< complete document
  std::string table;  ///< its values as CSV; empty: it is no plot
};

/// The body of a page, and what stands beside the page.
struct BodyAndFigures {
  std::string body;  ///< links below the plots in place of their tables
  std::vector<Figure> figures;
};

/// Every svg element of an HTML body, in order; names are made unique by a number.
BodyAndFigures figures_of(const std::string& html);

/// Directories of a run that belong to its report.
inline constexpr const char* kFigureFolder = "figures";
inline constexpr const char* kCurveFolder = "curves";

/// Writes them to DIR/figures/NAME.svg and DIR/curves/NAME.csv in place of those that an earlier report left there.
/// Throws IoError.
void write_figures(const std::string& run_directory, const std::vector<Figure>& figures);

/// Removes those that a report left in DIR/figures and DIR/curves, and each directory when nothing else is in it.
void remove_figures(const std::string& run_directory);

}  // namespace softgrain::report

// The style sheet and the scripts of a report. They are kept as files in pipelines/report/assets/ and become part of
// the program when it is built (cmake/embed_texts.cmake).

namespace softgrain::report::assets {

std::string_view report_css();  ///< style for screen, phone and print
std::string_view report_js();   ///< values under the pointer, legend entries that hide and show their curves

// The packing in 3D, on top of three.js, in this order.
std::string_view packing_data_js();   ///< states and colours
std::string_view packing_scene_js();  ///< what is drawn
std::string_view packing_view_js();   ///< what the reader does

}  // namespace softgrain::report::assets
