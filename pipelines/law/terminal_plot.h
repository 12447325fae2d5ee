// Small plots in a terminal: braille dots, or plain characters where the terminal knows no UTF-8.
#pragma once

#include <string>
#include <vector>

namespace softgrain::law {

/// Whether text for the terminal may be UTF-8, by LC_ALL, LC_CTYPE or LANG (the first that is set).
bool terminal_is_utf8();

/// One curve or set of points.
struct TerminalCurve {
  enum class Look {
    line,    ///< drawn through
    dotted,  ///< a dot here and there
    marks    ///< one character at each point
  };
  std::vector<double> x;
  std::vector<double> y;
  Look look = Look::line;
  char mark = 'o';
};

struct TerminalPlot {
  std::string x_label;
  std::string y_label;
  int columns = 80;  ///< width of the whole text, axis labels included; at least 30
  int rows = 12;     ///< height of the drawing
  bool utf8 = true;
  std::vector<TerminalCurve> curves;
};

/// The plot as lines of text: y from zero or the least value to the largest, x over all curves; ends labelled. Points
/// that are not finite are left out. Empty when there is nothing to draw.
std::string draw(const TerminalPlot& plot);

/// Widest lines of what runs, sets and lists say in a terminal.
inline constexpr std::size_t kTerminalColumns = 99;

/// Columns that a text takes in a terminal: its UTF-8 characters.
std::size_t columns_of(const std::string& text);

/// Breaks lines at spaces so that none is wider than `width`; lines after the first begin with `indent` spaces. A
/// single word that is wider stays whole.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width = 80);

/// Cells under each other, two spaces apart, the first `left` columns to the left and the others to the right; every
/// line begins with `indent` spaces. Rows may be shorter than the header.
std::string aligned(const std::vector<std::vector<std::string>>& rows, std::size_t indent, std::size_t left = 1);

}  // namespace softgrain::law
