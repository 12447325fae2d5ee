// Plots and tables for a terminal: never too wide, plain where they must be, and the curve where it belongs.
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "pipelines/law/terminal_plot.h"

namespace softgrain::law {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TerminalPlot rising(bool utf8) {
  TerminalPlot plot{"x", "y", 60, 8, utf8, {}};
  TerminalCurve curve;
  for (int k = 0; k <= 100; ++k) {
    curve.x.push_back(0.01 * k);
    curve.y.push_back(0.02 * k);
  }
  plot.curves.push_back(curve);
  return plot;
}

TEST(TerminalPlot, KeepsToItsColumnsAndSaysTheEnds) {
  for (const bool utf8 : {true, false}) {
    const auto lines = lines_of(draw(rising(utf8)));
    ASSERT_EQ(lines.size(), 8u + 3u);
    for (const std::string& line : lines) EXPECT_LE(columns_of(line), 60u) << line;
    EXPECT_NE(lines[1].find("2|"), std::string::npos);
    EXPECT_NE(lines[8].find("0|"), std::string::npos);
    EXPECT_TRUE(lines.back().ends_with("1"));
  }
}

TEST(TerminalPlot, ARisingLineGoesFromTheLowerLeftToTheUpperRight) {
  const auto lines = lines_of(draw(rising(false)));
  EXPECT_EQ(lines[8].find('*'), lines[8].find('|') + 1);
  EXPECT_EQ(columns_of(lines[1]), 59u);  // the line ends at the right edge of the drawing
  std::size_t last = 0;
  for (std::size_t r = 8; r >= 1; --r) {
    const std::size_t first = lines[r].find('*');
    ASSERT_NE(first, std::string::npos) << r;
    EXPECT_GE(first, last);
    last = first;
  }
}

TEST(TerminalPlot, PlainMeansAscii) {
  for (const char c : draw(rising(false))) EXPECT_LT(static_cast<unsigned char>(c), 128);
  EXPECT_NE(draw(rising(true)).find("\xE2\xA0"), std::string::npos);  // braille begins with these two bytes
}

TEST(TerminalPlot, NothingToDraw) {
  EXPECT_EQ(draw({}), "");
  TerminalPlot plot{"x", "y", 60, 8, true, {}};
  plot.curves.push_back({{1.0, 1.0}, {2.0, 3.0}});
  EXPECT_EQ(draw(plot), "");
}

TEST(TerminalText, WrapsAtSpaces) {
  EXPECT_EQ(wrapped("aa bb cc", 2, 5), "aa bb\n  cc\n");
  EXPECT_EQ(wrapped("  long-word-beyond b", 1, 8), "  long-word-beyond\n b\n");
  EXPECT_EQ(wrapped("", 2), "\n");
}

TEST(TerminalText, AlignsByColumnsAndNotByBytes) {
  EXPECT_EQ(aligned({{"a", "10"}, {"\xC3\xA4\xC3\xA4", "1"}}, 1), " a   10\n \xC3\xA4\xC3\xA4   1\n");
}

TEST(TerminalText, TheLocaleDecides) {
  const auto said = [](const char* all, const char* lang) {
    ::setenv("LC_ALL", all, 1);
    ::setenv("LANG", lang, 1);
    ::unsetenv("LC_CTYPE");
    return terminal_is_utf8();
  };
  EXPECT_TRUE(said("", "de_DE.UTF-8"));
  EXPECT_TRUE(said("C.utf8", "C"));
  EXPECT_FALSE(said("C", "de_DE.UTF-8"));
  EXPECT_FALSE(said("", ""));
}

}  // namespace
}  // namespace softgrain::law
