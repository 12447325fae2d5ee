// What the compiled example of tests/new_law.py has to hold, without the libraries of the program.
#include <cmath>
#include <cstdio>

#include "common/contact/example_law.h"
#include "common/dynamics/block.h"

namespace {

using namespace softgrain;

constexpr ExampleLaw kLaw{1e4, 1e-4};
constexpr PairBodies kBodies{5e-3, 5e-3, 1e3, 1e3};

ContactResponse<3> at_overlap(double overlap) {
  ContactState<3> state;
  state.overlap = overlap;
  state.constants = kLaw.pair_constants(kBodies);
  return kLaw.evaluate(state);
}

/// Duration of a head-on impact, by small steps of the velocity Verlet scheme [s].
double duration(double speed) {
  const double mass = kBodies.effective_mass();
  const double step = 1e-4 * kLaw.impact_time(kBodies, speed);
  double overlap = 0.0;
  double time = 0.0;
  for (double v = speed; overlap >= 0.0; time += step) {
    v -= 0.5 * step * at_overlap(overlap).normal_force / mass;
    overlap += step * v;
    v -= 0.5 * step * at_overlap(overlap).normal_force / mass;
  }
  return time;
}

bool is_near(double value, double wanted, double relative, const char* what) {
  if (std::abs(value - wanted) <= relative * std::abs(wanted)) return true;
  std::printf("%s: %.12g, should be %.12g\n", what, value, wanted);
  return false;
}

}  // namespace

// The same text for several contacts side by side, and for disks.
template softgrain::ContactResponse<3, softgrain::block::Lanes> softgrain::ExampleLaw::evaluate<
    3, softgrain::block::Lanes>(const softgrain::ContactState<3, softgrain::block::Lanes>&) const;
template softgrain::ContactResponse<2, double> softgrain::ExampleLaw::evaluate<2, double>(
    const softgrain::ContactState<2, double>&) const;

int main() {
  bool good = true;
  for (const double h : {1e-6, 1e-5, 1e-4, 3e-4}) {
    const double d = 1e-4 * h;
    const double work = kLaw.stored_energy(h + d, {}) - kLaw.stored_energy(h - d, {});
    good &= is_near(work / (2.0 * d), at_overlap(h).elastic_force, 1e-7, "derivative of the stored energy");
    const double change = at_overlap(h + d).normal_force - at_overlap(h - d).normal_force;
    good &= is_near(change / (2.0 * d), at_overlap(h).normal_stiffness, 1e-7, "derivative of the force");
  }
  for (const double v : {1e-3, 0.1, 1.0}) {
    const double bound = kLaw.impact_time(kBodies, v);
    const double time = duration(v);
    if (!(bound <= 1.001 * time && time < 2.0 * bound)) {
      std::printf("impact at %g m/s: %g s, impact_time says %g s\n", v, time, bound);
      good = false;
    }
  }
  return good ? 0 : 1;
}
