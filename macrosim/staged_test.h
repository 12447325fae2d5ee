// The loop of a test in stages, one for all engines: increments, recorded points, checkpoints, and when it is over.
#pragma once

#include <optional>

#include "common/core/law_range.h"
#include "common/data/macro_result.h"
#include "common/dynamics/residual.h"
#include "common/state/run_control.h"
#include "macrosim/curve_notes.h"
#include "macrosim/macro_packing.h"
#include "macrosim/pressed_box.h"
#include "macrosim/test_protocol.h"

namespace softgrain {

/// Strains, stage and stresses of a recorded point: of a room of this size, with these stresses along its axes [Pa].
void record_stress_strain(MacroCurve& curve, const MacroSpec& spec, std::int64_t stage, const Vec3& size,
                          const Vec3& stress);

/// Bodies, box and test of a curve before its first point.
MacroCurve blank_curve(const MacroSpec& spec, const MacroPacking& packing, const std::string& engine,
                       std::int64_t sample);

/// What holds the axes in an increment that ends at this stress.
BoxControl box_control(const MacroSpec& spec, const MacroStage& stage, const Vec3& stress);

/// Where every axis goes to its stress, the mean stress comes first, without change of shape, to kRoughly times the
/// tolerance: a loose packing that is pressed from all sides at once hardly resists one, and would take any. Empty
/// where that is not so.
std::optional<BoxControl> mean_first(const MacroSpec& spec, const MacroStage& stage, const Vec3& stress);
inline constexpr double kRoughly = 10.0;

/// State: `curve`, `increments` done since its last point, of these the one that is farthest from rest, `worst`, and
/// `over`. Engine, for a state:
///   RelaxationResult step(State&, const MacroStage&, const Vec3& strain, const std::optional<Vec3>& stress): one
///     increment, to rest; without a stress no axis is held by one, while a stress of zero leaves the sides free;
///   void record(State&, const MacroStage&, std::int64_t number, const RelaxationResult&): a point of stage `number`;
///     the relaxations of the increments before it are judged by note_unrest();
///   LawUse watch(State&): how far laws are asked; refused: the test ends;
///   void note_use(State&, const LawUse& last): at its end, what is to be said of that;
///   bool ended(State&): a test that goes on had ended so.
/// A stress that the packing cannot bear ends the test: what comes after would start from nowhere. Throws
/// UnusableResult where forces are no longer finite.
template <class State, class Engine>
void run_stages(State& state, const MacroSpec& spec, const Engine& engine, const RunControl<State>& control) {
  constexpr const char* kDoing = "straining; all up to here is saved";
  const std::vector<MacroStage> stages = stages_of(spec);
  const std::int64_t points = recorded_points(spec);
  RunKeeper keeper(control);
  if (state.over || engine.ended(state)) return;
  while (static_cast<std::int64_t>(state.curve.strain.size()) < points) {
    const auto point = static_cast<std::int64_t>(state.curve.strain.size());
    const StagePoint at = stage_point(stages, point);
    const MacroStage& stage = stages[static_cast<std::size_t>(at.stage)];
    const auto share = [&] {
      const auto way = static_cast<double>(state.increments) / static_cast<double>(stage.increments_per_step);
      return (static_cast<double>(point) + way) / static_cast<double>(points);
    };
    RelaxationResult rest;
    std::optional<Vec3> asked;
    if (point == 0) {
      rest = engine.step(state, stage, {}, std::nullopt);
      require_finite(rest, state.curve);
      state.worst = {rest, 1};
    }
    const auto starts = point > 0 ? stage_starts(stages, state.curve, point) : std::vector<Vec3>{};
    while (point > 0 && state.increments < stage.increments_per_step) {
      const std::int64_t n = (at.number - 1) * stage.increments_per_step + state.increments + 1;
      if (stage.by_stress()) asked = stress_at(stage, n, starts);
      rest = engine.step(state, stage, strain_increment(stage, n), asked);
      require_finite(rest, state.curve);
      ++state.increments;
      if (state.increments == 1 || farther_from_rest(rest, state.worst.rest)) state.worst = {rest, state.increments};
      if (stage.by_stress() && rest.end != RelaxationEnd::converged) break;
      // After the last one the point is recorded, which needs what the relaxation said.
      if (state.increments < stage.increments_per_step) keeper.between_points(state, share(), kDoing);
    }
    state.increments = 0;
    engine.record(state, stage, at.stage, rest);
    const LawUse use = engine.watch(state);
    if (point > 0 && stage.by_stress() && rest.end != RelaxationEnd::converged) {
      note_out_of_reach(state.curve, stage, *asked);
      state.over = true;
    }
    const bool last = point + 1 == points || state.over;
    if (last || use.rejected > 0) {
      engine.note_use(state, use);
      note_stages(state.curve, spec);
    }
    keeper.at_point(state, static_cast<double>(point + 1) / static_cast<double>(points), kDoing);
    if (use.rejected > 0 || state.over) return;
  }
}

}  // namespace softgrain
