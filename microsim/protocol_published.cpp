#include <algorithm>
#include <cmath>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/residual.h"
#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"
#include "microsim/protocol.h"
#include "microsim/shorter_steps.h"

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
    const double dt = step(e, options_);
    const auto steps = static_cast<std::int64_t>(std::ceil(distance / (speed(e.spec) * dt)));
    const double exact_speed = distance / (static_cast<double>(steps) * dt);
    e.add_approach_speed(exact_speed);
    run(e, steps, dt);
    e.add_approach_speed(-exact_speed);
    e.normal_overlap = overlap;
  }

  using Protocol::settle;
  SettleResult settle(SoftExperiment& e, bool, const RecordedState& look) const override {
    const double dt = step(e, options_);
    const auto steps = static_cast<std::int64_t>(std::ceil(interval(e.spec) / dt));
    for (int k = 0; k < options_.stops; ++k) {
      run(e, steps, dt);
      stop_motion(e.system.particles);
    }
    run(e, steps, dt);
    const Residual r = residual(e.system);
    if (look) look(e);
    const double relative = r.relative(force_floor(e.spec));
    return {e.force_on_second(), relative, r.max_overlap, relative <= options_.tolerance};
  }

 private:
  /// The nominal step, shortened where grains are squeezed by many stiff contacts: a heavily damped contact evaluated
  /// once per step otherwise keeps jittering, and the forces come out plausible and 10-15 % low.
  static double step(SoftExperiment& e, const PublishedOptions& options) {
    BodyStiffness sums;
    force_pass(e.system, 0.0, sums);
    const auto& p = e.system.particles;
    double shortest2 = -1.0;
    for (std::size_t u = 0; u < sums.translation.size(); ++u) {
      if (!(p.inverse_mass[u] > 0.0) || !(sums.translation[u] > 0.0)) continue;
      const double t2 = 1.0 / (p.inverse_mass[u] * sums.translation[u]);
      if (shortest2 < 0.0 || t2 < shortest2) shortest2 = t2;
    }
    const double nominal = options.step_fraction * step_limit(e.system).natural_time;
    return shortest2 < 0.0 ? nominal : std::min(nominal, options.crowded_fraction * std::sqrt(shortest2));
  }
  [[nodiscard]] double speed(const SoftParticleSpec& spec) const {
    if (options_.approach_speed > 0.0) return options_.approach_speed;
    return published_speed(spec);
  }
  [[nodiscard]] double interval(const SoftParticleSpec& spec) const {
    if (options_.stop_interval > 0.0) return options_.stop_interval;
    return kPublishedInterval * (natural_time(spec) / natural_time(kPublished));
  }
  static void run(SoftExperiment& e, std::int64_t steps, double dt) {
    with_steps_short_enough(e, [&](int halves) {
      VelocityVerlet<3> integrator(dt / halves);
      integrator.initialise(e.system);
      for (std::int64_t k = 0; k < steps * halves; ++k) {
        stop_if_interrupted("relaxing");
        integrator.step(e.system);
      }
    });
  }

  PublishedOptions options_;
};

}  // namespace

double force_floor(const SoftParticleSpec& spec) {
  return 1e-7 * spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
}

double published_speed(const SoftParticleSpec& spec) {
  return kPublishedSpeed *
         ((spec.shell_radius / natural_time(spec)) / (kPublished.shell_radius / natural_time(kPublished)));
}

std::unique_ptr<Protocol> make_published_protocol(const PublishedOptions& options) {
  return std::make_unique<PublishedProtocol>(options);
}

}  // namespace softgrain
