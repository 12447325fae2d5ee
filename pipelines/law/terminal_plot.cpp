#include "pipelines/law/terminal_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace softgrain::law {

namespace {

constexpr int kDotsAcross = 2;  ///< dots per braille character
constexpr int kDotsDown = 4;

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool usable() const { return low < high; }
  [[nodiscard]] double share(double value) const { return (value - low) / (high - low); }
};

/// A field of dots, four by two in each character, and characters laid over it.
class Canvas {
 public:
  Canvas(int columns, int rows)
      : columns_(columns),
        rows_(rows),
        dots_(static_cast<std::size_t>(columns * rows), 0),
        marks_(static_cast<std::size_t>(columns * rows), ' ') {}

  [[nodiscard]] int across() const { return columns_ * kDotsAcross; }
  [[nodiscard]] int down() const { return rows_ * kDotsDown; }

  /// x, y from the lower left, in dots.
  void dot(int x, int y) {
    if (x < 0 || y < 0 || x >= across() || y >= down()) return;
    const int from_top = down() - 1 - y;
    // Braille numbers its dots 1 2 3 7 down the left and 4 5 6 8 down the right.
    constexpr unsigned kBits[kDotsDown][kDotsAcross] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    dots_[cell(x / kDotsAcross, from_top / kDotsDown)] |= kBits[from_top % kDotsDown][x % kDotsAcross];
  }
  void mark(int x, int y, char c) {
    if (x < 0 || y < 0 || x >= across() || y >= down()) return;
    marks_[cell(x / kDotsAcross, (down() - 1 - y) / kDotsDown)] = c;
  }

  [[nodiscard]] std::string row(int r, bool utf8) const {
    std::string text;
    for (int c = 0; c < columns_; ++c) {
      const std::size_t k = cell(c, r);
      if (marks_[k] != ' ' || dots_[k] == 0)
        text += marks_[k];
      else
        text += utf8 ? braille(dots_[k]) : std::string(1, plain(dots_[k]));
    }
    return text;
  }

 private:
  [[nodiscard]] std::size_t cell(int c, int r) const { return static_cast<std::size_t>(r * columns_ + c); }

  /// U+2800 plus the dots, as UTF-8.
  static std::string braille(unsigned bits) {
    const unsigned code = 0x2800 + bits;
    return {static_cast<char>(0xE0 | (code >> 12)), static_cast<char>(0x80 | ((code >> 6) & 0x3F)),
            static_cast<char>(0x80 | (code & 0x3F))};
  }
  /// More than one dot of a cell belongs to a line.
  static char plain(unsigned bits) { return (bits & (bits - 1)) == 0 ? '.' : '*'; }

  int columns_;
  int rows_;
  std::vector<unsigned> dots_;
  std::vector<char> marks_;
};

class Drawer {
 public:
  Drawer(Canvas& canvas, const Extent& x, const Extent& y) : canvas_(canvas), x_(x), y_(y) {}

  void draw(const TerminalCurve& curve) {
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
      if (!std::isfinite(curve.x[k]) || !std::isfinite(curve.y[k])) continue;
      const int x = column(curve.x[k]);
      const int y = level(curve.y[k]);
      if (curve.look == TerminalCurve::Look::marks) canvas_.mark(x, y, curve.mark);
      if (curve.look == TerminalCurve::Look::dotted && x % kSparse == 0) canvas_.dot(x, y);
      if (curve.look == TerminalCurve::Look::line) {
        canvas_.dot(x, y);
        if (k > 0 && std::isfinite(curve.y[k - 1])) join(column(curve.x[k - 1]), level(curve.y[k - 1]), x, y);
      }
    }
  }

 private:
  static constexpr int kSparse = 3;  ///< dots of a dotted curve

  [[nodiscard]] int column(double x) const { return nearest(x_.share(x), canvas_.across()); }
  [[nodiscard]] int level(double y) const { return nearest(y_.share(y), canvas_.down()); }
  static int nearest(double share, int dots) { return static_cast<int>(std::lround(share * (dots - 1))); }

  void join(int x0, int y0, int x1, int y1) {
    const int steps = std::max(std::abs(x1 - x0), std::abs(y1 - y0));
    for (int s = 1; s < steps; ++s)
      canvas_.dot(x0 + static_cast<int>(std::lround(double(x1 - x0) * s / steps)),
                  y0 + static_cast<int>(std::lround(double(y1 - y0) * s / steps)));
  }

  Canvas& canvas_;
  Extent x_;
  Extent y_;
};

