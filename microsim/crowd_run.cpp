// The way of a soft particle through its stages: increments, relaxations, recorded points.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/core/error.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/io/interrupt.h"
#include "microsim/crowd_experiment.h"
#include "microsim/protocol.h"

namespace softgrain {

namespace {

RelaxationResult relax(CrowdExperiment& e, const CrowdOptions& options, double tolerance) {
  DampedOptions damped;
  damped.tolerance = tolerance;
  damped.force_floor = force_floor(e.spec);
  damped.max_passes = options.max_passes;
  damped.least_stiffness = options.least_stiffness * e.spec.youngs_modulus;
  return DampedRelaxation<3>(damped).relax(e.system);
}

using Target = CrowdTarget;

/// `share` of the way from one to the other; exactly `to` at 1.
Target between(const Target& from, const Target& to, double share) {
  if (share == 1.0) return to;
  Target t{from.overlap, from.slide + share * (to.slide - from.slide)};
  for (std::size_t k = 0; k < t.overlap.size(); ++k) t.overlap[k] += share * (to.overlap[k] - from.overlap[k]);
  return t;
}

double distance(const Target& a, const Target& b) {
  double most = std::abs(a.slide - b.slide);
  for (std::size_t k = 0; k < a.overlap.size(); ++k) most = std::max(most, std::abs(a.overlap[k] - b.overlap[k]));
  return most;
}

std::int64_t steps_for(double length, double increment) {
  constexpr double kRounding = 1e-9;
  return std::max(std::int64_t{1}, static_cast<std::int64_t>(std::ceil(length / increment - kRounding)));
}

Target end_of(const CrowdStage& stage, double slide_before) { return {stage.overlap, slide_before + stage.slide}; }

CrowdPoint recorded(CrowdExperiment& e, const CrowdOptions& options, std::size_t stage) {
  const RelaxationResult rest = relax(e, options, options.tolerance);
  CrowdPoint point = e.observe();
  point.stage = static_cast<std::int64_t>(stage);
  point.residual = rest.residual;
  point.converged = rest.end == RelaxationEnd::converged;
  return point;
}

void require_plan(const CrowdConfiguration& c, const CrowdPlan& plan) {
  if (plan.size() != c.stages.size()) throw BadInput(c.name + ": the plan has another number of stages");
}

/// Goes on from a place in the plan, which is after an increment or at the very beginning.
class CrowdWalk {
 public:
  CrowdWalk(CrowdExperiment& e, const CrowdPlan& plan, const CrowdOptions& options,
            const RunControl<CrowdUnderWay>& control, CrowdPlace start)
      : e_(e), plan_(plan), options_(options), control_(control), at_(std::move(start)), due_(control.seconds) {}

  CrowdRun run() {
    for (; at_.stage < plan_.size(); ++at_.stage, at_.leg = 0) {
      if (at_.leg == 0 && at_.increments == 0) at_.stage_from = {e_.overlap, e_.slide};
      walk_stage();
    }
    count_time();
    at_.run.cost.loop_passes = e_.system.cost.loop_passes;
    at_.run.cost.contact_evaluations = e_.system.cost.contact_evaluations;
    return std::move(at_.run);
  }

 private:
  /// A leg to each recorded point and one to the end, which is empty when the end was recorded.
  void walk_stage() {
    const Target to = end_of(e_.configuration.stages[at_.stage], at_.stage_from.slide);
    const std::vector<double>& shares = plan_[at_.stage];
    for (; at_.leg <= shares.size(); ++at_.leg, at_.increments = 0) {
      const bool last = at_.leg == shares.size();
      if (at_.increments == 0) at_.leg_from = {e_.overlap, e_.slide};
      walk_leg(last ? to : between(at_.stage_from, to, shares[at_.leg]));
      if (last) continue;
      at_.run.points.push_back(recorded(e_, options_, at_.stage));
      if (control_.progress) control_.progress({at_, e_}, share_done());
    }
  }
  void walk_leg(const Target& to) {
    const double length = distance(at_.leg_from, to);
    if (length <= 0.0) return;
    const std::int64_t steps = steps_for(length, options_.increment);
    while (at_.increments < steps) {
      const double share = static_cast<double>(at_.increments + 1) / static_cast<double>(steps);
      const Target next = between(at_.leg_from, to, share);
      e_.move_to(next.overlap, next.slide);
      relax(e_, options_, options_.tolerance_between);
      ++at_.increments;
      pause_if_asked();
    }
  }
  void pause_if_asked() {
    if (control_.save && (interrupt_requested() || due_.due())) {
      count_time();
      control_.save({at_, e_});
    }
    stop_if_interrupted("pressing a soft particle");
  }
  /// By recorded points.
  [[nodiscard]] double share_done() const {
    std::size_t points = 0;
    for (const auto& shares : plan_) points += shares.size();
    return static_cast<double>(at_.run.points.size()) / static_cast<double>(points);
  }
  void count_time() {
    const auto now = std::chrono::steady_clock::now();
    at_.run.cost.seconds += std::chrono::duration<double>(now - started_).count();
    started_ = now;
  }

  CrowdExperiment& e_;
  const CrowdPlan& plan_;
  const CrowdOptions& options_;
  const RunControl<CrowdUnderWay>& control_;
  CrowdPlace at_;
  CheckpointClock due_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace

CrowdRun run_crowd(CrowdExperiment& e, const CrowdPlan& plan, const CrowdOptions& options,
                   const RunControl<CrowdUnderWay>& control, CrowdPlace start) {
  require_plan(e.configuration, plan);
  return CrowdWalk(e, plan, options, control, std::move(start)).run();
}

std::int64_t count_increments(const CrowdConfiguration& configuration, const CrowdPlan& plan,
                              const CrowdOptions& options) {
  require_plan(configuration, plan);
  std::int64_t count = 0;
  Target from{std::vector<double>(configuration.partners.size(), 0.0), 0.0};
  for (std::size_t k = 0; k < plan.size(); ++k) {
    const Target to = end_of(configuration.stages[k], from.slide);
    double done = 0.0;
    for (const double share : plan[k]) {
      count += steps_for((share - done) * distance(from, to), options.increment);
      done = share;
    }
    if (done < 1.0) count += steps_for((1.0 - done) * distance(from, to), options.increment);
    from = to;
  }
  return count;
}

}  // namespace softgrain
