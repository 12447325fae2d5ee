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

}  // namespace softgrain::report
