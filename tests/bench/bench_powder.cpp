// Powders in two dimensions: what one step costs per contact, and what friction, rolling resistance and adhesion add.
#include <benchmark/benchmark.h>

#include "common/dynamics/stress_cell.h"
#include "microsim/powder/powder_assembly.h"

namespace softgrain {
namespace {

PowderSpec spec_of(bool friction, bool rolling, bool cohesive) {
  PowderSpec spec;
  spec.disks = 1400;
  spec.stiffness = 1e3;
  spec.friction = friction ? 0.5 : 0.0;
  spec.rolling = rolling;
  spec.cohesive = cohesive;
  return spec;
}

/// A pack under pressure, a little before it rests; the same for every law.
const PowderState& pack() {
  static const PowderState state = [] {
    const PowderSpec spec = spec_of(true, true, true);
    PowderState s = start_powder(spec, 1, 0);
    PowderOptions options;
    options.time_max = 60.0;
    (void)run_powder(s, spec, powder_phases(spec, {}), options);
    return s;
  }();
  return state;
}

void step(benchmark::State& bench, bool friction, bool rolling, bool cohesive) {
  System<2> s = pack().system;
  s.laws = LawSet(1);
  s.laws.set(0, 0, powder_law(spec_of(friction, rolling, cohesive)));
  s.neighbours.reference.clear();
  StressCellVerlet<2> integrator(1e-6, {{{0.01, 0.01}}, pack().phase_edge, 1e6, 1.0});
  integrator.initialise(s);
  const Cost before = s.cost;
  for (auto _ : bench) integrator.advance(s, 100);
  const auto evaluations = static_cast<double>(s.cost.contact_evaluations - before.contact_evaluations);
  bench.counters["ns_per_pair"] =
      benchmark::Counter(evaluations * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  bench.counters["pairs"] = static_cast<double>(s.contacts.size());
}

BENCHMARK_CAPTURE(step, Powder_frictionless, false, false, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, Powder_frictionless_adhesion, false, false, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, Powder_friction, true, false, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, Powder_friction_adhesion, true, false, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, Powder_rolling_adhesion, true, true, true)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace softgrain
