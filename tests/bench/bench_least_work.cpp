// Cost of one quasi-static increment of 1e-4 [QS 2.2]: both methods, 2744 grains, and ten mirror images of them.
// "Sliding": after five increments with friction. "TwoThreads": time, not CPU time, is what tells.
//   bench_softgrain --benchmark_filter=LeastWork
// Counters: passes over all contacts, linear iterations, worst residual. An increment that does not converge is an
// error.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <array>

#include "tests/support/grain_packs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const GrainPack& small_pack() {
  static const GrainPack pack = random_pack(14, 0.3);
  return pack;
}

/// Increments after which many contacts slide.
GrainPack strained(GrainPack pack) {
  LeastWorkOptions options;
  for (int k = 0; k < 5; ++k) advance(pack, squeeze(pack, {{0.0, 0.0, 1e-4}}), options);
  return pack;
}

const GrainPack& small_sliding_pack() {
  static const GrainPack pack = strained(small_pack());
  return pack;
}

/// 5 x 2 x 1 copies of the small pack, each the mirror image of its neighbours, settled: ten times its grains without
/// ten times the effort of a generation. A grain at an inner face meets its own image.
GrainPack mirrored(const GrainPack& from) {
  constexpr std::array<int, 3> kImages{5, 2, 1};
  GrainPack out;
  out.friction = from.friction;
  out.walls = from.walls;
  Vec3 size;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    size[axis] = from.walls[2 * k + 1].point[axis] - from.walls[2 * k].point[axis];
    out.walls[2 * k + 1].point[axis] += (kImages[k] - 1) * size[axis];
  }
  for (int a = 0; a < kImages[0]; ++a)
    for (int b = 0; b < kImages[1]; ++b)
      for (std::size_t g = 0; g < from.position.size(); ++g) {
        Vec3 x = from.position[g];
        const std::array<int, 3> image{a, b, 0};
        for (int k = 0; k < 3; ++k) {
          const auto axis = static_cast<std::size_t>(k);
          const double low = from.walls[2 * axis].point[k];
          const double inside = image[axis] % 2 == 0 ? x[k] - low : size[k] - (x[k] - low);
          x[k] = low + image[axis] * size[k] + inside;
        }
        add_grain(out, x, from.radius[g], from.youngs_modulus[g], from.poisson_ratio[g]);
      }
  refresh_contacts(out);
  LeastWorkOptions options;
  options.residual_tolerance = 1e-3;
  advance(out, std::vector<Vec3>(6), options);
  return out;
}

const GrainPack& large_sliding_pack() {
  static const GrainPack pack = strained(mirrored(small_pack()));
  return pack;
}

void increment(benchmark::State& state, const GrainPack& start, const LeastWorkOptions& options) {
  LeastWorkResult result;
  for ([[maybe_unused]] auto _ : state) {
    GrainPack pack = start;
    result = advance(pack, squeeze(pack, {{0.0, 0.0, 1e-4}}), options);
    if (!result.converged) {
      state.SkipWithError(to_string(result.stopped_by).c_str());
      return;
    }
  }
  state.counters["passes"] = static_cast<double>(result.loop_passes);
  state.counters["linear"] = static_cast<double>(result.linear_iterations);
  state.counters["residual"] = result.worst_residual;
}

LeastWorkOptions with(LeastWorkMethod method, CoulombRule rule, double tolerance) {
  LeastWorkOptions options;
  options.method = method;
  options.coulomb = rule;
  options.residual_tolerance = tolerance;
  return options;
}

void LeastWorkPublished(benchmark::State& state) {
  increment(state, small_pack(), with(LeastWorkMethod::published, CoulombRule::reference, 1e-6));
}
void LeastWorkPublishedTight(benchmark::State& state) {
  LeastWorkOptions options = with(LeastWorkMethod::published, CoulombRule::reference, 1e-6);
  options.force_tolerance = 1e-21;
  options.work_tolerance = 0.0;
  options.max_iterations = 100000;
  increment(state, small_pack(), options);
}
void LeastWorkFastReferenceRule(benchmark::State& state) {
  increment(state, small_pack(), with(LeastWorkMethod::fast, CoulombRule::reference, 1e-6));
}
void LeastWorkFast(benchmark::State& state) {
  increment(state, small_pack(), with(LeastWorkMethod::fast, CoulombRule::current, 1e-6));
}
void LeastWorkFastTight(benchmark::State& state) {
  increment(state, small_pack(), with(LeastWorkMethod::fast, CoulombRule::current, 1e-9));
}
void LeastWorkSliding(benchmark::State& state) {
  increment(state, small_sliding_pack(), with(LeastWorkMethod::fast, CoulombRule::current, 1e-6));
}
void LeastWorkSlidingTight(benchmark::State& state) {
  increment(state, small_sliding_pack(), with(LeastWorkMethod::fast, CoulombRule::current, 1e-9));
}
void LeastWorkSlidingTwoThreads(benchmark::State& state) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(2);
  increment(state, small_sliding_pack(), with(LeastWorkMethod::fast, CoulombRule::current, 1e-6));
  omp_set_num_threads(before);
}
void LeastWorkSlidingLarge(benchmark::State& state) {
  increment(state, large_sliding_pack(), with(LeastWorkMethod::fast, CoulombRule::current, 1e-6));
}

BENCHMARK(LeastWorkPublished)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkPublishedTight)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(LeastWorkFastReferenceRule)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkFast)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkFastTight)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkSliding)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkSlidingTight)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkSlidingTwoThreads)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(LeastWorkSlidingLarge)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
