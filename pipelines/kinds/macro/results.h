// What macro runs leave behind.
#pragma once

#include "common/data/macro_result.h"
#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults macro_results();

namespace report {
std::string macro_section(const RunData& run);  ///< stress and strain, law against resolved twin
}

namespace report {
/// Part of the section of macro scenes on stages: moduli and strength of all stages. For tests in stages it also has
/// q/p and the change of volume over the axial strain. Empty where curves do not name their stages.
std::string stage_parts(const std::vector<MacroCurve>& curves, MacroTest test);
}  // namespace report

}  // namespace softgrain
