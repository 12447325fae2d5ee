// What a scene does not need costs nothing: time of one pass over the contacts for each kind of scene, on one thread.
//   bench_softgrain --benchmark_filter=ContactLoop        one pass
//   bench_softgrain --benchmark_filter=ContactStep        a whole time step: pass, lists, motion
//   bench_softgrain --benchmark_filter=ContactList        making the list
// Counters: time per touching contact, per listed pair, how many there are, share that slides. The state does not
// change between passes (they run with a step of zero, which takes the same instructions), so that every pass of a case
// does the same work; forces are set to zero outside the clock. Each fast case is first compared with the scalar loop.
// Loops written for one scene alone: roofline_bare.cpp. The table: results/performance.
#include <benchmark/benchmark.h>

#include "common/dynamics/pair_loop.h"
#include "common/neighbours/verlet_list.h"
#include "tests/bench/roofline_scene.h"

namespace {

using namespace softgrain;
using namespace softgrain::bench;

struct Touching {
  double contacts = 0.0;
  double sliding = 0.0;
};

template <int D>
Touching touching(const System<D>& s) {
  Touching out;
  for (const ContactRecord<D>& r : contact_records(s)) {
    out.contacts += 1.0;
    out.sliding += r.sliding ? 1.0 : 0.0;
  }
  return out;
}

/// Processor time of this thread per `count` things [s].
benchmark::Counter seconds_per(double count) {
  return {count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

template <int D>
void count_contacts(benchmark::State& state, const System<D>& s, double passes = 1.0) {
  const Touching t = touching(s);
  const double listed = s.contacts.size();
  if (t.contacts > 0.0) {
    state.counters["per_contact"] = seconds_per(passes * t.contacts);
    state.counters["sliding"] = t.sliding / t.contacts;
  }
  if (listed > 0.0) state.counters["per_pair"] = seconds_per(passes * listed);
  state.counters["listed"] = listed;
  state.counters["touching"] = t.contacts;
}

/// Adds each contact to its two bodies.
template <int D>
struct ScatterSink {
  Particles<D>& p;

  void apart(std::size_t) {}
  template <LawTraits kLaw>
  void touch(std::size_t, std::size_t i, std::size_t j, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    Vec<D> f = g.normal * r.normal_force;
    if constexpr (kLaw.has_tangential) {
      f += r.tangential_force;
      const Rot<D> moment = cross(g.normal, r.tangential_force);
      p.torque[i] -= moment * g.arm_i;
      p.torque[j] -= moment * g.arm_j;
    }
    p.force[i] += f;
    p.force[j] -= f;
  }
};

template <int D>
void scalar_pass(System<D>& s) {
  ScatterSink<D> sink{s.particles};
  pair_loop(s, 0.0, sink, History::advance);
}

template <int D>
void fast_pass(System<D>& s) {
  add_contact_forces(s, 0.0, History::advance);
}

/// Largest difference of a force between the fast and the scalar loop, by the largest force.
template <int D>
double disagreement(const System<D>& start) {
  System<D> fast = start;
  System<D> scalar = start;
  clear_forces(fast.particles);
  clear_forces(scalar.particles);
  fast_pass(fast);
  scalar_pass(scalar);
  double largest = 0.0;
  double difference = 0.0;
  for (std::size_t u = 0; u < fast.particles.force.size(); ++u) {
    largest = std::max(largest, norm(scalar.particles.force[u]));
    difference = std::max(difference, norm(Vec<D>(fast.particles.force[u]) - scalar.particles.force[u]));
  }
  return largest > 0.0 ? difference / largest : difference;
}

template <int D, class Pass>
void time_passes(benchmark::State& state, System<D> s, Pass&& pass) {
  const OneThread one_thread;
  if (!(disagreement(s) < 1e-12)) {
    state.SkipWithError("the fast loop and the scalar one differ");
    return;
  }
  for (int k = 0; k < 2; ++k) pass(s);  // histories reach the state that they keep
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    clear_forces(s.particles);
    state.ResumeTiming();
    pass(s);
    benchmark::ClobberMemory();
  }
  count_contacts(state, s);
}

void ContactLoop(benchmark::State& state, const Needs& n) { time_passes(state, packing(n), fast_pass<3>); }
void ContactLoopScalar(benchmark::State& state, const Needs& n) { time_passes(state, packing(n), scalar_pass<3>); }
void ContactLoopDiscs(benchmark::State& state, const Needs& n) { time_passes(state, disc_packing(n), fast_pass<2>); }
void ContactLoopWalls(benchmark::State& state, const Needs& n) {
  System<3> s = grains_on_plane(n);
  for (int k = 0; k < 20; ++k) add_contact_forces(s, kStepPerRadius, History::advance);  // springs of some length
  time_passes(state, std::move(s), fast_pass<3>);
}

/// The pass alone beside the pass and all its records.
void ContactLoopOutput(benchmark::State& state, const Needs& n) {
  time_passes(state, packing(n), [](System<3>& s) {
    fast_pass(s);
    benchmark::DoNotOptimize(contact_records(s));
  });
}

/// These two set forces to zero and look at the margins of the list themselves.
void ContactLoopStiffnessOff(benchmark::State& state, const Needs& n) {
  time_passes(state, packing(n), [](System<3>& s) { force_pass(s, 0.0, History::advance); });
}
void ContactLoopStiffnessOn(benchmark::State& state, const Needs& n) {
  BodyStiffness sums;
  time_passes(state, packing(n), [&](System<3>& s) { force_pass(s, 0.0, sums, History::advance); });
}

SoftContact soft_law(double delta) {
  SoftContact law;
  law.normal = {0.6, 2.2, -0.6 * std::pow(delta, 2.2)};
  law.tangential = {1.5, 1.5, -1.5 * std::pow(delta, 1.5)};
  law.delta = delta;
  law.modulus = 5e5;
  law.friction = 0.3;
  law.damping = 0.1;
  law.partner_is_soft = true;
  return law;
}

/// Scene A as soft grains with this threshold and, when it is not 0, this margin [m].
void ContactLoopSoft(benchmark::State& state, double delta, double margin) {
  System<3> s = packing({});
  set_law(s, soft_law(delta));
  if (margin > 0.0) std::fill(s.neighbours.skin.begin(), s.neighbours.skin.end(), margin);
  list_again(s);
  time_passes(state, std::move(s), fast_pass<3>);
}

/// Making the list: search, sort, constants, histories carried over. Time per grain and per pair.
void ContactList(benchmark::State& state, const Needs& n) {
  const OneThread one_thread;
  System<3> s = packing(n);
  for ([[maybe_unused]] auto _ : state) {
    s.neighbours.reference.clear();  // else margins would follow the motion
    rebuild_neighbours(s);
  }
  count_contacts(state, s);
  state.counters["per_grain"] = seconds_per(s.particles.grains);
}

/// Whole steps from the settled state: lists are made when they must be, motion included. Few steps, as a packing that
/// loses its friction begins to flow.
void ContactStep(benchmark::State& state, const Needs& n) {
  constexpr int kSteps = 20;
  const OneThread one_thread;
  System<3> start = packing(n);
  VelocityVerlet<3>(kStepPerRadius * n.smallest).initialise(start);
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    System<3> s = start;
    VelocityVerlet<3> integrator(kStepPerRadius * n.smallest);
    state.ResumeTiming();
    integrator.advance(s, kSteps);
  }
  count_contacts(state, start, kSteps);
  state.counters["per_grain"] = seconds_per(kSteps * static_cast<double>(start.particles.grains));
}

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): how Google Benchmark registers
#define CONTACT_BENCHMARK(function, name, ...) \
  BENCHMARK_CAPTURE(function, name, __VA_ARGS__)->Unit(benchmark::kMicrosecond)

