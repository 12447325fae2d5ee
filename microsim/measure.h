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

/// The states that are recorded.
struct MeasurementPlan {
  std::vector<double> deltas;             ///< ascending, Delta = hn/Rs
  std::vector<double> tangential_deltas;  ///< subset of deltas at which the first body is rotated
  std::vector<double> angles_deg;   ///< rotations, both signs; each is reached from the relaxed state by one slow turn
                                    ///< unless `cumulative`
  double rotation_step_deg = 0.05;  ///< largest rotation in one stretch of dynamics, whose directions are those at its
                                    ///< begin
  bool shell_turns = true;          ///< whether the first shell turns with its grains
  bool cumulative = false;  ///< each angle goes on from the relaxed state of the one before of its sign: another path
  double turn_speed = 0.0;  ///< speed of the rim of the shell [m/s]; 0: usual_turn_speed()
};

/// Everything a measurement needs to go on.
struct MeasurementState {
  SoftExperiment experiment;
  PackingRun run;  ///< what was recorded so far; run.normal.size() says where to go on
  /// The relaxed state at the next overlap while the first body is rotated there; its tangential points that are
  /// recorded say how far that has come.
  std::optional<SettleResult> rotating;
};

/// 0.002 m/s at the published Rs, rho and E, scaled with sqrt(E/rho) otherwise [m/s]. A quarter of that moves the
/// secant at 1 degree by 4 % at most, and makes the slope over 0.05 degree 4 to 11 % steeper.
double usual_turn_speed(const SoftParticleSpec& spec);

/// Turn speed of a plan: the one that it gives, or the usual one [m/s].
double turn_speed(const MeasurementPlan& plan, const SoftParticleSpec& spec);

/// Is shown the relaxed state at overlap number `point` of the plan, as recorded, before any rotation.
using PointPicture = std::function<void(const SoftExperiment&, std::size_t point)>;

/// Goes through the plan from where `state` stands. A point is a recorded overlap with its tangential points; between
/// two of them the state is saved before rotations. Throws UnusableResult (lost grain...) and Interrupted.
void measure(MeasurementState& state, const MeasurementPlan& plan, const Protocol& protocol,
             const RunControl<MeasurementState>& control = {}, const PointPicture& picture = {});

}  // namespace softgrain
