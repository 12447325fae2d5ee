#include "microsim/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

/// Adds what a piece of work cost to a Cost.
class CostMeter {
 public:
  CostMeter(const System3& system, Cost& to) : system_(system), to_(to), before_(system.cost), start_(Clock::now()) {}
  ~CostMeter() {
    to_.loop_passes += system_.cost.loop_passes - before_.loop_passes;
    to_.contact_evaluations += system_.cost.contact_evaluations - before_.contact_evaluations;
    to_.seconds += std::chrono::duration<double>(Clock::now() - start_).count();
  }
  CostMeter(const CostMeter&) = delete;
  CostMeter& operator=(const CostMeter&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  const System3& system_;
  Cost& to_;
  Cost before_;
  Clock::time_point start_;
};

SettleResult normal_state(MeasurementState& state, double delta, const Protocol& protocol, const RecordedState& look) {
  const CostMeter meter(state.experiment.system, state.run.normal_cost);
  protocol.approach(state.experiment, delta * state.experiment.spec.shell_radius);
  return protocol.settle(state.experiment, false, look);
}

TangentialPoint as_tangential(const SettleResult& rest, double delta, double angle) {
  return {delta, angle, rest.force[1], rest.force[2], rest.residual, rest.converged};
}

/// A turn under way: stretches of dynamics in which all grains of the first body are carried on at one rate. Full
/// stretches are counted from where it began, so that the state at an angle does not depend on the angles before it.
class SlowTurn {
 public:
  SlowTurn(const MeasurementPlan& plan, const Protocol& protocol) : plan_(plan), protocol_(protocol) {}

  /// Begins a turn from a relaxed state, which stands at `angle` [degree].
  void begin(const SoftExperiment& relaxed, double angle) {
    state_ = relaxed;
    stop_motion(state_.system.particles);
    origin_ = angle;
    stretches_ = 0;
  }

  /// Turns towards an angle as far as full stretches go.
  void go_towards(double angle) {
    for (const std::int64_t wanted = full_stretches(angle); stretches_ < wanted; ++stretches_)
      turn(state_, std::copysign(plan_.rotation_step_deg, angle - origin_));
  }

  /// The state as far as the turn has come; and at an angle beyond, the turn itself coming no nearer than full
  /// stretches.
  [[nodiscard]] const SoftExperiment& state() const { return state_; }
  [[nodiscard]] SoftExperiment at(double angle) {
    go_towards(angle);
    SoftExperiment e = state_;
    const double rest =
        std::abs(angle - origin_) - static_cast<double>(full_stretches(angle)) * plan_.rotation_step_deg;
    if (rest > kSameAngle * plan_.rotation_step_deg) turn(e, std::copysign(rest, angle - origin_));
    return e;
  }

 private:
  static constexpr double kSameAngle = 1e-6;  ///< share of a stretch below which angles count as the same

  [[nodiscard]] std::int64_t full_stretches(double angle) const {
    return static_cast<std::int64_t>(std::floor(std::abs(angle - origin_) / plan_.rotation_step_deg + kSameAngle));
  }

  void turn(SoftExperiment& e, double degrees) const {
    const double rate = std::copysign(turn_speed(plan_, e.spec) / e.spec.shell_radius, degrees);
    protocol_.run(e, e.turning(rate, plan_.shell_turns), degrees * std::numbers::pi / 180.0 / rate);
  }

  const MeasurementPlan& plan_;
  const Protocol& protocol_;
  SoftExperiment state_;
  double origin_ = 0.0;
  std::int64_t stretches_ = 0;
};

TangentialPoint rotated_point(SlowTurn& turn, double delta, double angle, bool go_on_from_it, const Protocol& protocol,
                              Cost& cost) {
  SoftExperiment e = turn.state();
  const CostMeter meter(e.system, cost);
  e = turn.at(angle);
  const TangentialPoint point = as_tangential(protocol.settle(e, true), delta, angle);
  if (go_on_from_it) turn.begin(e, angle);
  return point;
}

/// Outwards, sign by sign.
std::vector<double> visiting_order(const MeasurementPlan& plan) {
  std::vector<double> order = plan.angles_deg;
  std::stable_sort(order.begin(), order.end(), [](double a, double b) {
    if ((a < 0.0) != (b < 0.0)) return a < 0.0;
    return std::abs(a) < std::abs(b);
  });
  return order;
}

/// Tangential points of this overlap that are recorded, the one without rotation included.
std::size_t recorded_rotations(const MeasurementState& state, double delta) {
  const auto& points = state.run.tangential;
  return static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(), [delta](const TangentialPoint& p) { return p.delta == delta; }));
}

/// Goes on after the angles that are recorded. `between` is called where the run can be taken up again: before every
/// angle, or before the first of a sign where each goes on from the one before.
void rotate_through(MeasurementState& state, double delta, const MeasurementPlan& plan, const Protocol& protocol,
                    const std::function<void()>& between) {
  if (recorded_rotations(state, delta) == 0) state.run.tangential.push_back(as_tangential(*state.rotating, delta, 0.0));
  const std::vector<double> order = visiting_order(plan);
  const std::size_t first = recorded_rotations(state, delta) - 1;
  SlowTurn turn(plan, protocol);
  for (std::size_t k = first; k < order.size(); ++k) {
    const bool goes_on = k > 0 && order[k] * order[k - 1] > 0.0;
    if (!goes_on || !plan.cumulative) between();
    if (!goes_on || k == first) turn.begin(state.experiment, 0.0);
    if (goes_on && k == first) turn.go_towards(order[k - 1]);  // recorded, and paid for, before the run was left
    state.run.tangential.push_back(
        rotated_point(turn, delta, order[k], plan.cumulative, protocol, state.run.tangential_cost));
  }
}

bool is_among(const std::vector<double>& values, double x) {
  return std::any_of(values.begin(), values.end(), [x](double v) { return std::abs(v - x) < 1e-9; });
}

}  // namespace

double usual_turn_speed(const SoftParticleSpec& spec) { return published_speed(spec); }

double turn_speed(const MeasurementPlan& plan, const SoftParticleSpec& spec) {
  return plan.turn_speed > 0.0 ? plan.turn_speed : usual_turn_speed(spec);
}

void measure(MeasurementState& state, const MeasurementPlan& plan, const Protocol& protocol,
             const RunControl<MeasurementState>& control, const PointPicture& picture) {
  constexpr const char* kDoing = "measuring";
  RunKeeper keeper(control);
  const auto share = [&](std::size_t k) { return static_cast<double>(k) / static_cast<double>(plan.deltas.size()); };
  for (std::size_t k = state.run.normal.size(); k < plan.deltas.size(); ++k) {
    const double delta = plan.deltas[k];
    RecordedState look;
    if (picture) look = [&](const SoftExperiment& e) { picture(e, k); };
    if (!state.rotating) state.rotating = normal_state(state, delta, protocol, look);
    if (is_among(plan.tangential_deltas, delta))
      rotate_through(state, delta, plan, protocol, [&] { keeper.between_points(state, share(k), kDoing); });
    const SettleResult rest = *state.rotating;
    state.rotating.reset();
    state.run.normal.push_back({delta, rest.force[0], rest.residual, rest.max_overlap, rest.converged});
    keeper.at_point(state, share(k + 1), kDoing);
  }
}

}  // namespace softgrain
