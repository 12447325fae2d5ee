#include "pipelines/kinds/material_law/results.h"

#include <fmt/format.h>

#include "pipelines/kinds/law_table/law_check.h"
#include "pipelines/kinds/material_law/summary.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"

namespace softgrain {

namespace {

std::vector<HeadLine> lines_of_law(const report::RunData& run) {
  const auto law = run.summary_as<MaterialLawSummary>().law;
  if (law.numbers.empty()) return {};
  std::string text;
  for (const LawNumber& n : law.numbers)
    text += (text.empty() ? "" : ", ") + n.name + " = " + report::format_number(n.estimate.value, 3);
  return {{"Cell law", text + (law.usable ? "." : "; not usable.")}};
}

}  // namespace

KindResults material_law_results() {
  return {.files = {{.names = "cell_law\\.toml", .check = check_laws}},
          .sections = {{Place::laws, report::cell_law_section}},
          .lines = lines_of_law};
}

}  // namespace softgrain