CONTACT_BENCHMARK(ContactLoop, full, Needs{});
CONTACT_BENCHMARK(ContactLoop, as_read, Needs{.sorted = false});
CONTACT_BENCHMARK(ContactLoop, undamped, Needs{.damping = false});
CONTACT_BENCHMARK(ContactLoop, frictionless, Needs{.friction = false});
CONTACT_BENCHMARK(ContactLoop, frictionless_undamped, Needs{.friction = false, .damping = false});
CONTACT_BENCHMARK(ContactLoop, frictionless_undamped_as_read,
                  Needs{.friction = false, .damping = false, .sorted = false});
CONTACT_BENCHMARK(ContactLoop, rescaled, Needs{.rescaled = true});
CONTACT_BENCHMARK(ContactLoop, open_cell, Needs{.periodic = false});
CONTACT_BENCHMARK(ContactLoop, polydisperse, Needs{.packing = "B", .smallest = 0.1});
CONTACT_BENCHMARK(ContactLoopDiscs, full, Needs{});
CONTACT_BENCHMARK(ContactLoopDiscs, frictionless_undamped, Needs{.friction = false, .damping = false});
CONTACT_BENCHMARK(ContactLoopWalls, full, Needs{.periodic = false});
CONTACT_BENCHMARK(ContactLoopWalls, frictionless_undamped,
                  Needs{.friction = false, .damping = false, .periodic = false});
CONTACT_BENCHMARK(ContactLoopScalar, full, Needs{});
CONTACT_BENCHMARK(ContactLoopScalar, frictionless_undamped, Needs{.friction = false, .damping = false});
CONTACT_BENCHMARK(ContactLoopOutput, full, Needs{});
CONTACT_BENCHMARK(ContactLoopStiffnessOff, full, Needs{});
CONTACT_BENCHMARK(ContactLoopStiffnessOn, full, Needs{});
// The threshold keeps pairs out of the list; a margin of 0.2 m brings them back in; the last one carries force.
CONTACT_BENCHMARK(ContactLoopSoft, below_threshold, 0.1, 0.0);
CONTACT_BENCHMARK(ContactLoopSoft, below_threshold_listed, 0.1, 0.2);
CONTACT_BENCHMARK(ContactLoopSoft, touching, 0.001, 0.0);
CONTACT_BENCHMARK(ContactList, A, Needs{});
CONTACT_BENCHMARK(ContactList, A_as_read, Needs{.sorted = false});
CONTACT_BENCHMARK(ContactList, B, Needs{.packing = "B", .smallest = 0.1});
CONTACT_BENCHMARK(ContactList, C, Needs{.packing = "C", .smallest = 0.02});
CONTACT_BENCHMARK(ContactStep, full, Needs{});
CONTACT_BENCHMARK(ContactStep, frictionless, Needs{.friction = false});
CONTACT_BENCHMARK(ContactStep, frictionless_undamped, Needs{.friction = false, .damping = false});
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

}  // namespace
