#include "microsim/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>

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

SettleResult normal_state(MeasurementState& state, double delta, const Protocol& protocol) {
  const CostMeter meter(state.experiment.system, state.run.normal_cost);
  protocol.approach(state.experiment, delta * state.experiment.spec.shell_radius);
  return protocol.settle(state.experiment, false);
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

void rotate_through(MeasurementState& state, double delta, const MeasurementPlan& plan, const Protocol& protocol) {
  SoftExperiment e = state.experiment;
  double from = 0.0;
  for (const double angle : visiting_order(plan)) {
    if (!plan.cumulative || angle * from <= 0.0) {
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
             const MeasurementObserver& observer) {
  for (std::size_t k = state.run.normal.size(); k < plan.deltas.size(); ++k) {
    const double delta = plan.deltas[k];
    const SettleResult rest = normal_state(state, delta, protocol);
    if (is_among(plan.tangential_deltas, delta)) {
      state.run.tangential.push_back(as_tangential(rest, delta, 0.0));
      rotate_through(state, delta, plan, protocol);
    }
    state.run.normal.push_back({delta, rest.force[0], rest.residual, rest.max_overlap, rest.converged});
    observer(state, static_cast<double>(k + 1) / static_cast<double>(plan.deltas.size()));
  }
}

}  // namespace softgrain
