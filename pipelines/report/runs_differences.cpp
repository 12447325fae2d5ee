// In what the numbers of two compared runs differ.
#include <cmath>
#include <string>

#include "common/data/law_words.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {

std::string differences_part(const SetSummary& set) {
  if (!set.paired || set.paired->numbers.empty()) return "";
  HtmlTable table({"number", "A", "B", "A − B", "95 %", "error of the difference over that of one value"});
  for (const PairedNumber& n : set.paired->numbers)
    table.row({with_unit(n.name, n.unit), format_with_error(n.a, n.error_a), format_with_error(n.b, n.error_b),
               format_with_error(n.difference, n.error),
               ends_text(n.low, n.high, {format_number, 3, " to ", "–", true}),
               std::isfinite(n.over_one()) ? format_number(n.over_one(), 2) : "–"});
  const std::string how = set.paired->paired ? "Errors are paired: " + set.paired->method + "."
                                             : "Errors are those of independent runs: " + set.paired->reason + ".";
  return "<h3>Differences</h3>\n" + table.html() +
         paragraph("A: " + set.runs.front().name + ", B: " + set.runs.back().name + ". " + how);
}

}  // namespace softgrain::report
