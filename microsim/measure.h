// The measurement of one soft particle (or pair): normal force against overlap, tangential force against rotation
// [SP 1.4].
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/data/measurements.h"
#include "common/state/run_control.h"
#include "microsim/protocol.h"
#include "microsim/soft_experiment.h"

namespace softgrain {

/// Which states are recorded.
struct MeasurementPlan {
  std::vector<double> deltas;             ///< ascending, Delta = hn/Rs
  std::vector<double> tangential_deltas;  ///< subset of deltas at which the first body is rotated
  std::vector<double>
      angles_deg;  ///< rotations, both signs; each starts afresh from the relaxed state unless `cumulative`
  double rotation_step_deg = 0.01;  ///< largest rotation between two evaluations of the springs
  bool shell_turns = true;          ///< whether the first shell turns with its grains
  bool cumulative = false;          ///< each angle goes on from the one before of its sign: cheaper, another path
};

/// Everything a measurement needs to go on.
struct MeasurementState {
  SoftExperiment experiment;
  PackingRun run;  ///< what was recorded so far; run.normal.size() says where to go on
  /// The relaxed state at the next overlap while the first body is rotated there; its tangential points that are
  /// recorded say how far that has come.
  std::optional<SettleResult> rotating;
};

/// Is shown the relaxed state at overlap number `point` of the plan, as recorded, before any rotation.
using PointPicture = std::function<void(const SoftExperiment&, std::size_t point)>;

/// Goes through the plan from where `state` stands. A point is a recorded overlap with its tangential points; between
/// two of them the state is saved before rotations. Throws NotUsable (lost grain...) and Interrupted.
void measure(MeasurementState& state, const MeasurementPlan& plan, const Protocol& protocol,
             const RunControl<MeasurementState>& control = {}, const PointPicture& picture = {});

}  // namespace softgrain
