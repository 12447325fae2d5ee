// Powders under several pressures: what their consolidation came to, in words and pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/consolidation_fit.h"
#include "microsim/powder/powder_assembly.h"

namespace softgrain {

using PowderStages = std::vector<PowderStage>;  ///< stages of one sample

/// Consolidation fit over the rising pressures, for samples that reached all pressures. Empty where fewer than two
/// pressures rise.
std::optional<ConsolidationFit> consolidation_of(const std::vector<PowderStages>& samples);

/// "lambda = 0.118(4) for P* from 0.05 to 1.6, ..."; one line.
std::string consolidation_text(const ConsolidationFit& fit);

namespace report {
/// 1/Phi, z and moduli over P*: a row of figures with the fit; empty without several pressures.
std::string consolidation_figures(const std::vector<PowderStages>& samples);
}  // namespace report

}  // namespace softgrain
