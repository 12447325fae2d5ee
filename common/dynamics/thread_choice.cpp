#include "common/dynamics/thread_choice.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <ctime>
#include <memory>
#include <mutex>
#include <optional>

#include "common/dynamics/core_use.h"

namespace softgrain {

namespace {

/// Waiting time of all threads together, over the time of a block, from which they count as held up: other programs
/// wake up for a moment on a quiet machine too.
constexpr double kHeldUp = 0.15;
/// Share of their cores that threads have to get; waiting for the slowest takes some of it on a quiet machine too.
constexpr double kServed = 0.75;
/// How much faster more threads must be. Fewer must not be slower.
constexpr double kFaster = 0.9;
/// Slowdown since the last trial from which a new trial starts at once.
constexpr double kSlower = 2.0;
/// A trial takes so many blocks, or one where it is that much slower: other programs come and go in slices.
constexpr int kTrialBlocks = 3;
constexpr double kHopeless = 1.25;
/// What is left of earlier blocks with each new one.
constexpr double kFade = 0.75;
/// An idle core counts from this share of the time on.
constexpr double kIdle = 0.75;
/// Threads too many for each that waits all the time. Two that share a core wait half of it each; rather too few
/// threads than too many, as idle cores bring them back.
constexpr double kTooMany = 1.5;
/// Time between trials of more threads than there are idle cores, over what the last one lost: a pass of threads that
/// wait for each other and for cores can take a hundred times as long as one alone.
constexpr double kBlindRest = 50.0;
constexpr int kLongestWait = 256;
/// Shorter blocks say nothing: other programs come and go in slices of a few milliseconds [s].
constexpr double kBlockSeconds = 0.02;
/// A block takes at least so many times as long as to ask the kernel how it went.
constexpr double kAsking = 200.0;
/// Fewer bodies have too few pairs for several threads, fewer cells take too short.
constexpr std::size_t kFewBodies = 500;
constexpr std::size_t kFewCells = 50;

double cpu_seconds() {
  timespec now{};
  if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) != 0) return 0.0;
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// What other programs leave of the cores since watch_cores(): idle time and what this program has used itself.
struct CoreWatch {
  IdleCores idle;
  Stopwatch clock;
  double cpu_begin = cpu_seconds();
};
std::mutex watch_guard;
std::unique_ptr<CoreWatch> core_watch;

/// Threads for which there are cores; all where nobody watched, or not for long enough.
int cores_left(int threads) {
  constexpr double kLongEnough = 0.1;  // [s]
  const std::lock_guard lock(watch_guard);
  if (!core_watch || core_watch->clock.seconds() < kLongEnough) return threads;
  const auto idle = core_watch->idle.since_last();
  const double seconds = core_watch->clock.seconds();
  const double cores = (idle.value_or(0.0) + cpu_seconds() - core_watch->cpu_begin) / seconds;
  core_watch.reset();
  return idle ? std::clamp(static_cast<int>(cores + 1.0 - kIdle), 1, threads) : threads;
}

/// Of the number of threads of this thread's passes.
thread_local std::uint64_t changes_so_far = 0;

/// The choice, and the block that is under way: it may go on from one use of the threads to the next.
struct Meter {
  explicit Meter(int threads) : choice(threads, cores_left(threads)) {}

  [[nodiscard]] bool on_fewer() const { return choice.threads() < choice.all(); }

  /// Ends the block. The kernel tells of the time between two uses as well; where that is most of it, what it tells is
  /// not of the passes.
  void judge() {
    constexpr double kMostlyOther = 4.0;
    const double all = clock.seconds();
    const Stopwatch asked;
    const bool known = all < kMostlyOther * block.seconds;
    const auto of_passes = [&](const std::optional<double>& told) {
      return told && known ? *told * std::min(1.0, block.seconds / all) : -1.0;
    };
    block.waited = of_passes(waits.since_last());
    block.idle = on_fewer() ? of_passes(idle.since_last()) : -1.0;
    const int threads = choice.threads();
    choice.took(block);
    if (choice.threads() != threads) ++changes_so_far;
    block = {};
    if (on_fewer()) (void)idle.since_last();
    asking = asked.seconds();
    clock = {};
  }

  ThreadChoice choice;
  ThreadChoice::Block block{};
  CoreWaits waits;
  IdleCores idle;
  Stopwatch clock;      ///< since the kernel was asked
  double asking = 0.0;  ///< what that takes [s]
};

Meter& meter_of(int threads, PassKind kind) {
  thread_local std::array<std::unique_ptr<Meter>, 2> meters;
  std::unique_ptr<Meter>& meter = meters[static_cast<std::size_t>(kind)];
  if (!meter || meter->choice.all() != threads) meter = std::make_unique<Meter>(threads);
  return *meter;
}

std::atomic<double> all_seconds{0.0};
std::atomic<double> seconds_on_fewer{0.0};

/// Whether the thread is within a use of its threads.
thread_local bool in_use = false;

/// Passes that make a measurement, and the most between two looks.
constexpr int kEnough = 16;
constexpr int kLookAtLeastEvery = 1024;
/// Waiting time, as a share of the longest, from which new shares pay.
constexpr double kUneven = 0.08;
constexpr double kLeastPart = 0.2;

double pace_of(const ThreadChoice::Block& block) { return block.seconds / block.work; }

}  // namespace

