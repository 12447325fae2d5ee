// The cell law, fitted to what was measured on fines, coarse grains and mixtures; void ratios of fines that are
// prepared otherwise.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/equation_of_state_fit.h"
#include "common/data/cell_card.h"
#include "common/data/macro_result.h"
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

/// Correlations of the numbers of a card whose errors are known. Those of the equation of state and of the pores are of
/// refits to the same drawn samples (StateFit::replicates and ExcessPoresFit::replicates), made smaller where an error
/// holds more than the scatter of its refits; those of faces are of their own fit, with the others as they are.
CellCorrelation correlation_of_card(const CellCard& card, const StateFit& states,
                                    const std::vector<std::array<double, 4>>& pores, const CellCorrelation& faces);

/// e_J of `other` over e_J of `own`, the mean over pairs of curves of the same sample that are both usable, with
/// Student's interval. The onset of a curve follows from its first point, by solid fraction and pressure, and the
/// equation of state p/E = K x^n. Both sides of a pair are of the same drawn grains, and errors of K and n cancel
/// between them. Empty where no sample has both.
std::optional<Estimate> preparation_factor(StateForm form, double modulus, double exponent,
                                           const std::vector<MacroCurve>& own, const std::vector<MacroCurve>& other);

}  // namespace softgrain
