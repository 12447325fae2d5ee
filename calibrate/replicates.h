// The loop of a bootstrap: replicates in parallel, each with random numbers of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <type_traits>
#include <vector>

#include "common/core/random.h"
#include "common/io/interrupt.h"

namespace softgrain {

/// What `replicate(random)` returns for replicates 0 .. count - 1. The random numbers of replicate r are those of
/// (seed, RandomPurpose::bootstrap, first + r), so results do not depend on threads. After a signal it starts no
/// further replicate and throws Interrupted ("stopped by a signal while `doing`"). `replicate` must not throw.
template <class Replicate>
auto bootstrap_replicates(int count, std::uint64_t seed, std::uint64_t first, const char* doing,
                          const Replicate& replicate) {
  using Result = std::invoke_result_t<const Replicate&, RandomStream&>;
  std::vector<Result> all(static_cast<std::size_t>(count));
#pragma omp parallel for schedule(dynamic)
  for (int r = 0; r < count; ++r) {
    if (interrupt_requested()) continue;  // an exception must not leave the region
    RandomStream random(seed, RandomPurpose::bootstrap, first + static_cast<std::uint64_t>(r));
    all[static_cast<std::size_t>(r)] = replicate(random);
  }
  stop_if_interrupted(doing);
  return all;
}

}  // namespace softgrain