void ThreadChoice::add(const Block& block) {
  if (!(recent_.work > 0.0)) recent_ = {.waited = 0.0, .idle = 0.0};
  const double left = trial_ > 0 ? 1.0 : kFade;
  const double seconds = left * recent_.seconds + block.seconds;
  // What one block did not know the next ones may: theirs then counts for all.
  const auto sum = [&](double all, double part) {
    if (part < 0.0) return -1.0;
    return all < 0.0 ? part * seconds / block.seconds : left * all + part;
  };
  recent_ = {seconds, left * recent_.cpu_seconds + block.cpu_seconds, left * recent_.work + block.work,
             sum(recent_.waited, block.waited), sum(recent_.idle, block.idle)};
  since_ += block.seconds;
  ++blocks_;
}

void ThreadChoice::begin_trial(int threads, bool blind) {
  before_ = pace_of(recent_);
  trial_ = threads;
  blind_ = blind;
  any_trial_ = true;
  blocks_ = 0;
  since_ = 0.0;
  recent_ = {};
}

void ThreadChoice::judge_trial() {
  const double pace = pace_of(recent_);
  if (pace <= kHopeless * before_ && blocks_ < kTrialBlocks) return;
  settled_ = std::min(pace, before_);
  if (pace < (trial_ > now_ ? kFaster : 1.0) * before_) {
    now_ = trial_;
    wait_ = kFirstWait;
    blind_wait_ = kBlindWait;
    rest_ = 0.0;
  } else {
    if (blind_) rest_ = kBlindRest * (recent_.seconds - before_ * recent_.work);
    int& wait = blind_ ? blind_wait_ : wait_;
    wait = std::min(2 * wait, kLongestWait);
  }
  trial_ = blocks_ = 0;
  since_ = 0.0;
  recent_ = {};
}

bool ThreadChoice::held_up() const {
  return recent_.waited > kHeldUp * recent_.seconds || recent_.cpu_seconds < kServed * now_ * recent_.seconds;
}

int ThreadChoice::fewer() const {
  const double waiting = recent_.waited / recent_.seconds;
  return waiting > kHeldUp ? std::max(1, now_ - static_cast<int>(std::ceil(kTooMany * waiting - kHeldUp))) : 1;
}

/// Where it is not known, there may be one for every thread.
int ThreadChoice::idle_cores() const {
  if (recent_.idle < 0.0) return all_ - now_;
  return std::min(all_ - now_, static_cast<int>(recent_.idle / recent_.seconds + 1.0 - kIdle));
}

void ThreadChoice::took(const Block& block) {
  if (all_ < 2 || !(block.work > 0.0) || !(block.seconds > 0.0)) return;
  add(block);
  if (trial_ > 0) return judge_trial();
  const bool waits = blocks_ < wait_;
  if (now_ > 1 && held_up()) {
    if (!any_trial_ || !waits || pace_of(block) > kSlower * settled_) begin_trial(fewer(), false);
    return;
  }
  if (now_ == all_ || waits) return;
  const int idle = idle_cores();
  if (idle > 0)
    begin_trial(now_ + idle, false);
  else if (blocks_ >= blind_wait_ && since_ >= rest_)
    begin_trial(now_ + 1, true);
}

PassThreads::PassThreads(std::size_t bodies, PassKind kind) : kind_(kind) {
  const int threads = omp_get_max_threads();
  const std::size_t few = kind == PassKind::cells ? kFewCells : kFewBodies;
  if (bodies < few || in_use || threads < 2 || omp_in_parallel() != 0) return;
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
  Meter& meter = meter_of(before_, kind_);
  omp_set_num_threads(meter.choice.threads());
  clock_ = {};
  cpu_begin_ = cpu_seconds();
}

void PassThreads::measure() {
  Meter& meter = meter_of(before_, kind_);
  const double seconds = clock_.seconds();
  all_seconds.fetch_add(seconds);
  if (meter.choice.threads() < before_) seconds_on_fewer.fetch_add(seconds);
  ThreadChoice::Block& block = meter.block;
  block.seconds += seconds;
  block.cpu_seconds += cpu_seconds() - cpu_begin_;
}

void PassThreads::passed(std::int64_t passes, std::int64_t pairs) {
  if (before_ == 0) return;
  Meter& meter = meter_of(before_, kind_);
  meter.block.work += static_cast<double>(passes) * static_cast<double>(pairs + 1);
  if (meter.block.seconds + clock_.seconds() < std::max(kBlockSeconds, kAsking * meter.asking)) return;
  measure();
  meter.judge();
  begin();
}

std::uint64_t thread_changes() { return changes_so_far; }

void watch_cores() {
  const std::lock_guard lock(watch_guard);
  core_watch = std::make_unique<CoreWatch>();
}

ThreadUse thread_use() { return {all_seconds.load(), seconds_on_fewer.load()}; }

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

bool ThreadPace::forget_changed() {
  if (changes == thread_changes()) return false;
  *this = {};
  changes = thread_changes();
  return true;
}

bool ThreadPace::uneven() const {
  if (passes < look_after || seconds.empty()) return false;
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  return *most - *least > kUneven * *most;
}

}  // namespace softgrain
