#include <cmath>

#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "microsim/protocol.h"

namespace softgrain {

namespace {

class DampedProtocol : public Protocol {
 public:
  explicit DampedProtocol(const DampedProtocolOptions& options) : options_(options) {}

  [[nodiscard]] std::string name() const override { return "damped"; }
  [[nodiscard]] bool damped_contacts() const override { return false; }

  void approach(SoftExperiment& e, double overlap) const override {
    const double distance = overlap - e.normal_overlap;
    if (distance <= 0.0) return;
    const double largest = options_.increment * e.spec.shell_radius;
    const int steps = std::max(1, static_cast<int>(std::ceil(distance / largest - 1e-9)));
    for (int k = 0; k < steps; ++k) {
      e.push(distance / steps);
      relax(e, options_.tolerance_between);
    }
    e.normal_overlap = overlap;
  }

  using Protocol::settle;
  SettleResult settle(SoftExperiment& e, bool rotated, const RecordedState& look) const override {
    const RelaxationResult result = relax(e, rotated ? options_.tolerance_rotated : options_.tolerance);
    const Residual r = residual(e.system);
    if (look) look(e);
    return {e.force_on_second(), result.residual, r.max_overlap, result.end == RelaxationEnd::converged};
  }

 private:
  RelaxationResult relax(SoftExperiment& e, double tolerance) const {
    DampedOptions options;
    options.tolerance = tolerance;
    options.force_floor = force_floor(e.spec);
    options.max_passes = options_.max_passes;
    return DampedRelaxation<3>(options).relax(e.system);
  }

  DampedProtocolOptions options_;
};

}  // namespace

std::unique_ptr<Protocol> make_damped_protocol(const DampedProtocolOptions& options) {
  return std::make_unique<DampedProtocol>(options);
}

}  // namespace softgrain
