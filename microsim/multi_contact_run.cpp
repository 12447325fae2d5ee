// The way of a soft particle through its stages: increments, relaxations, recorded points.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "common/core/error.h"
#include "common/data/multi_contact_measurements.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"
#include "common/neighbours/verlet_list.h"
#include "microsim/multi_contact_experiment.h"
#include "microsim/protocol.h"

namespace softgrain {

namespace {

/// Relaxes without inertia; springs and forces of the state it ends in are in place.
RelaxationResult relax(MultiContactExperiment& e, const MultiContactOptions& options, double tolerance) {
  DampedOptions damped;
  damped.tolerance = tolerance;
  damped.force_floor = force_floor(e.spec);
  damped.max_passes = options.max_passes;
  damped.least_stiffness = options.least_stiffness * e.spec.youngs_modulus;
  return DampedRelaxation<3>(damped).relax(e.system);
}

using Target = MultiContactTarget;

/// `share` of the way from one to the other; exactly `to` at 1.
Target between(const Target& from, const Target& to, double share) {
  if (share == 1.0) return to;
  Target t{from.overlap, from.slide + share * (to.slide - from.slide), from.roll + share * (to.roll - from.roll)};
  for (std::size_t k = 0; k < t.overlap.size(); ++k) t.overlap[k] += share * (to.overlap[k] - from.overlap[k]);
  return t;
}

double distance(const Target& a, const Target& b) {
  double most = std::max(std::abs(a.slide - b.slide), std::abs(a.roll - b.roll));
  for (std::size_t k = 0; k < a.overlap.size(); ++k) most = std::max(most, std::abs(a.overlap[k] - b.overlap[k]));
  return most;
}

std::int64_t steps_for(double length, double increment) {
  constexpr double kRounding = 1e-9;
  return std::max(std::int64_t{1}, static_cast<std::int64_t>(std::ceil(length / increment - kRounding)));
}

Target end_of(const MultiContactStage& stage, const Target& before) {
  return {stage.overlap, before.slide + stage.slide, before.roll + stage.roll};
}

/// Brings a pack from one prescribed position to the next, and to the rest in which it is recorded.
class Mover {
 public:
  Mover() = default;
  virtual ~Mover() = default;
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;

  virtual void go(MultiContactExperiment& e, const Target& to) const = 0;
  virtual MultiContactPoint record(MultiContactExperiment& e) const = 0;
};

MultiContactPoint observed(const MultiContactExperiment& e, double residual, bool converged) {
  MultiContactPoint point = e.observe();
  point.residual = residual;
  point.converged = converged;
  return point;
}

class DampedMover : public Mover {
 public:
  explicit DampedMover(const MultiContactOptions& options) : options_(options) {}

  void go(MultiContactExperiment& e, const Target& to) const override {
    e.move_to(to);
    relax(e, options_, options_.tolerance_between);
  }
  MultiContactPoint record(MultiContactExperiment& e) const override {
    const RelaxationResult rest = relax(e, options_, options_.tolerance);
    return observed(e, rest.residual, rest.end == RelaxationEnd::converged);
  }

 private:
  const MultiContactOptions& options_;
};

/// What slow dynamics and the published protocol share: neighbours go at a speed.
class MovingMover : public Mover {
 public:
  explicit MovingMover(const MultiContactOptions& options) : options_(options) {}

  void go(MultiContactExperiment& e, const Target& to) const override {
    const double length = distance(e.now(), to) * e.spec.shell_radius;
    if (length <= 0.0) return;
    const double duration =
        length / (options_.approach_speed > 0.0 ? options_.approach_speed : published_speed(e.spec));
    const double rolled = to.roll - e.roll;
    std::vector<Vec3> velocity = e.prescribe(to);
    for (Vec3& v : velocity) v *= 1.0 / duration;
    move(e, rolled == 0.0 ? driven_at(std::move(velocity)) : rolling(e, velocity, rolled / duration), duration);
  }

 protected:
  virtual void move(MultiContactExperiment& e, const Drive& drive, double duration) const = 0;
  [[nodiscard]] const MultiContactOptions& options() const { return options_; }

 private:
  /// The first neighbour, where it is a sphere, turns so that it does not slide where it touches: its centre goes at
  /// (1 + ratio - h) / (1 - h/2) times the rate of its contact, at an arm of ratio - h/2.
  static Drive rolling(const MultiContactExperiment& e, std::vector<Vec3> velocity, double rate) {
    const MultiContactPartner& p = e.configuration.partners[0];
    if (p.kind == PartnerKind::plane) return {};
    const double h = e.overlap[0];
    const double turn = rate * (1.0 + p.ratio - h) / ((1.0 - 0.5 * h) * (p.ratio - 0.5 * h));
    const Vec3 spin = cross(p.direction, slide_direction(p.direction)) * turn;
    const MultiContactExperiment::Neighbour& ball = e.neighbours[0];
    const Vec3 centre = e.system.particles.sphere[at(ball.body)].x;
    std::vector<Vec3> spins(velocity.size());
    for (Slot i = ball.begin; i < ball.end; ++i) {
      velocity[at(i)] += cross(spin, e.system.particles.sphere[at(i)].x - centre);
      spins[at(i)] = spin;
    }
    spins[at(ball.body)] = spin;
    return driven_at(std::move(velocity), std::move(spins));
  }

  const MultiContactOptions& options_;
};

class SlowMover : public MovingMover {
 public:
  using MovingMover::MovingMover;

  /// The way goes on from the settled state; what is recorded is a copy brought to its equilibrium nearby.
  MultiContactPoint record(MultiContactExperiment& e) const override {
    move(e, {}, options().settle_time * natural_time(e.spec));
    stop_motion(e.system.particles);
    MultiContactExperiment rested = e;
    const RelaxationResult rest = relax(rested, options(), options().tolerance);
    e.system.cost = rested.system.cost;
    return observed(rested, rest.residual, rest.end == RelaxationEnd::converged);
  }