void take_extents(const TerminalPlot& plot, Extent& x, Extent& y) {
  y.take(0.0);
  for (const TerminalCurve& c : plot.curves)
    for (std::size_t k = 0; k < c.x.size(); ++k)
      if (std::isfinite(c.x[k]) && std::isfinite(c.y[k])) {
        x.take(c.x[k]);
        y.take(c.y[k]);
      }
}

std::string spaces(std::size_t n) { return std::string(n, ' '); }

}  // namespace

bool terminal_is_utf8() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): before any thread
    if (value == nullptr || *value == '\0') continue;
    std::string text = value;
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text.find("utf-8") != std::string::npos || text.find("utf8") != std::string::npos;
  }
  return false;
}

std::string draw(const TerminalPlot& plot) {
  Extent x;
  Extent y;
  take_extents(plot, x, y);
  if (!x.usable() || !y.usable()) return "";
  const std::string top = fmt::format("{:.3g}", y.high);
  const std::string bottom = fmt::format("{:.3g}", y.low);
  const std::size_t margin = std::max(top.size(), bottom.size()) + 3;
  const int columns = std::max(plot.columns, 30) - static_cast<int>(margin) - 1;
  Canvas canvas(columns, plot.rows);
  Drawer drawer(canvas, x, y);
  for (const TerminalCurve& c : plot.curves) drawer.draw(c);
  std::string text = spaces(margin) + plot.y_label + "\n";
  for (int r = 0; r < plot.rows; ++r) {
    const std::string label = r == 0 ? top : (r + 1 == plot.rows ? bottom : "");
    std::string line = spaces(margin - 1 - label.size()) + label + "|" + canvas.row(r, plot.utf8);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  const std::string left = fmt::format("{:.3g}", x.low);
  const std::string right = fmt::format("{:.3g}", x.high);
  text += spaces(margin - 1) + "+" + std::string(static_cast<std::size_t>(columns), '-') + "\n";
  const std::size_t room = static_cast<std::size_t>(columns) - left.size() - right.size();
  const std::size_t before = (room - std::min(room, plot.x_label.size())) / 2;
  const std::string label = plot.x_label.substr(0, room);
  text += spaces(margin) + left + spaces(before) + label + spaces(room - before - label.size()) + right + "\n";
  return text;
}

std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::string out;
  std::string line;
  const auto end_line = [&] {
    out += line + "\n";
    line = spaces(indent);
  };
  bool fresh = true;
  std::size_t at = text.find_first_not_of(' ');
  line = spaces(std::min(at, text.size()));
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!fresh && columns_of(line) + 1 + columns_of(word) > width) {
      end_line();
      fresh = true;
    }
    line += (fresh ? "" : " ") + word;
    fresh = false;
    at = text.find_first_not_of(' ', end);
  }
  return out + line + "\n";
}

std::string aligned(const std::vector<std::vector<std::string>>& rows, std::size_t indent, std::size_t left) {
  std::vector<std::size_t> width;
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (width.size() <= k) width.push_back(0);
      width[k] = std::max(width[k], columns_of(row[k]));
    }
  std::string text;
  for (const auto& row : rows) {
    std::string line = spaces(indent);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string fill = spaces(width[k] - columns_of(row[k]));
      line += (k > 0 ? "  " : "") + (k < left ? row[k] + fill : fill + row[k]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace softgrain::law
