#include "pipelines/run/trial_times.h"

#include <ctime>

#include "common/core/cost.h"
#include "common/core/parallel_tasks.h"

namespace softgrain {

namespace {

template <typename Timer>
double mean_of_calls(const Timer& timed, double budget, std::int64_t most) {
  std::int64_t calls = 0;
  double spent = 0.0;
  while (calls == 0 || (calls < most && spent < budget)) {
    spent += timed();
    ++calls;
  }
  return spent / static_cast<double>(calls);
}

}  // namespace

double seconds_of(const std::function<void()>& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

double seconds_per_call(const std::function<void()>& work, double budget, std::int64_t most) {
  return mean_of_calls([&] { return seconds_of(work); }, budget, most);
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double core_seconds_of(const std::function<void()>& work) {
  const OneThread one;
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

double core_seconds_per_call(const std::function<void()>& work, double budget, std::int64_t most) {
  return mean_of_calls([&] { return core_seconds_of(work); }, budget, most);
}

}  // namespace softgrain
