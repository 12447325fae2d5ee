// How the errors of the numbers of a cell card go together.
#pragma once

#include <array>
#include <vector>

#include "calibrate/equation_of_state_fit.h"
#include "common/data/cell_card.h"

namespace softgrain {

/// Correlations of the numbers of a card whose errors are known. Those of the equation of state and of the pores are of
/// refits to the same drawn samples (StateFit::replicates and ExcessPoresFit::replicates), made smaller where an error
/// holds more than the scatter of its refits; those of faces are of their own fit, with the others as they are.
CellCorrelation correlation_of_card(const CellCard& card, const StateFit& states,
                                    const std::vector<std::array<double, 4>>& pores, const CellCorrelation& faces);

}  // namespace softgrain
