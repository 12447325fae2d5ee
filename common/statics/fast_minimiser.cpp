// The fast minimiser: steps of a symmetric linearised pack, solved by preconditioned conjugate gradient only as far as
// they pay. A sliding contact enters with its secant stiffness Q/u_s, which never overshoots. Anderson mixing takes out
// the few directions (rattlers that roll and slide) that would converge slowly. Floppy grains are held by a small
// spring that fades as steps succeed. Near the answer Newton steps with the exact, unsymmetric stiffness of sliding
// contacts need far fewer linearisations; where they do not (a contact that changes between stick and slip) the
// symmetric steps go on.
#include <algorithm>
#include <cmath>

#include "common/io/interrupt.h"
#include "common/statics/minimiser.h"
#include "common/statics/stiffness.h"
#include "common/statics/unknowns.h"

namespace softgrain::statics {

namespace {

constexpr double kBlockFloor = 1e-2;             // of the preconditioner
constexpr double kMaxMove = 0.05;                // of the radius, per step and grain
constexpr int kSearchPasses = 8;                 // per step
constexpr std::int64_t kLinearIterations = 400;  // per step
constexpr std::size_t kMemory = 5;               // steps that are mixed
constexpr double kMixBelow = 0.1;                // worst residual from which steps are mixed
constexpr double kFirstSpring = 1e-4;            // holding spring, in the stiffness of the grain's own contacts
constexpr double kLeastSpring = 1e-7;
constexpr double kMostSpring = 1e-2;
constexpr double kLinearReduction = 0.1;  // of the residual of a linear system, and its least value
constexpr double kLeastReduction = 1e-3;
constexpr double kNewtonReduction = 0.1;             // of a linear system; 0.02 to 0.3 were tried
constexpr std::int64_t kNewtonIterations = 200;      // applications of the stiffness
constexpr double kNewtonParts[] = {1.0, 0.4, 0.16};  // of a Newton step, tried in this order
constexpr double kGoodNewton = 0.5;          // a whole step that leaves less of the force than this is a good one
constexpr double kPoorNewton = 0.8;          // any step that leaves more than this is a poor one
constexpr std::int64_t kLongestPause = 128;  // symmetric steps after Newton steps that were not

class Stepper {
 public:
  Stepper(PackProblem& problem, Unknowns& theta) : problem_(problem), theta_(theta) {
    problem_.evaluate(theta_, forces_);
  }
  [[nodiscard]] const PackForces& forces() const { return forces_; }
  [[nodiscard]] std::int64_t factorisations() const { return factorisations_; }
  [[nodiscard]] std::int64_t linear_iterations() const { return linear_iterations_; }

  void relax_rattlers(double least_force, double tolerance) {
    if (statics::relax_rattlers(problem_, forces_, least_force, tolerance, theta_)) problem_.evaluate(theta_, forces_);
  }

  /// One step; false when no direction leads to a better balance.
  bool step(bool mix) {
    linearise();
    if (mix && newton_due()) {
      if (newton_step()) return true;
      linearise();  // what was tried may have made a new list of contacts
    }
    const bool indefinite = solve();
    clip(direction_);
    if (mix) {
      Unknowns mixed = mixing_.mixed(theta_, direction_, inverse_.stiffness());
      clip(mixed);
      if (dot(forces_.force, mixed) > 0.0) direction_ = std::move(mixed);
    } else {
      mixing_.forget();
    }
    if (!(dot(forces_.force, direction_) > 0.0)) {
      // The preconditioned force itself always leads down.
      precondition(forces_.force, direction_);
      clip(direction_);
    }
    double taken = 0.0;
    if (!search(taken)) return false;
    if (indefinite || taken < 0.5) {
      spring_ = std::min(kMostSpring, 10.0 * spring_);
    } else if (taken >= 1.0) {
      spring_ = std::max(kLeastSpring, spring_ / 3.0);
    }
    return true;
  }

