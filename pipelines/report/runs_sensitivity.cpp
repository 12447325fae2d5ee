// How much each number of several runs depends on each key that was swept.
#include <algorithm>
#include <string>
#include <vector>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {

namespace {

bool has_indices(const SetSummary& set) {
  return std::ranges::any_of(set.sensitivity, [](const KeyEffect& e) { return e.total.has_value(); });
}

std::string sensitivity_method(const SetSummary& set) {
  std::string text =
      "95 % intervals in brackets. Rank correlation: Spearman's, 1 where the number rises with the key throughout, -1 "
      "where it falls (interval: Bonett and Wright 2000, doi:10.1007/BF02294183). Regression: change of the number for "
      "a change of the key, both in standard deviations; R²: share of the variance that the regression explains.";
  if (has_indices(set))
    text +=
        " Sobol indices: share of the variance of the number that a key causes alone (first order), and together with "
        "others (total); Saltelli et al. 2010, doi:10.1016/j.cpc.2009.09.018, estimators of Jansen 1999, "
        "doi:10.1016/S0010-4655(98)00154-4, intervals by bootstrap over base points.";
  return text;
}

}  // namespace

std::string sensitivity_part(const SetSummary& set) {
  if (std::ranges::none_of(set.sensitivity, [](const KeyEffect& e) { return e.rank || e.coefficient || e.first; }))
    return "";
  const bool indices = has_indices(set);
  std::vector<std::string> header{"number", "key", "rank correlation", "regression", "R²"};
  if (indices) header.insert(header.end(), {"first order", "total"});
  header.insert(header.end(), {"points", "not determined, because"});
  HtmlTable table(header, 2);
  for (const KeyEffect& e : set.sensitivity) {
    std::vector<std::string> row{e.number, e.key, effect_text(e.rank), effect_text(e.coefficient),
                                 e.coefficient ? format_number(e.determination, 2) : "–"};
    if (indices) row.insert(row.end(), {effect_text(e.first), effect_text(e.total)});
    row.insert(row.end(), {std::to_string(e.points), e.reason});
    table.row(row);
  }
  return "<h3>Sensitivity</h3>\n" + table.html() + paragraph(sensitivity_method(set));
}

}  // namespace softgrain::report
