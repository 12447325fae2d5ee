#include <algorithm>
#include <cmath>

#include "common/dynamics/residual.h"
#include "common/dynamics/slow_dynamics.h"
#include "common/dynamics/verlet.h"
#include "microsim/protocol.h"

namespace softgrain {

namespace {

/// The published experiment: Rs = 0.016 m, E = 5e5 Pa, rho = 2500 kg/m^3 (density is ours, it is not published).
const SoftParticleSpec kPublished{};
constexpr double kPublishedInterval = 0.3;  // s
constexpr double kPublishedSpeed = 0.002;   // m/s, ours: slow enough for the law not to depend on it much

class PublishedProtocol : public Protocol {
 public:
  explicit PublishedProtocol(const PublishedOptions& options) : options_(options) {}

  [[nodiscard]] std::string name() const override { return "published"; }
  [[nodiscard]] bool damped_contacts() const override { return true; }

  void approach(SoftExperiment& e, double overlap) const override {
    const double distance = overlap - e.normal_overlap;
    if (distance <= 0.0) return;
    const double dt = step(e);
    const auto steps = static_cast<std::int64_t>(std::ceil(distance / (speed(e.spec) * dt)));
    run(e, driven_at(e.second_moves(distance / (static_cast<double>(steps) * dt))), steps, dt);
    e.normal_overlap = overlap;
  }

  void run(SoftExperiment& e, const Drive& drive, double duration) const override {
    const double dt = step(e);
    const auto steps = std::max(std::int64_t{1}, static_cast<std::int64_t>(std::ceil(duration / dt)));
    run(e, drive, steps, duration / static_cast<double>(steps));
  }

  using Protocol::settle;
  SettleResult settle(SoftExperiment& e, bool, const RecordedState& look) const override {
    const double dt = step(e);
    const auto steps = static_cast<std::int64_t>(std::ceil(interval(e.spec) / dt));
    for (int k = 0; k < options_.stops; ++k) {
      run(e, {}, steps, dt);
      stop_motion(e.system.particles);
    }
    run(e, {}, steps, dt);
    const Residual r = residual(e.system);
    if (look) look(e);
    const double relative = r.relative(force_floor(e.spec));
    return {e.force_on_second(), relative, r.max_overlap, relative <= options_.tolerance};
  }

 private:
  [[nodiscard]] double step(SoftExperiment& e) const {
    return real_mass_step(e.system, options_.step_fraction, options_.crowded_fraction);
  }
  [[nodiscard]] double speed(const SoftParticleSpec& spec) const {
    if (options_.approach_speed > 0.0) return options_.approach_speed;
    return published_speed(spec);
  }
  [[nodiscard]] double interval(const SoftParticleSpec& spec) const {
    if (options_.stop_interval > 0.0) return options_.stop_interval;
    return published_interval(spec);
  }
  static void run(SoftExperiment& e, const Drive& drive, std::int64_t steps, double dt) {
    with_steps_short_enough(
        e, [&](int halves) { run_steps(e.system, drive, dt / halves, steps * halves, StretchMasses::real); });
  }

  PublishedOptions options_;
};

}  // namespace

void Protocol::run(SoftExperiment& e, const Drive& drive, double duration) const {
  run_slow(e, drive, duration, kTurnStepFactor);
}

double force_floor(const SoftParticleSpec& spec) {
  return 1e-7 * spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
}

double published_interval(const SoftParticleSpec& spec) {
  return kPublishedInterval * (natural_time(spec) / natural_time(kPublished));
}

double published_speed(const SoftParticleSpec& spec) {
  return kPublishedSpeed *
         ((spec.shell_radius / natural_time(spec)) / (kPublished.shell_radius / natural_time(kPublished)));
}

std::unique_ptr<Protocol> make_published_protocol(const PublishedOptions& options) {
  return std::make_unique<PublishedProtocol>(options);
}

}  // namespace softgrain
