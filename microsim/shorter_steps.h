// A stretch of dynamics that breaks off is done again with shorter time steps.
#pragma once

#include "common/core/error.h"
#include "microsim/soft_experiment.h"

namespace softgrain {

/// The time step of a stretch is chosen for the contacts at its beginning. A grain that gets wedged between stiffer
/// ones on the way can be thrown through its shell by a step that has become too long, which many large grains with
/// much friction between them bring about. Calls `stretch(halves)`, which is to run the whole stretch with its time
/// step divided by `halves`; when that ends with NotUsable, again from the same state with half the step, up to a
/// sixteenth. A stretch that goes through the first time is not touched. What was tried counts as cost.
template <class Stretch>
void with_steps_short_enough(SoftExperiment& e, const Stretch& stretch) {
  constexpr int kShortest = 16;
  const SoftExperiment before = e;
  for (int halves = 1;; halves *= 2) {
    try {
      stretch(halves);
      return;
    } catch (const NotUsable&) {
      if (halves == kShortest) throw;
      const Cost spent = e.system.cost;
      e = before;
      e.system.cost = spent;
    }
  }
}

}  // namespace softgrain
