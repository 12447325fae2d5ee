// What this machine can do at most, in the units of which the contact loop is made: the floor that results/performance
// measures the loop against is measured too, not taken from a data sheet.
//   bench_softgrain --benchmark_filter=Roofline
// Counter: time per root, division, addition or multiplication (as many lanes side by side as the compiler uses for the
// loop), per record of 32 bytes taken from or added to a random body, per byte of a stream.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "common/core/quad.h"
#include "common/core/random.h"

namespace {

using namespace softgrain;

constexpr std::size_t kInFirstLevel = 1024;  ///< numbers: 8 kB
constexpr std::size_t kBodies = 20000;       ///< of scene A
constexpr std::size_t kLookups = 1U << 16U;

benchmark::Counter seconds_per(double count) {
  return {count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

std::vector<double> numbers(std::size_t count) {
  RandomStream random(3, RandomPurpose::test, 0);
  std::vector<double> out(count);
  for (double& x : out) x = 0.5 + random.uniform();
  return out;
}

/// Which bodies are looked up: anywhere, or near the one before as in a sorted list.
std::vector<std::int32_t> lookups(bool sorted) {
  RandomStream random(4, RandomPurpose::test, 0);
  std::vector<std::int32_t> out(kLookups);
  for (std::size_t k = 0; k < kLookups; ++k) {
    const double start = sorted ? static_cast<double>(k * kBodies / kLookups) : 0.0;
    const double range = sorted ? 300.0 : static_cast<double>(kBodies);
    out[k] = static_cast<std::int32_t>(std::min(start + range * random.uniform(), kBodies - 1.0));
  }
  return out;
}

template <class Work>
void per_number(benchmark::State& state, double operations, Work&& work) {
  const std::vector<double> from = numbers(kInFirstLevel);
  std::vector<double> to(kInFirstLevel);
  const double* const in = from.data();
  double* const out = to.data();
  for ([[maybe_unused]] auto _ : state) {
#pragma omp simd
    for (std::size_t k = 0; k < kInFirstLevel; ++k) out[k] = work(in[k]);
    benchmark::ClobberMemory();
  }
  state.counters["each"] = seconds_per(operations * kInFirstLevel);
}

void RooflineRoot(benchmark::State& state) {
  per_number(state, 1.0, [](double x) { return std::sqrt(x); });
}
void RooflineDivision(benchmark::State& state) {
  per_number(state, 1.0, [](double x) { return 1.5 / x; });
}
/// Sums and products in turn, not fused: the loop gives the same bits on every machine.
void RooflineFlop(benchmark::State& state) {
  per_number(state, 32.0, [](double x) {
    double y = x;
    for (int k = 0; k < 16; ++k) y = y * 0.999 + x;
    return y;
  });
}

/// Four records become four rows, as the loop takes them.
void RooflineGather(benchmark::State& state, bool sorted) {
  const std::vector<std::int32_t> bodies = lookups(sorted);
  const std::vector<Stored<3>> records(kBodies, Vec3{{1.0, 2.0, 3.0}});
  std::vector<Stored<3>> rows(4);
  for ([[maybe_unused]] auto _ : state) {
    Quad sum{};
    for (std::size_t k = 0; k < kLookups; k += 4) {
      Quad a = quad_of(records[static_cast<std::size_t>(bodies[k])]);
      Quad b = quad_of(records[static_cast<std::size_t>(bodies[k + 1])]);
      Quad c = quad_of(records[static_cast<std::size_t>(bodies[k + 2])]);
      Quad d = quad_of(records[static_cast<std::size_t>(bodies[k + 3])]);
      transpose(a, b, c, d);
      sum += a + b;
      store(rows[0], c);
      store(rows[1], d);
    }
    store(rows[2], sum);
    benchmark::DoNotOptimize(rows.data());
    benchmark::ClobberMemory();
  }
  state.counters["each"] = seconds_per(kLookups);
}

/// Load, add, store of one record.
void RooflineScatter(benchmark::State& state, bool sorted) {
  const std::vector<std::int32_t> bodies = lookups(sorted);
  std::vector<Stored<3>> records(kBodies);
  const Quad one = {1.0, 1.0, 1.0, 1.0};
  for ([[maybe_unused]] auto _ : state) {
    for (const std::int32_t body : bodies) {
      Stored<3>& r = records[static_cast<std::size_t>(body)];
      store(r, quad_of(r) + one);
    }
    benchmark::ClobberMemory();
  }
  state.counters["each"] = seconds_per(kLookups);
}

void RooflineRead(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0)) / sizeof(double);
  const std::vector<double> from(count, 1.0);
  const double* const in = from.data();
  for ([[maybe_unused]] auto _ : state) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t k = 0; k < count; ++k) sum += in[k];
    benchmark::DoNotOptimize(sum);
  }
  state.counters["each"] = seconds_per(static_cast<double>(state.range(0)));
}

/// Bytes are read and written back: each counts once.
void RooflineUpdate(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0)) / sizeof(double);
  std::vector<double> at(count, 1.0);
  double* const out = at.data();
  for ([[maybe_unused]] auto _ : state) {
#pragma omp simd
    for (std::size_t k = 0; k < count; ++k) out[k] *= 1.0000001;
    benchmark::ClobberMemory();
  }
  state.counters["each"] = seconds_per(static_cast<double>(state.range(0)));
}

constexpr std::int64_t kLikeSceneA = 6 << 20;  ///< the list of scene A
constexpr std::int64_t kBeyondCaches = 256 << 20;

BENCHMARK(RooflineRoot);
BENCHMARK(RooflineDivision);
BENCHMARK(RooflineFlop);
BENCHMARK_CAPTURE(RooflineGather, anywhere, false);
BENCHMARK_CAPTURE(RooflineGather, nearby, true);
BENCHMARK_CAPTURE(RooflineScatter, anywhere, false);
BENCHMARK_CAPTURE(RooflineScatter, nearby, true);
BENCHMARK(RooflineRead)->Arg(kLikeSceneA)->Arg(kBeyondCaches);
BENCHMARK(RooflineUpdate)->Arg(kLikeSceneA)->Arg(kBeyondCaches);

}  // namespace
