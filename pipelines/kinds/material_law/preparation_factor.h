// Void ratios of fines that are prepared otherwise, over those of the card's preparation.
#pragma once

#include <optional>
#include <vector>

#include "common/data/cell_card.h"
#include "common/data/macro_result.h"

namespace softgrain {

/// e_J of `other` over e_J of `own`, the mean over pairs of curves of the same sample that are both usable, with
/// Student's interval. The onset of a curve follows from its first point, by solid fraction and pressure, and the
/// equation of state p/E = K x^n. Both sides of a pair are of the same drawn grains, and errors of K and n cancel
/// between them. Empty where no sample has both.
std::optional<Estimate> preparation_factor(StateForm form, double modulus, double exponent,
                                           const std::vector<MacroCurve>& own, const std::vector<MacroCurve>& other);

}  // namespace softgrain
