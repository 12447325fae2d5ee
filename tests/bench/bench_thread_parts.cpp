// What a pass on many threads costs beside its share of the work: pairs that two threads look at, how unlike the parts
// are, and bodies that are read from other threads. Counts, so that a machine with two cores tells them for any number.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <algorithm>

#include "common/dynamics/parallel_pass.h"
#include "tests/bench/roofline_scene.h"

namespace softgrain::bench {
namespace {

/// `most`: pairs of the busiest thread over an even share of all pairs; `read`: bodies of others per own body, mean.
void thread_parts(benchmark::State& state, const char* packing, double smallest) {
  const int threads = static_cast<int>(state.range(0));
  System<3> s = settled_packing({.packing = packing, .smallest = smallest});
  reorder_grains(s, spatial_order(s));
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  for (auto _ : state) force_pass(s, 0.0);
  const std::vector<PartSize> parts = part_sizes(s);
  omp_set_num_threads(before);
  std::int64_t most = 0;
  std::int64_t read = 0;
  std::int64_t foreign = 0;
  for (const PartSize& part : parts) {
    most = std::max(most, part.pairs);
    read += part.neighbours;
    foreign += part.foreign;
  }
  const auto pairs = static_cast<double>(s.contacts.size());
  state.counters["most"] = static_cast<double>(most) * threads / pairs;
  state.counters["twice"] = static_cast<double>(foreign) / pairs;
  state.counters["read"] = static_cast<double>(read) / static_cast<double>(s.particles.grains);
}

BENCHMARK_CAPTURE(thread_parts, A, "A", 1.0)->Arg(2)->Arg(8)->Arg(16)->Arg(64)->Iterations(1);
BENCHMARK_CAPTURE(thread_parts, B, "B", 0.1)->Arg(2)->Arg(8)->Arg(16)->Arg(64)->Iterations(1);
BENCHMARK_CAPTURE(thread_parts, C, "C", 0.02)->Arg(2)->Arg(8)->Arg(16)->Arg(64)->Iterations(1);

}  // namespace
}  // namespace softgrain::bench
