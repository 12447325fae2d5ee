// Cost of one quasi-static increment of 1e-4 [QS 2.2]: both methods, 2744 grains and eight mirror images of them.
//   bench_softgrain --benchmark_filter=LeastWork
// Counters: passes over all contacts, linear iterations, worst residual. An increment that does not converge is an
// error.
#include <benchmark/benchmark.h>

#include "tests/support/grain_packs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const GrainPack& small_pack() {
  static const GrainPack pack = random_pack(14, 0.3);
  return pack;
}

/// Eight mirror images of the small pack, settled.
const GrainPack& large_pack() {
  static const GrainPack pack = [] {
    const GrainPack& from = small_pack();
    GrainPack out;
    out.friction = from.friction;
    out.walls = from.walls;
    for (int image = 0; image < 8; ++image)
      for (std::size_t g = 0; g < from.position.size(); ++g) {
        Vec3 x = from.position[g];
        for (int k = 0; k < 3; ++k)
          if ((image >> k & 1) != 0) x[k] = 2.0 * from.walls[static_cast<std::size_t>(2 * k + 1)].point[k] - x[k];
        add_grain(out, x, from.radius[g], from.youngs_modulus[g], from.poisson_ratio[g]);
      }
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      out.walls[2 * k + 1].point[axis] = 2.0 * from.walls[2 * k + 1].point[axis] - from.walls[2 * k].point[axis];
    }
    refresh_contacts(out);
    LeastWorkOptions options;
    options.residual_tolerance = 1e-3;
    advance(out, std::vector<Vec3>(6), options);
    return out;
  }();
  return pack;
}

void increment(benchmark::State& state, const GrainPack& start, const LeastWorkOptions& options) {
  LeastWorkResult result;
  for ([[maybe_unused]] auto _ : state) {
    GrainPack pack = start;
    result = advance(pack, squeeze(pack, {{0.0, 0.0, 1e-4}}), options);
    if (!result.converged) {
      state.SkipWithError(result.stopped_by.c_str());
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
void LeastWorkFastLarge(benchmark::State& state) {
  increment(state, large_pack(), with(LeastWorkMethod::fast, CoulombRule::current, 1e-6));
}

BENCHMARK(LeastWorkPublished)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkPublishedTight)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(LeastWorkFastReferenceRule)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkFast)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkFastTight)->Unit(benchmark::kMillisecond);
BENCHMARK(LeastWorkFastLarge)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
