// Oedometric, isotropic and shear tests of a macro system, law-based or resolved, by relaxed strain increments.
#pragma once

#include "common/data/macro_result.h"
#include "common/state/run_control.h"
#include "macrosim/macro_system.h"
#include "macrosim/test_protocol.h"

namespace softgrain {

/// Everything a compression needs to go on.
struct CompressionState {
  MacroSystem macro;
  MacroCurve curve;             ///< what was recorded so far; curve.strain.size() says where to go on
  std::int64_t increments = 0;  ///< done since, on the way to the next point
};

/// Strains the box step by step to spec.strain_end, relaxing every increment. Oedometric: the z planes move, four
/// stand; isotropic: all six; shear: all six to the nominal strain `preload`, then z shortens and x lengthens by equal
/// logarithmic strains while y stands. Records strain (nominal from the start; in shear logarithmic from the end of
/// the preload, which is recorded at -preload .. 0), wall and contact stresses, coordination, fabric, residual, and the
/// forces between bodies of the last point.
/// Points that did not converge make the curve not usable, with a note; so does a law asked beyond its range that does
/// not allow it, and the test ends there. Throws NotUsable (lost grain) and Interrupted.
void compress(CompressionState& state, const MacroSpec& spec, const RunControl<CompressionState>& control = {});

/// A curve with the facts of the packing filled in.
MacroCurve begin_curve(const MacroSpec& spec, const MacroPacking& packing, const MacroSystem& macro,
                       const std::string& engine, std::int64_t sample);

}  // namespace softgrain
