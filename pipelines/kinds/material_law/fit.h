// The cell law, fitted to what was measured on fines, coarse grains and mixtures.
#pragma once

#include <string>
#include <vector>

#include "common/data/cell_card.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_law/scene.h"
#include "pipelines/kinds/material_law/summary.h"

namespace softgrain {

struct MaterialLaw {
  CellCard card;  ///< whole when there are no problems
  CellLawSummary summary;
  std::vector<std::string> problems;  ///< why it is not usable; empty: it is
};

/// `results` in the order of the variants; `states`: the fit to them, if there was one.
MaterialLaw fit_material_law(const MaterialLawScene& scene, const std::vector<VariantResult>& results,
                             const std::optional<StateFit>& states, std::uint64_t seed);

}  // namespace softgrain