 private:
  void linearise() {
    problem_.linearise(theta_, tangents_);
    // Under the even deformation that starts an increment many contacts seem to slide that will not.
    if (factorisations_ == 0)
      for (LinkTangent& t : tangents_) t.tangential = t.stick;
    inverse_.build(problem_, tangents_, kBlockFloor);
    ++factorisations_;
  }

  /// Whether exact stiffness differs from the symmetric one, and Newton steps have not failed lately.
  bool newton_due() {
    if (std::none_of(tangents_.begin(), tangents_.end(), [](const LinkTangent& t) { return t.drag != 0.0; }))
      return false;
    return pause_ == 0 || --pause_ == 0;
  }

  /// A step with the exact stiffness; false, and nothing has changed, when it does not reduce the force. After a poor
  /// step the next ones are symmetric, twice as many each time.
  bool newton_step() {
    const double first = std::sqrt(dot(forces_.force, forces_.force));
    const KrylovResult k = solve_exactly();
    bool better = false;
    if (k.reduction < kGoodNewton) {
      clip(direction_);
      const Unknowns start = theta_;
      const PackForces before = forces_;
      for (const double part : kNewtonParts) {
        force_along(start, part);
        const double left = std::sqrt(dot(forces_.force, forces_.force)) / first;
        better = left < 1.0 - 0.2 * part;
        if (!better) continue;
        mixing_.forget();
        last2_ = 0.0;
        if (left > kPoorNewton) break;
        if (part == 1.0 && left <= kGoodNewton) pause_after_ = 1;
        return true;
      }
      if (!better) {
        theta_ = start;
        forces_ = before;
      }
    }
    pause_ = pause_after_;
    pause_after_ = std::min(2 * pause_after_, kLongestPause);
    return better;
  }

  KrylovResult solve_exactly() {
    const Stiffness stiffness(problem_, tangents_, Sliding::exact);
    const auto map = [&](const Unknowns& in, Unknowns& out) { held(stiffness, in, out); };
    const auto inverse = [&](const Unknowns& in, Unknowns& out) { precondition(in, out); };
    const KrylovResult k =
        biconjugate_gradient(map, inverse, forces_.force, kNewtonReduction, kNewtonIterations, direction_);
    linear_iterations_ += k.iterations;
    return k;
  }

  /// Stiffness with the holding spring.
  void held(const Stiffness& stiffness, const Unknowns& in, Unknowns& out) const {
    stiffness.apply(in, out);
    inverse_.add_diagonal(in, spring_, out);
    problem_.symmetry().project(out, problem_.stride());
  }

  void precondition(const Unknowns& in, Unknowns& out) const {
    inverse_.apply(in, out);
    problem_.symmetry().project(out, problem_.stride());
  }

  /// True when the conjugate gradient met negative stiffness.
  bool solve() {
    const Stiffness stiffness(problem_, tangents_);
    const auto map = [&](const Unknowns& in, Unknowns& out) { held(stiffness, in, out); };
    const auto inverse = [&](const Unknowns& in, Unknowns& out) { precondition(in, out); };
    const KrylovResult k = conjugate_gradient(map, inverse, forces_.force, reduction(), kLinearIterations, direction_);
    linear_iterations_ += k.iterations;
    return k.indefinite;
  }

  /// Linear systems are solved better when the last step was a good one (Eisenstat and Walker's second choice).
  double reduction() {
    const double size2 = dot(forces_.force, forces_.force);
    const double wanted = last2_ > 0.0 ? 0.9 * size2 / last2_ : kLinearReduction;
    last2_ = size2;
    return std::clamp(wanted, kLeastReduction, kLinearReduction);
  }

  /// Shortens the move of every grain that goes too far, and only that: a rattler must not hold up the pack.
  void clip(Unknowns& d) const {
    const auto width = static_cast<std::size_t>(problem_.stride());
    const std::vector<double>& radius = problem_.pack().radius;
    for (std::size_t g = 0; g < radius.size(); ++g) {
      double most = 0.0;
      for (std::size_t k = g * width; k < (g + 1) * width; ++k) most = std::max(most, std::abs(d[k]));
      const double limit = kMaxMove * radius[g];
      if (most > limit)
        for (std::size_t k = g * width; k < (g + 1) * width; ++k) d[k] *= limit / most;
    }
  }

