#include "common/core/parallel_tasks.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>

namespace softgrain {

void parallel_tasks(std::int64_t count, const std::function<void(std::int64_t)>& task) {
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr first;
  std::int64_t first_index = count;
#pragma omp parallel for schedule(dynamic, 1) if (count > 1)
  for (std::int64_t k = 0; k < count; ++k) {
    if (stop) continue;
    try {
      task(k);
    } catch (...) {
      stop = true;
      const std::lock_guard lock(mutex);
      if (k < first_index) {
        first_index = k;
        first = std::current_exception();
      }
    }
  }
  if (first) std::rethrow_exception(first);
}

void parallel_tasks(const std::vector<double>& costs, const std::function<void(std::size_t)>& task) {
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return costs[a] > costs[b]; });
  parallel_tasks(static_cast<std::int64_t>(costs.size()),
                 [&](std::int64_t k) { task(order[static_cast<std::size_t>(k)]); });
}

}  // namespace softgrain
