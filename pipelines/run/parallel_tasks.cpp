#include "pipelines/run/parallel_tasks.h"

#include <atomic>
#include <exception>
#include <mutex>

namespace softgrain {

void parallel_tasks(std::int64_t count, const std::function<void(std::int64_t)>& task) {
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr first;
  std::int64_t first_index = count;
#pragma omp parallel for schedule(dynamic, 1)
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

}  // namespace softgrain
