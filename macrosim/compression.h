// Tests of a macro system, law-based or resolved, by relaxed increments of strain and stress.
#pragma once

#include <functional>

#include "common/data/macro_result.h"
#include "common/state/run_control.h"
#include "macrosim/curve_notes.h"
#include "macrosim/macro_system.h"
#include "macrosim/test_protocol.h"

namespace softgrain {

/// Everything a compression needs to go on.
struct CompressionState {
  MacroSystem macro;
  MacroCurve curve;             ///< what was recorded so far; curve.strain.size() says where to go on
  std::int64_t increments = 0;  ///< number of increments done since the last recorded point
  IncrementRest worst{};        ///< relaxation that ended farthest from rest among these increments
  bool over = false;            ///< whether the test ended before its last point
};

/// Adds to the curve what else somebody wants of a point that was recorded.
using PointRecord = std::function<void(const MacroSystem&, MacroCurve&)>;

/// Takes the box through the stages of the test (stages_of), increment by increment: strains axes that go by strain,
/// then relaxes the bodies, together with the axes that go by stress. Records strain (nominal from the start; of the
/// short form "shear" logarithmic from the end of the preload, which is recorded at -preload .. 0), stresses on the box
/// and from contacts, coordination, fabric, residual, and the forces between bodies of the last point.
/// Increments that did not converge make the curve not usable, with a note, whether a point follows them or further
/// increments; so does a law asked beyond its range that does
/// not allow it, and a stress that cannot be reached, and the test ends there. Throws UnusableResult (lost grain) and
/// Interrupted.
void compress(CompressionState& state, const MacroSpec& spec, const RunControl<CompressionState>& control = {},
              const PointRecord& also = {});

/// A curve with the facts of the packing filled in.
MacroCurve begin_curve(const MacroSpec& spec, const MacroPacking& packing, const MacroSystem& macro,
                       const std::string& engine, std::int64_t sample);

}  // namespace softgrain
