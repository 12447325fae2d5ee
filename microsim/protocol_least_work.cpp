#include <algorithm>
#include <cmath>

#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "common/dynamics/slow_dynamics.h"
#include "common/dynamics/verlet.h"
#include "common/statics/least_work_step.h"
#include "microsim/protocol.h"

namespace softgrain {

namespace {

/// Largest number of increments that dynamics takes in one stretch. Such a stretch follows an increment without
/// equilibrium; its length is 1, 2, 4... up to this.
constexpr int kLongestDetour = 8;

class LeastWorkProtocol : public Protocol {
 public:
  explicit LeastWorkProtocol(const LeastWorkProtocolOptions& options) : options_(options) {}

  [[nodiscard]] std::string name() const override { return "least-work"; }
  [[nodiscard]] bool damped_contacts() const override { return false; }

  void approach(SoftExperiment& e, double overlap) const override {
    const double distance = overlap - e.normal_overlap;
    if (distance <= 0.0) return;
    const int steps =
        std::max(1, static_cast<int>(std::ceil(distance / (options_.increment * e.spec.shell_radius) - 1e-9)));
    const double move = distance / steps;
    const double v = speed(e.spec);
    std::vector<Vec3> last;  // the displacement that served last is the first guess for the next
    int detour = 0;
    for (int k = 0; k < steps;) {
      if (step(e, move, last)) {
        detour = 0;
        ++k;
        continue;
      }
      detour = std::min(std::clamp(2 * detour, 1, kLongestDetour), steps - k);
      last.clear();
      run_slow(e, driven_at(e.second_moves(v)), detour * move / v, options_.step_factor);
      k += detour;
    }
    e.normal_overlap = overlap;
  }

  /// Increments of least work leave half of all contacts at the Coulomb limit, slow dynamics next to none though close
  /// to it; settling loosens springs, and kt follows the springs. So the path may be given less of it than the record.
  using Protocol::settle;
  SettleResult settle(SoftExperiment& e, bool rotated, const RecordedState& look) const override {
    if (rotated) {
      rest(e, options_.settle_time_rotated, options_.step_factor_rotated);
      const SettleResult turned = polish(e);
      if (look) look(e);
      return turned;
    }
    rest(e, std::min(options_.path_settle_time, options_.settle_time), options_.step_factor);
    SoftExperiment recorded = e;
    rest(recorded, options_.settle_time - options_.path_settle_time, options_.step_factor);
    const SettleResult result = polish(recorded);
    if (look) look(recorded);
    e.system.cost = recorded.system.cost;
    return result;
  }

 private:
  /// Dynamics for a time in units of Rs sqrt(rho/E), then no motion.
  static void rest(SoftExperiment& e, double time, double step_factor) {
    if (time > 0.0) run_slow(e, {}, time * natural_time(e.spec), step_factor);
    stop_motion(e.system.particles);
  }

  /// The last relaxation, and what is recorded.
  [[nodiscard]] SettleResult polish(SoftExperiment& e) const {
    DampedOptions options;
    options.tolerance = options_.tolerance;
    options.force_floor = force_floor(e.spec);
    options.max_passes = options_.max_passes;
    const RelaxationResult result = DampedRelaxation<3>(options).relax(e.system);
    return {e.force_on_second(), result.residual, residual(e.system).max_overlap,
            result.end == RelaxationEnd::converged};
  }

  [[nodiscard]] double speed(const SoftParticleSpec& spec) const {
    return options_.approach_speed > 0.0 ? options_.approach_speed : published_speed(spec);
  }

  /// One increment by least work; false, and nothing changed, when there is no equilibrium nearby.
  bool step(SoftExperiment& e, double move, std::vector<Vec3>& last) const {
    LeastWorkStepOptions options;
    options.tolerance = options_.tolerance_between;
    options.force_floor = force_floor(e.spec);
    options.max_passes = options_.increment_passes;
    std::vector<Vec3> moves = last.empty() ? e.second_moves(move) : last;
    if (LeastWorkStep(options).advance(e.system, moves).end != RelaxationEnd::converged) return false;
    last = std::move(moves);
    return true;
  }

  LeastWorkProtocolOptions options_;
};

}  // namespace

std::unique_ptr<Protocol> make_least_work_protocol(const LeastWorkProtocolOptions& options) {
  return std::make_unique<LeastWorkProtocol>(options);
}

}  // namespace softgrain
