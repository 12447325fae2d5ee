// How many threads passes go on: where other programs want the cores as well, threads wait for each other several
// times in every pass, and fewer can be several times as fast.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/core/cost.h"

namespace softgrain {

/// Decides by what blocks of passes took. Times decide who works, never what comes out: sums have the same bits for any
/// number of threads. All threads are the rule. Where they wait for cores, as many fewer as wait are tried (where that
/// is not known, one thread), and kept while they are not slower. More are tried again as soon as cores are idle, and
/// now and then where they are not or nobody knows. Trials that change nothing become ever rarer.
class ThreadChoice {
 public:
  explicit ThreadChoice(int all) : ThreadChoice(all, all) {}
  /// Begins with `threads` of them: what other programs have left so far.
  ThreadChoice(int all, int threads) : all_(all), now_(threads) {}

  struct Block {
    double seconds = 0.0;      ///< wall-clock time [s]
    double cpu_seconds = 0.0;  ///< CPU time of all threads of the program together [s]
    double work = 0.0;         ///< amount of work, in any unit that takes about as long each time
    double waited = -1.0;      ///< time that threads waited for cores, all together [s]; below 0: not known
    double idle = -1.0;        ///< time that cores were idle, all together [s]; below 0: not known
  };

  [[nodiscard]] int all() const { return all_; }
  /// Threads of the next block.
  [[nodiscard]] int threads() const { return trial_ > 0 ? trial_ : now_; }
  void took(const Block& block);

 private:
  static constexpr int kFirstWait = 4;  ///< blocks
  /// Blocks before more threads than there are idle cores are tried.
  static constexpr int kBlindWait = 64;

  void add(const Block& block);
  void judge_trial();
  void begin_trial(int threads, bool blind);
  [[nodiscard]] bool held_up() const;
  [[nodiscard]] int fewer() const;
  [[nodiscard]] int idle_cores() const;

  int all_;
  int now_;                      ///< threads of blocks that are no trial
  int trial_ = 0;                ///< threads that are tried; 0: none are
  Block recent_{};               ///< sums of the last blocks, earlier ones fading; of a trial all of its blocks
  int blocks_ = 0;               ///< since the last trial began or ended
  double before_ = 0.0;          ///< time per work before the trial [s]
  double settled_ = 0.0;         ///< time per work of what was kept at the last trial [s]
  int wait_ = kFirstWait;        ///< blocks between two trials
  int blind_wait_ = kBlindWait;  ///< blocks before a trial of more threads than there are cores known to be idle
  double rest_ = 0.0;            ///< time before such a trial, as the last one cost a lot [s]
  double since_ = 0.0;           ///< since the last trial began or ended [s]
  bool blind_ = false;           ///< the trial is one of these
  bool any_trial_ = false;
};

/// What passes go over; their times are not to be compared.
enum class PassKind { contacts, cells };

/// Takes the threads of the program for passes, by the choice that all relaxations and integrations of a thread share,
/// and gives them back at its end. Does nothing inside of parallel work, within another one, with one thread, and for
/// so few bodies (or cells) that nothing goes on several threads.
class PassThreads {
 public:
  explicit PassThreads(std::size_t bodies, PassKind kind = PassKind::contacts);
  ~PassThreads();
  PassThreads(const PassThreads&) = delete;
  PassThreads& operator=(const PassThreads&) = delete;

  /// Passes were made since the last call, each over so many pairs (or faces).
  void passed(std::int64_t passes, std::int64_t pairs);

 private:
  void begin();
  void measure();

  PassKind kind_;
  int before_ = 0;  ///< threads; 0: nothing is chosen
  Stopwatch clock_;
  double cpu_begin_ = 0.0;
};

/// How often the number of threads of this thread's passes has been changed so far.
std::uint64_t thread_changes();

/// To be called when a program begins to work: passes begin with as many threads as other programs leave cores from
/// here to the first pass.
void watch_cores();

/// What passes took so far in this program, where there were several threads to choose from.
struct ThreadUse {
  double seconds = 0.0;  ///< wall-clock time [s]
  double fewer = 0.0;    ///< of it on fewer threads than there are, which were not slower
};
ThreadUse thread_use();

// Which share of the work each thread gets: cores differ, and other programs use them.

/// What threads have been measured by. Times decide who does what, never in which order anything is summed.
struct ThreadPace {
  std::vector<double> share;    ///< share of all pairs, per thread; sum 1
  std::vector<double> seconds;  ///< spent by each since the shares were made [s]
  int passes = 0;               ///< since then
  int look_after = 64;          ///< passes between two looks at the pace: ever more, as new shares need a new plan
  std::uint64_t changes = 0;    ///< thread_changes() when the first of these passes was made

  /// Makes the shares anew, in proportion to the pairs per second of each thread; equal ones for another number of
  /// threads or before enough has been measured. No thread gets less than a fifth of an equal share: what it is
  /// measured by would be noise.
  void share_out(std::size_t threads);

  /// Forgets everything where the number of threads has been changed since: threads were slow because others had their
  /// cores, or that was long ago. Whether it did.
  bool forget_changed();

  /// Whether the fastest thread waits for the slowest long enough for new shares to pay.
  [[nodiscard]] bool uneven() const;
};

}  // namespace softgrain
