// Axes, number formats and drawings of the plotter.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>
#include <stdexcept>

#include "pipelines/report/figure_table.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/svg_plot.h"
#include "tests/support/markup_check.h"

namespace softgrain::report {
namespace {

PlotOptions options(Scale scale = Scale::linear) {
  return {.id = "p", .title = "Title", .x = {.label = "x [m]"}, .y = {.label = "y [N]", .scale = scale}};
}

TEST(NumberFormat, ReadableNumbers) {
  EXPECT_EQ(format_number(0.0), "0");
  EXPECT_EQ(format_number(73.669), "73.67");
  EXPECT_EQ(format_number(-0.035), "\u22120.035");
  EXPECT_EQ(format_number(9.99996), "10");
  EXPECT_EQ(format_number(1.234e-9, 3), "1.23\u00d710\u207b\u2079");
  EXPECT_EQ(format_number(NAN), "\u2013");
  EXPECT_EQ(format_count(1234567), "1\u202f234\u202f567");
  EXPECT_EQ(format_count(-1234), "\u22121\u202f234");
  EXPECT_EQ(format_seconds(7999.0), "2 h 13 min");
  EXPECT_EQ(format_seconds(245.0), "4 min 05 s");
}

TEST(NumberFormat, TheErrorRulesTheDigits) {
  EXPECT_EQ(format_with_error(0.57612, 0.0123), "0.576 \u00b1 0.012");
  EXPECT_EQ(format_with_error(1234.56, 78.9), "1235 \u00b1 79");
  EXPECT_EQ(format_with_error(24800.0, 1488.0), "24800 \u00b1 1500");
  EXPECT_EQ(format_with_error(1.0416666, 1e-16), "1.042");
  EXPECT_EQ(format_with_error(1.5e-7, 2e-9), "(1.500 \u00b1 0.020)\u00d710\u207b\u2077");
  EXPECT_EQ(format_with_error(2.5, NAN), "2.5");
}

TEST(NumberFormat, PrefixesBringValuesBetweenOneAndAThousand) {
  EXPECT_EQ(si_prefix(4.2e5).symbol, "k");
  EXPECT_EQ(si_prefix(0.0).symbol, "");
  EXPECT_EQ(si_prefix(3e-5).symbol, "\u00b5");
  EXPECT_EQ(si_prefix(1e14).symbol, "G");
}

TEST(Axis, LinearTicksAreRoundAndInside) {
  const Axis axis(Scale::linear, -0.03, 0.31);
  const auto ticks = axis.ticks(6);
  ASSERT_GE(ticks.size(), 4U);
  for (const Tick& t : ticks) {
    EXPECT_GE(t.value, -0.03);
    EXPECT_LE(t.value, 0.31);
  }
  EXPECT_EQ(ticks.front().label, "0.00");
}

TEST(Axis, TakesACommonPowerOfTenOutOfTheLabels) {
  const Axis axis(Scale::linear, 0.0, 4e-7);
  EXPECT_EQ(axis.exponent(), -7);
  EXPECT_EQ(axis.ticks(4).back().label, "4");
}

TEST(Axis, LogarithmicTicksLabelDecades) {
  const Axis axis(Scale::logarithmic, 0.5, 2e5);
  int labelled = 0;
  for (const Tick& t : axis.ticks()) labelled += t.label.empty() ? 0 : 1;
  EXPECT_EQ(labelled, 6);
  EXPECT_NEAR(axis.position(0.5), 0.0, 1e-12);
  EXPECT_NEAR(axis.position(std::sqrt(0.5 * 2e5)), 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(axis.position(0.0)));
}

TEST(Axis, SurvivesDegenerateData) {
  const std::vector<double> none;
  const std::vector<double> same{3.0, 3.0};
  const std::vector<double> odd{NAN, -1.0, 0.0};
  EXPECT_LT(Axis::around(Scale::linear, none).low(), Axis::around(Scale::linear, none).high());
  EXPECT_LT(Axis::around(Scale::linear, same).low(), 3.0);
  EXPECT_GT(Axis::around(Scale::logarithmic, odd).low(), 0.0);
  EXPECT_THROW(Axis(Scale::linear, 1.0, 1.0), std::invalid_argument);
  EXPECT_THROW(Axis(Scale::logarithmic, 0.0, 1.0), std::invalid_argument);
}

TEST(Plot, DrawsWellFormedMarkupWithClipLegendAndTooltips) {
  Plot plot(options());
  plot.add({.label = "a < b & c",
            .hover = "packing \"7\"",
            .x = {0, 1, 2},
            .y = {1, 4, 9},
            .y_error = {0.1, NAN, 0.2},
            .style = {.marker = Marker::diamond}});
  plot.add({.label = "band", .hover = "", .x = {0, 2}, .y = {}, .band_low = {0, 1}, .band_high = {1, 2}});
  const std::string svg = plot.svg();
  EXPECT_EQ(unbalanced_tags(svg), "");
  EXPECT_NE(svg.find("clip-path=\"url(#p-clip)\""), std::string::npos);
  EXPECT_NE(svg.find("<title>packing &quot;7&quot;: x = 1, y = 4</title>"), std::string::npos);
  EXPECT_NE(svg.find("a &lt; b &amp; c"), std::string::npos);
  EXPECT_NE(svg.find("viewBox"), std::string::npos);
}

TEST(Plot, HoldsAxesAndValuesForTheScript) {
  PlotOptions with_range = options();
  with_range.shaded = ShadedRange{0.5, 1.0, "fitted"};
  with_range.x = {.label = "a [m]", .low = 0.0, .high = 2.0};
  Plot plot(with_range);
  Series series;
  series.label = "c";
  series.x = {0, 1, 2};
  series.y = {1, NAN, 9};
  series.group = "d";
  plot.add(series);
  const std::string svg = plot.svg();
  EXPECT_NE(svg.find("data-x-axis=\"linear,0,2\""), std::string::npos);
  EXPECT_NE(svg.find("data-x-label=\"a [m]\""), std::string::npos);
  EXPECT_NE(svg.find("data-entry=\"d\" data-name=\"c\" data-x=\"0,1,2\" data-y=\"1,,9\""), std::string::npos);
  EXPECT_NE(svg.find(">fitted</text>"), std::string::npos);
}

/// A plot with a curve, its band and points with errors.
Plot plot_of_all_columns() {
  PlotOptions all = options();
  all.title = "F(\u0394), \"soft\" & <solid>";
  all.x.label = "\u0394";
  Plot plot(all);
  plot.add({.label = "", .hover = "packing 7", .x = {0.1, 2.0 / 3.0}, .y = {1e-300, NAN}, .group = "one packing"});
  plot.add({.label = "mean", .hover = "", .x = {0.5}, .y = {-4.0}, .y_error = {0.25}});
  plot.add({.label = "band", .hover = "", .x = {0.0, 1.0}, .y = {}, .band_low = {0.0, 1.0}, .band_high = {1.0, 2.0}});
  return plot;
}

TEST(Plot, CarriesItsValuesAsATableWithEveryDigit) {
  const std::string svg = plot_of_all_columns().svg();
  EXPECT_EQ(unbalanced_tags(svg), "");
  const DrawingAndTable parts = without_table(svg);
  EXPECT_EQ(parts.table,
            "\"F(\u0394), \"\"soft\"\" & <solid>\",curve,\u0394,y [N],error bar [N],band low [N],band high [N]\n"
            "one packing,packing 7,0.1,1e-300,,,\n"
            "one packing,packing 7,0.6666666666666666,,,,\n"
            "mean,mean,0.5,-4,0.25,,\n"
            "band,band,0,,,0,1\n"
            "band,band,1,,,1,2\n");
  EXPECT_EQ(title_of_table(parts.table), "F(\u0394), \"soft\" & <solid>");
  EXPECT_EQ(unbalanced_tags(parts.svg), "");
  EXPECT_EQ(parts.svg.find("one packing,"), std::string::npos);
  EXPECT_EQ(without_table(parts.svg).table, "");
  EXPECT_EQ(without_table(parts.svg).svg, parts.svg);
}

TEST(Plot, TablesHaveTheColumnsThatTheirCurvesHave) {
  Plot plot(options());
  plot.add({.label = "a", .hover = "", .x = {0, 1}, .y = {2, 3}});
  const std::string table = without_table(plot.svg()).table;
  EXPECT_EQ(table, "Title,curve,x [m],y [N]\na,a,0,2\na,a,1,3\n");
  EXPECT_EQ(title_of_table(table), "Title");
  EXPECT_EQ(title_of_table("hn [mm],Fn [N]\n1,curve,2\n"), std::nullopt);
}

TEST(Plot, NeverWritesNumbersThatAreNotFinite) {
  Plot plot(options(Scale::logarithmic));
  plot.add({.label = "gap",
            .hover = "",
            .x = {1, 2, 3, 4},
            .y = {1, 0, NAN, 5},
            .y_error = {2, 1, 1, NAN},
            .style = {.marker = Marker::circle}});
  const std::string svg = plot.svg();
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find('M', svg.find("<g clip-path")), std::string::npos);
}

TEST(Plot, FarAwayDataStayBoundedAndDoNotStretchTheAxes) {
  Plot plot(options());
  plot.add({.label = "data", .hover = "", .x = {0, 1}, .y = {0, 1}});
  plot.add({.label = "reference", .hover = "", .x = {0, 1}, .y = {0, 1e300}, .sets_range = false});
  const std::string svg = without_table(plot.svg()).svg;
  EXPECT_EQ(svg.find("e+"), std::string::npos);
  EXPECT_NE(svg.find(">0.8<"), std::string::npos);
}

TEST(Plot, AnEmptyPlotIsStillADrawing) { EXPECT_EQ(unbalanced_tags(Plot(options()).svg()), ""); }

TEST(Plot, RefusesArraysOfDifferentLength) {
  Plot plot(options());
  EXPECT_THROW(plot.add({.label = "", .hover = "", .x = {1, 2}, .y = {1}}), std::invalid_argument);
  EXPECT_THROW(plot.add({.label = "", .hover = "", .x = {1, 2}, .y = {1, 2}, .y_error = {1}}), std::invalid_argument);
  EXPECT_THROW(plot.add({.label = "", .hover = "", .x = {1, 2}, .y = {}, .band_low = {1, 2}, .band_high = {1}}),
               std::invalid_argument);
}

TEST(Markup, TheCheckFindsWhatIsWrong) {
  EXPECT_EQ(unbalanced_tags("<a><b/></a>"), "");
  EXPECT_NE(unbalanced_tags("<a><b></a>"), "");
  EXPECT_NE(unbalanced_tags("<a>"), "");
  EXPECT_NE(unbalanced_tags("</a>"), "");
}

TEST(Html, EscapesAndDropsControlCharacters) { EXPECT_EQ(escape("<&>\"'\x01"), "&lt;&amp;&gt;&quot;&#39;"); }

TEST(Html, EscapedTextComesBack) {
  const std::string text = "a < b && \"c\" > 'd' &amp; &lt;";
  EXPECT_EQ(unescape(escape(text)), text);
}

TEST(Html, ASectionWithoutBodyLeavesNoTrace) {
  EXPECT_EQ(section("id", "Heading", "what to see", ""), "");
  EXPECT_EQ(figure_row({}), "");
}

TEST(Html, SectionsBeginWithWhatToSeeAndFoldTheirTables) {
  HtmlTable table({"stage", "engine", "modulus", "error"});
  table.row({"oedometric", "law", "8.4", "1.5"});
  const std::string html = section("id", "Heading", "What to see.", table.html());
  EXPECT_NE(html.find("<p class=\"what\">What to see.</p>"), std::string::npos) << html;
  EXPECT_NE(html.find("<details class=\"table\"><summary>Table of stage, engine, modulus and 1 more column, 1 row"),
            std::string::npos)
      << html;
  EXPECT_EQ(unbalanced_tags(html), "");
}

}  // namespace
}  // namespace softgrain::report
