// What laws of soft particles cost that know of several contacts: one pass over the same contacts under each law, on
// one thread, beside Hertz and the published pair law.
//   bench_softgrain --benchmark_filter=SoftLaw
// Counters: time per touching contact; bytes of the sums per particle and of the memory, zero for laws that need none.
// `solid`: as against solid partners, where one body of a contact is soft; else both are, and both sides are evaluated.
#include <benchmark/benchmark.h>

#include "tests/bench/roofline_scene.h"

namespace {

using namespace softgrain;
using namespace softgrain::bench;

/// Processor time of this thread per `count` things [s].
benchmark::Counter seconds_per(double count) {
  return {count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

/// The sums of bag and directional laws are made by the whole pass: it sets the forces to zero itself.
void time_law(benchmark::State& state, const AnyLaw& law) {
  const OneThread one_thread;
  System<3> s = packing({});
  set_law(s, law);
  list_again(s);
  for (int k = 0; k < 2; ++k) force_pass(s, 0.0, History::advance);
  for ([[maybe_unused]] auto _ : state) {
    force_pass(s, 0.0, History::advance);
    benchmark::ClobberMemory();
  }
  const auto touching = static_cast<double>(contact_records(s).size());
  state.counters["per_contact"] = seconds_per(touching);
  state.counters["touching"] = touching;
  state.counters["listed"] = s.contacts.size();
  state.counters["sum_bytes"] = static_cast<double>(s.contacts.particle_sum.size() * sizeof(MultiContactSum<3>));
  state.counters["memory_bytes"] = static_cast<double>(s.contacts.memory.size() * sizeof(double));
}

/// A threshold so low that every overlap of the packing carries force: all laws look at the same contacts.
constexpr double kThreshold = 1e-6;

template <LawForm kLawForm, bool kUnloading, bool kRolling>
AnyLaw multi_contact_law(bool solid_partner) {
  SoftMultiContact<kLawForm, kUnloading, kRolling> law;
  law.form.pressure = {0.6, 2.2, kThreshold};
  law.form.coupling = {0.6, 0.5, 0.1};
  law.partner.log_weight = MonotoneCurve({-1.4, 0.0, 1.4}, {-0.5, -0.4, -0.3});
  law.partner.common_exponent = 1.2;  // of soft neighbours; those of solid ones come with the ratio
  law.partner.exponent = MonotoneCurve({-1.4, 0.0, 1.4}, {1.1, 1.1, 1.1});
  law.modulus = 5e5;
  law.friction = 0.3;
  law.kt_ratio = 0.3;
  law.unloading = 1.5;
  law.rolling = 0.005;
  law.rolling_friction = 0.05;
  law.j_is_soft = !solid_partner;
  return law;
}

void SoftLawHertz(benchmark::State& state) { time_law(state, law_of({.damping = false})); }

void SoftLawPublished(benchmark::State& state) {
  SoftContact law;
  law.normal = {0.6, 2.2, -0.6 * std::pow(kThreshold, 2.2)};
  law.tangential = {1.5, 1.5, -1.5 * std::pow(kThreshold, 1.5)};
  law.delta = kThreshold;
  law.modulus = 5e5;
  law.friction = 0.3;
  law.partner_is_soft = true;
  time_law(state, law);
}

template <LawForm kLawForm, bool kUnloading, bool kRolling = false>
void SoftLawMultiContact(benchmark::State& state, bool solid_partner) {
  time_law(state, multi_contact_law<kLawForm, kUnloading, kRolling>(solid_partner));
}

constexpr auto kPair = SoftLawMultiContact<LawForm::pair, false>;
constexpr auto kPairBack = SoftLawMultiContact<LawForm::pair, true>;
constexpr auto kIsotropic = SoftLawMultiContact<LawForm::isotropic, false>;
constexpr auto kIsotropicRolling = SoftLawMultiContact<LawForm::isotropic, false, true>;
constexpr auto kIsotropicBack = SoftLawMultiContact<LawForm::isotropic, true>;
constexpr auto kDirectional = SoftLawMultiContact<LawForm::directional, false>;
constexpr auto kDirectionalRolling = SoftLawMultiContact<LawForm::directional, false, true>;
constexpr auto kDirectionalAll = SoftLawMultiContact<LawForm::directional, true, true>;
constexpr auto kDirectionalBack = SoftLawMultiContact<LawForm::directional, true>;

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): how Google Benchmark registers
#define SOFT_BENCHMARK(function, name, solid_partner) \
  BENCHMARK_CAPTURE(function, name, solid_partner)->Unit(benchmark::kMicrosecond)->Name("SoftLaw/" #name)

BENCHMARK(SoftLawHertz)->Unit(benchmark::kMicrosecond)->Name("SoftLaw/hertz");
BENCHMARK(SoftLawPublished)->Unit(benchmark::kMicrosecond)->Name("SoftLaw/published");
SOFT_BENCHMARK(kPair, pair, false);
SOFT_BENCHMARK(kPair, pair_solid, true);
SOFT_BENCHMARK(kPairBack, pair_unloading, false);
SOFT_BENCHMARK(kIsotropic, isotropic, false);
SOFT_BENCHMARK(kIsotropic, isotropic_solid, true);
SOFT_BENCHMARK(kIsotropicRolling, isotropic_rolling, false);
SOFT_BENCHMARK(kIsotropicBack, isotropic_unloading, false);
SOFT_BENCHMARK(kDirectional, directional, false);
SOFT_BENCHMARK(kDirectional, directional_solid, true);
SOFT_BENCHMARK(kDirectionalRolling, directional_rolling, false);
SOFT_BENCHMARK(kDirectionalRolling, directional_rolling_solid, true);
SOFT_BENCHMARK(kDirectionalAll, directional_unloading_rolling, false);
SOFT_BENCHMARK(kDirectionalBack, directional_unloading, false);
SOFT_BENCHMARK(kDirectionalBack, directional_unloading_solid, true);
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

}  // namespace
