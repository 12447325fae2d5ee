#include "common/dynamics/thread_choice.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <ctime>

namespace softgrain {

namespace {

/// Share of their cores that threads have to get; waiting for the slowest takes some of it on a quiet machine too.
constexpr double kServed = 0.75;
/// How much faster the other choice must be.
constexpr double kFaster = 0.9;
/// Slowdown since the last trial from which a new trial starts at once.
constexpr double kSlower = 2.0;
constexpr int kLongestWait = 256;
/// Shorter blocks say nothing: other programs come and go in slices of a few milliseconds [s].
constexpr double kBlockSeconds = 0.02;
/// Fewer bodies have too few pairs for several threads.
constexpr std::size_t kFewBodies = 500;

double cpu_seconds() {
  timespec now{};
  if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) != 0) return 0.0;
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The choice, and the block that is under way: it may go on from one use of the threads to the next.
struct Meter {
  explicit Meter(int threads) : choice(threads) {}

  ThreadChoice choice;
  ThreadChoice::Block block{};
};

Meter& meter_of(int threads) {
  thread_local Meter meter(threads);
  if (meter.choice.all() != threads) meter = Meter(threads);
  return meter;
}

std::atomic<double> all_seconds{0.0};
std::atomic<double> seconds_alone{0.0};

/// Whether the thread is within a use of its threads.
thread_local bool in_use = false;

/// Passes that make a measurement, and the most between two looks.
constexpr int kEnough = 16;
constexpr int kLookAtLeastEvery = 1024;
/// Waiting time, as a share of the longest, from which new shares pay.
constexpr double kUneven = 0.08;
constexpr double kLeastPart = 0.2;

}  // namespace

void ThreadChoice::judge_trial(double pace) {
  trial_ = false;
  settled_ = std::min(pace, before_);
  if (pace < kFaster * before_) {
    wait_ = kFirstWait;
  } else {
    on_all_ = !on_all_;
    wait_ = std::min(2 * wait_, kLongestWait);
  }
  left_ = wait_;
}

void ThreadChoice::took(const Block& block) {
  if (all_ < 2 || !(block.work > 0.0) || !(block.seconds > 0.0)) return;
  const double pace = block.seconds / block.work;
  if (trial_) return judge_trial(pace);
  if (left_ > 0 && !(on_all_ && pace > kSlower * settled_)) {
    --left_;
    return;
  }
  if (on_all_ && block.cpu_seconds >= kServed * static_cast<double>(all_) * block.seconds) return;
  before_ = pace;
  trial_ = true;
  on_all_ = !on_all_;
}

PassThreads::PassThreads(std::size_t bodies) {
  const int threads = omp_get_max_threads();
  if (bodies < kFewBodies || in_use || threads < 2 || omp_in_parallel() != 0) return;
  in_use = true;
  before_ = threads;
  begin();
}

PassThreads::~PassThreads() {
  if (before_ == 0) return;
  measure();
  omp_set_num_threads(before_);
  in_use = false;
}

void PassThreads::begin() {
  omp_set_num_threads(meter_of(before_).choice.threads());
  clock_ = {};
  cpu_begin_ = cpu_seconds();
}

void PassThreads::measure() {
  Meter& meter = meter_of(before_);
  const double seconds = clock_.seconds();
  all_seconds.fetch_add(seconds);
  if (meter.choice.threads() == 1) seconds_alone.fetch_add(seconds);
  ThreadChoice::Block& block = meter.block;
  block.seconds += seconds;
  block.cpu_seconds += cpu_seconds() - cpu_begin_;
}

void PassThreads::passed(std::int64_t passes, std::int64_t pairs) {
  if (before_ == 0) return;
  Meter& meter = meter_of(before_);
  meter.block.work += static_cast<double>(passes) * static_cast<double>(pairs + 1);
  if (meter.block.seconds + clock_.seconds() < kBlockSeconds) return;
  measure();
  meter.choice.took(meter.block);
  meter.block = {};
  begin();
}

ThreadUse thread_use() { return {all_seconds.load(), seconds_alone.load()}; }

void ThreadPace::share_out(std::size_t threads) {
  const double equal = 1.0 / static_cast<double>(threads);
  const bool measured = share.size() == threads && passes >= kEnough &&
                        std::all_of(seconds.begin(), seconds.end(), [](double s) { return s > 0.0; });
  if (share.size() != threads) share.assign(threads, equal);
  if (measured) {
    double speeds = 0.0;
    for (std::size_t t = 0; t < threads; ++t) speeds += share[t] / seconds[t];
    double sum = 0.0;
    for (std::size_t t = 0; t < threads; ++t) {
      share[t] = std::max(share[t] / seconds[t] / speeds, kLeastPart * equal);
      sum += share[t];
    }
    for (double& part : share) part /= sum;
  }
  if (passes >= look_after) look_after = std::min(2 * look_after, kLookAtLeastEvery);
  seconds.assign(threads, 0.0);
  passes = 0;
}

bool ThreadPace::uneven() const {
  if (passes < look_after || seconds.empty()) return false;
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  return *most - *least > kUneven * *most;
}

}  // namespace softgrain
