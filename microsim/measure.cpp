#include "microsim/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>

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

TangentialPoint rotated_point(SoftExperiment& e, double delta, double from, double angle, const MeasurementPlan& plan,
                              const Protocol& protocol, Cost& cost) {
  const CostMeter meter(e.system, cost);
  e.rotate_first(angle - from, plan.rotation_step_deg, plan.shell_turns);
  return as_tangential(protocol.settle(e, true), delta, angle);
}

/// Angles in the order they are visited: as given, or outwards sign by sign for a cumulative sweep.
std::vector<double> visiting_order(const MeasurementPlan& plan) {
  std::vector<double> order = plan.angles_deg;
  if (plan.cumulative)
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

/// Goes on after the angles that are recorded. `between` is called where the next angle starts from the relaxed state.
void rotate_through(MeasurementState& state, double delta, const MeasurementPlan& plan, const Protocol& protocol,
                    const std::function<void()>& between) {
  if (recorded_rotations(state, delta) == 0) state.run.tangential.push_back(as_tangential(*state.rotating, delta, 0.0));
  const std::vector<double> order = visiting_order(plan);
  SoftExperiment e = state.experiment;
  double from = 0.0;
  for (std::size_t k = recorded_rotations(state, delta) - 1; k < order.size(); ++k) {
    const double angle = order[k];
    if (!plan.cumulative || angle * from <= 0.0) {
      between();
      e = state.experiment;
      from = 0.0;
    }
    state.run.tangential.push_back(rotated_point(e, delta, from, angle, plan, protocol, state.run.tangential_cost));
    from = angle;
  }
}

bool is_among(const std::vector<double>& values, double x) {
  return std::any_of(values.begin(), values.end(), [x](double v) { return std::abs(v - x) < 1e-9; });
}

}  // namespace

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
