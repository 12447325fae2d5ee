// The figures of a report as separate SVG files, for papers and slides.
#pragma once

#include <string>
#include <vector>

namespace softgrain::report {

struct Figure {
  std::string name;  ///< file name without extension, from the figure's title
  std::string svg;   ///< complete document
};

/// Every svg element of an HTML body, in order; names are made unique by a number.
std::vector<Figure> figures_of(const std::string& html);

/// Writes them to DIR/figures in place of those that an earlier report left there. Throws IoError.
void write_figures(const std::string& run_directory, const std::vector<Figure>& figures);

/// Removes those that a report left in DIR/figures, and the directory when nothing else is in it.
void remove_figures(const std::string& run_directory);

}  // namespace softgrain::report