  double force_along(const Unknowns& start, double part) {
    theta_ = start;
    add_scaled(theta_, part, direction_);
    problem_.evaluate(theta_, forces_);
    return dot(forces_.force, direction_);
  }

  /// Goes along the direction until its force has halved (at most the whole step), by bracketed secants.
  bool search(double& taken) {
    const double first = dot(forces_.force, direction_);
    if (!(first > 0.0)) return false;
    const Unknowns start = theta_;
    double low = 0.0;
    double low_force = first;
    double high = 1.0;
    double part = 1.0;
    for (int k = 0; k < kSearchPasses; ++k) {
      const double along = force_along(start, part);
      if (!std::isfinite(along)) return false;
      taken = part;
      if (std::abs(along) <= 0.5 * first || (along > 0.0 && part >= 1.0)) break;
      if (along < 0.0) {
        high = part;
        part = low + (high - low) * std::clamp(low_force / (low_force - along), 0.05, 0.95);
      } else {
        const double wanted = part + along * (part - low) / (low_force - along);
        low = part;
        low_force = along;
        const double middle = 0.5 * (low + high);
        part = wanted > low && wanted < high ? std::clamp(wanted, low + 0.05 * (high - low), low + 0.95 * (high - low))
                                             : middle;
      }
    }
    return true;
  }

  PackProblem& problem_;
  Unknowns& theta_;
  PackForces forces_;
  std::vector<LinkTangent> tangents_;
  BlockJacobi inverse_;
  AndersonMixing mixing_{kMemory};
  Unknowns direction_;
  double spring_ = kFirstSpring;
  double last2_ = 0.0;
  std::int64_t pause_ = 0;        ///< symmetric steps until the next Newton step
  std::int64_t pause_after_ = 1;  ///< a poor Newton step
  std::int64_t linear_iterations_ = 0;
  std::int64_t factorisations_ = 0;
};

}  // namespace

namespace {

/// Whether rattlers are relaxed one by one in this iteration. With strong friction (mu = 5) this and mixing the steps
/// of all grains can undo each other for ever, so it pauses every now and then.
bool rattlers_turn(std::int64_t iteration) {
  constexpr std::int64_t kTurn = 200;
  return iteration > 0 && (iteration / kTurn) % 2 == 0;
}

}  // namespace

LeastWorkResult minimise_fast(PackProblem& problem, Unknowns& theta, const LeastWorkOptions& options) {
  LeastWorkResult result;
  const Scales scales = scales_of(problem.pack(), options);
  problem.set_walls(1.0);
  theta = affine_guess(problem, 1.0);
  Stepper stepper(problem, theta);
  for (;; ++result.iterations) {
    stop_if_interrupted("looking for equilibrium");
    const PackForces& forces = stepper.forces();
    if (rattlers_turn(result.iterations) && result.worst_residual < kMixBelow)
      stepper.relax_rattlers(residual_floor(scales, forces), options.residual_tolerance);
    result.worst_residual = worst_residual(forces, problem.pack(), problem.stride(), residual_floor(scales, forces));
    if (!std::isfinite(result.worst_residual)) {
      result.stopped_by = LeastWorkEnd::not_finite;
      break;
    }
    if (result.worst_residual <= options.residual_tolerance) {
      result.stopped_by = LeastWorkEnd::residual;
      result.converged = true;
      break;
    }
    if (result.iterations >= options.max_iterations) break;
    if (!stepper.step(result.worst_residual < kMixBelow)) {
      result.stopped_by = LeastWorkEnd::no_descent;
      break;
    }
  }
  result.factorisations = stepper.factorisations();
  result.linear_iterations = stepper.linear_iterations();
  result.residual_energy = dot(stepper.forces().force, stepper.forces().force);
  result.work = stepper.forces().work;
  return result;
}

}  // namespace softgrain::statics
