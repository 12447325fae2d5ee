// Draws of a cell law from the errors that its card says.
#pragma once

#include <cstdint>

#include "common/data/cell_card.h"
#include "pipelines/law/law_draws.h"

namespace softgrain {

/// `count` draws of the numbers of a card, normal with its correlations (those of positive numbers in logarithms), each
/// as wide as its 95 % interval: that of few samples is Student's. Numbers without correlations, as those that no test
/// determined, are held, and LawDraws::origin names them. `name`: engine of the curves. Throws InputError for a card
/// without correlations.
LawDraws cell_draws(const CellCard& card, const std::string& name, std::int64_t count);

}  // namespace softgrain
