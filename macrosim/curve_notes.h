// What a curve says of itself when something was not as it should be: the same words for all engines.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/residual.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// A relaxation of one increment of a test and the number of that increment, from 1 after each recorded point.
struct IncrementRest {
  RelaxationResult rest;
  std::int64_t number = 0;
};

/// A relaxation that did not converge makes the curve not usable. `tolerance` is what was asked for; `of` says which
/// one it was, where that is not plain.
void note_relaxation(MacroCurve& curve, const RelaxationResult& rest, double strain, double tolerance,
                     const std::string& of = "");

/// Throws UnusableResult for a relaxation whose forces are no longer finite: there is no state to go on from.
void require_finite(const RelaxationResult& rest, const MacroCurve& curve);

/// Records the residual of the increment up to the last recorded point that ended farthest from rest
/// (MacroCurve::residual_largest). To be called after the point was recorded. A relaxation that did not converge makes
/// the curve not usable: points that follow it start from a state that was not at rest. The note is about the worst one
/// of the whole test.
void note_unrest(MacroCurve& curve, const IncrementRest& worst, const MacroStage& stage);

/// A stage whose stress the packing does not bear makes the curve not usable: what was asked along axes that go by
/// stress, what there is, and where. After note_relaxation().
void note_out_of_reach(MacroCurve& curve, const MacroStage& stage, const Vec3& asked);

/// Notes at the end of a test which stages are not what their names say. Stages that hold axes at the stress with which
/// they began, although it was zero, have free sides: another test than in a sample under stress. Stages that unload to
/// a higher stress, or reload to a lower one, make the curve not usable.
void note_stages(MacroCurve& curve, const MacroSpec& spec);

/// "'unload', 'unload 2'": names of the stages of a test that count; a long list is cut.
std::string stage_names(const MacroSpec& spec, const std::function<bool(const MacroStage&)>& counts);

/// What is to be said of a law without unloading branch in a test that unloads; empty where nothing is unloaded.
std::string no_unloading_text(const MacroSpec& spec, const std::string& law);

/// Records how far laws were asked at a point; nothing for twins, which have no fitted law, and without soft particles.
void record_law_use(MacroCurve& curve, const LawUse& use);

/// Notes at the end of a test how laws were used over all recorded points. What happens beyond the range is taken from
/// `last`. A use that the law refuses makes the curve not usable.
void note_law_use(MacroCurve& curve, const LawUse& last, double strain);

/// "macro run 'law': the centre of body 7 is behind a wall at strain 0.05"
std::string behind_wall_text(const std::string& engine, std::int64_t body, double strain);

}  // namespace softgrain