 private:
  void move(MultiContactExperiment& e, const Drive& drive, double duration) const override {
    if (duration > 0.0) run_slow(e, drive, duration, options().step_factor);
  }
};

/// Dynamics with the bodies' own masses, as published.
class PublishedMover : public MovingMover {
 public:
  using MovingMover::MovingMover;

  MultiContactPoint record(MultiContactExperiment& e) const override {
    const PublishedOptions published;
    for (int k = 0; k <= published.stops; ++k) {
      if (k > 0) stop_motion(e.system.particles);
      move(e, {}, published_interval(e.spec));
    }
    const double left = residual(e.system).relative(force_floor(e.spec));
    return observed(e, left, left <= options().tolerance);
  }

 private:
  void move(MultiContactExperiment& e, const Drive& drive, double duration) const override {
    const PublishedOptions published;
    const double dt = real_mass_step(e.system, published.step_fraction, published.crowded_fraction);
    const auto steps = static_cast<std::int64_t>(std::max(1.0, std::ceil(duration / dt)));
    with_steps_short_enough(e, [&](int halves) {
      e.set_damping(true);
      run_steps(e.system, drive, duration / static_cast<double>(steps * halves), steps * halves, StretchMasses::real);
      e.set_damping(false);
      update_neighbours(e.system);
    });
  }
};

std::unique_ptr<Mover> mover_of(const MultiContactOptions& options) {
  switch (options.relaxation) {
    case Relaxation::damped:
      return std::make_unique<DampedMover>(options);
    case Relaxation::slow_dynamics:
      return std::make_unique<SlowMover>(options);
    case Relaxation::published:
      return std::make_unique<PublishedMover>(options);
    case Relaxation::least_work:
      break;
  }
  throw InputError("several neighbours: relaxation least-work is for one neighbour alone");
}

void require_plan(const MultiContactConfiguration& c, const MultiContactPlan& plan) {
  if (plan.size() != c.stages.size()) throw InputError(c.name + ": the plan has another number of stages");
}

/// Goes on from a place in the plan, which is after an increment or at the very beginning.
class MultiContactWalk {
 public:
  MultiContactWalk(MultiContactExperiment& e, const MultiContactPlan& plan, const MultiContactOptions& options,
                   const RunControl<MultiContactUnderWay>& control, MultiContactPlace start)
      : e_(e),
        plan_(plan),
        options_(options),
        mover_(mover_of(options)),
        control_(control),
        at_(std::move(start)),
        due_(control.seconds) {}

  MultiContactRun run() {
    for (; at_.stage < plan_.size(); ++at_.stage, at_.leg = 0) {
      if (at_.leg == 0 && at_.increments == 0) at_.stage_from = e_.now();
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
    const Target to = end_of(e_.configuration.stages[at_.stage], at_.stage_from);
    const std::vector<double>& shares = plan_[at_.stage];
    for (; at_.leg <= shares.size(); ++at_.leg, at_.increments = 0) {
      const bool last = at_.leg == shares.size();
      if (at_.increments == 0) at_.leg_from = e_.now();
      walk_leg(last ? to : between(at_.stage_from, to, shares[at_.leg]));
      if (last) continue;
      at_.run.points.push_back(mover_->record(e_));
      at_.run.points.back().stage = static_cast<std::int64_t>(at_.stage);
      if (control_.progress) control_.progress({at_, e_}, share_done());
    }
  }
  void walk_leg(const Target& to) {
    const double length = distance(at_.leg_from, to);
    if (length <= 0.0) return;
    const std::int64_t steps = steps_for(length, options_.increment);
    while (at_.increments < steps) {
      const double share = static_cast<double>(at_.increments + 1) / static_cast<double>(steps);
      mover_->go(e_, between(at_.leg_from, to, share));
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
  /// Share of the run that is done, by recorded points.
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

  MultiContactExperiment& e_;
  const MultiContactPlan& plan_;
  const MultiContactOptions& options_;
  std::unique_ptr<Mover> mover_;
  const RunControl<MultiContactUnderWay>& control_;
  MultiContactPlace at_;
  CheckpointClock due_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace

std::string relaxation_text(const MultiContactOptions& o) {
  const std::string name = to_string(o.relaxation);
  if (o.relaxation == Relaxation::damped)
    return fmt::format("{}, increments of {} Rs, residual {} ({} between)", name, o.increment, o.tolerance,
                       o.tolerance_between);
  const std::string speed = o.approach_speed > 0.0 ? fmt::format("{} m/s", o.approach_speed) : "the published speed";
  if (o.relaxation == Relaxation::published) return fmt::format("{}, at {}", name, speed);
  return fmt::format("{}, at {}, steps x {}, settling {} Rs sqrt(rho/E), residual {}", name, speed, o.step_factor,
                     o.settle_time, o.tolerance);
}

MultiContactRun run_multi_contact(MultiContactExperiment& e, const MultiContactPlan& plan,
                                  const MultiContactOptions& options, const RunControl<MultiContactUnderWay>& control,
                                  MultiContactPlace start) {
  require_plan(e.configuration, plan);
  return MultiContactWalk(e, plan, options, control, std::move(start)).run();
}

std::int64_t count_increments(const MultiContactConfiguration& configuration, const MultiContactPlan& plan,
                              const MultiContactOptions& options) {
  require_plan(configuration, plan);
  std::int64_t count = 0;
  Target from{std::vector<double>(configuration.partners.size(), 0.0), 0.0, 0.0};
  for (std::size_t k = 0; k < plan.size(); ++k) {
    const Target to = end_of(configuration.stages[k], from);
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
