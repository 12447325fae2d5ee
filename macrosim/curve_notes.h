// What a curve says of itself when something was not as it should be: the same words for all engines.
#pragma once

#include <string>

#include "common/data/macro_result.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/relaxation_result.h"

namespace softgrain {

/// A relaxation that did not converge makes the curve not usable. `tolerance` is what was asked for.
void note_relaxation(MacroCurve& curve, const RelaxationResult& rest, double strain, double tolerance);

/// Records how far laws were asked at a point; nothing for twins, which have no fitted law, and without soft particles.
void record_law_use(MacroCurve& curve, const LawUse& use);

/// Over all recorded points, at the end of a test; what happens beyond the range is that of `last`. A use that the law
/// refuses makes the curve not usable.
void note_law_use(MacroCurve& curve, const LawUse& last, double strain);

/// "macro run 'law': the centre of body 7 is behind a wall at strain 0.05"
std::string behind_wall_text(const std::string& engine, std::int64_t body, double strain);

}  // namespace softgrain
