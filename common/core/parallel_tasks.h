// Independent tasks over threads, with the first error carried out; OpenMP with one thread for a while.
#pragma once

#include <omp.h>

#include <cstdint>
#include <functional>
#include <vector>

namespace softgrain {

/// Runs task(0..count-1), in order of index where threads allow. After an error no further task starts; the error of
/// the smallest index is thrown when all running ones have ended.
void parallel_tasks(std::int64_t count, const std::function<void(std::int64_t)>& task);

/// Runs one task per entry of `costs`, the most expensive first, so that no long one is left over at the end. `costs`
/// may be in any unit. The error that is thrown is that of the task that came first in this order.
void parallel_tasks(const std::vector<double>& costs, const std::function<void(std::size_t)>& task);

/// Limits OpenMP to one thread during its lifetime; its destructor restores the number before.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

}  // namespace softgrain
