// The pieces of HTML that reports are made of.
#include <gtest/gtest.h>

#include "pipelines/report/html.h"

namespace softgrain::report {
namespace {

TEST(HtmlTable, ColumnsOfLongTextsAreLinesAndNumbersStayOnTheRight) {
  HtmlTable table({"engine", "sample", "note"});
  table.row({"law", "0", "1 of 1004 uses of fitted laws beyond what was measured: extrapolated"});
  table.row({"twin", "1"});
  const std::string html = table.html();
  EXPECT_NE(html.find("<th class=\"l\">engine</th><th>sample</th><th class=\"t\">note</th>"), std::string::npos)
      << html;
  EXPECT_NE(html.find("<td class=\"l\">twin</td><td>1</td><td class=\"t\"></td>"), std::string::npos) << html;
}

}  // namespace
}  // namespace softgrain::report
