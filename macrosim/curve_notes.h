// What a curve says of itself when something was not as it should be: the same words for all engines.
#pragma once

#include <string>

#include "common/data/macro_result.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/relaxation_result.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// A relaxation that did not converge makes the curve not usable. `tolerance` is what was asked for.
void note_relaxation(MacroCurve& curve, const RelaxationResult& rest, double strain, double tolerance);

/// A stage whose stress the packing does not bear makes the curve not usable: what was asked along axes that go by
/// stress, what there is, and where. After note_relaxation().
void note_out_of_reach(MacroCurve& curve, const MacroStage& stage, const Vec3& asked);

/// Records how far laws were asked at a point; nothing for twins, which have no fitted law, and without soft particles.
void record_law_use(MacroCurve& curve, const LawUse& use);

/// Over all recorded points, at the end of a test; what happens beyond the range is that of `last`. A use that the law
/// refuses makes the curve not usable.
void note_law_use(MacroCurve& curve, const LawUse& last, double strain);

/// "macro run 'law': the centre of body 7 is behind a wall at strain 0.05"
std::string behind_wall_text(const std::string& engine, std::int64_t body, double strain);

}  // namespace softgrain
