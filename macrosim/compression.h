// Oedometric and isotropic compression of a macro system, law-based or resolved, by relaxed strain increments.
#pragma once

#include <functional>

#include "common/data/macro_result.h"
#include "macrosim/macro_system.h"

namespace softgrain {

/// Everything a compression needs to go on after a recorded point.
struct CompressionState {
  MacroSystem macro;
  MacroCurve curve;  ///< what was recorded so far; curve.strain.size() says where to go on
};

/// Called after each recorded point.
using CompressionObserver = std::function<void(const CompressionState&, double share_done)>;

/// Strains the box step by step to spec.strain_end (oedometric: z planes move, four stand; isotropic: all six),
/// relaxing every increment; records strain (from the start), wall stress, contact stress, coordination, residual.
/// Points that did not converge make the curve not usable, with a note. Throws NotUsable (lost grain) and Interrupted.
void compress(CompressionState& state, const MacroSpec& spec, const CompressionObserver& observer);

/// A curve with the facts of the packing filled in.
MacroCurve begin_curve(const MacroSpec& spec, const MacroPacking& packing, const MacroSystem& macro,
                       const std::string& engine, std::int64_t sample);

}  // namespace softgrain
