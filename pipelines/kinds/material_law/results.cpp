#include "pipelines/kinds/material_law/results.h"

#include <fmt/format.h>

#include "common/core/text.h"
#include "pipelines/kinds/law_table/law_check.h"
#include "pipelines/kinds/material_law/summary.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"

namespace softgrain {

namespace {

std::vector<HeadLine> lines_of_law(const report::RunData& run) {
  const auto law = run.summary_as<MaterialLawSummary>().law;
  if (law.numbers.empty()) return {};
  const std::string text = join_text(law.numbers, ", ", [](const LawNumber& n) {
    return n.name + " = " + report::format_number(n.estimate.value, 3);
  });
  return {{"Cell law", text + (law.usable ? "." : "; not usable.")}};
}

std::vector<RunValue> values_of_law(const report::RunData& run) {
  std::vector<RunValue> out;
  for (const LawNumber& n : run.summary_as<MaterialLawSummary>().law.numbers)
    out.push_back({n.name + " of the cell law", "", n.estimate.value, n.estimate.standard_error});
  return out;
}

NextSteps next_of_law(const report::RunData& run) {
  return {"Take it in a scene with cells of fines: `softgrain macrosim SCENE.toml --law " + run.directory +
              "/cell_law.toml`.",
          "How good it is on mixtures that it has not seen: `softgrain run pipelines/material_vs_models.toml`, whose "
          "variants in `blind` the law does not know."};
}

}  // namespace

KindResults material_law_results() {
  return {.files = {{.names = "cell_law\\.toml", .check = check_laws}},
          .sections = {{Part::laws, report::cell_law_section}},
          .lines = lines_of_law,
          .values = values_of_law,
          .next = next_of_law};
}

}  // namespace softgrain
