// Whether passes go on all threads or on one: where other programs want the cores as well, threads wait for each other
// several times in every pass, and one alone can be ten times as fast.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/core/cost.h"

namespace softgrain {

/// Decides by what blocks of passes took. Times decide who works, never what comes out: sums have the same bits for any
/// number of threads. All threads are the rule. Where they did not get their cores, a block on one thread is tried, and
/// one it stays while that is faster; all are tried again now and then. Trials that change nothing become ever rarer.
class ThreadChoice {
 public:
  explicit ThreadChoice(int all) : all_(all) {}

  struct Block {
    double seconds = 0.0;      ///< wall-clock time [s]
    double cpu_seconds = 0.0;  ///< CPU time of all threads of the program together [s]
    double work = 0.0;         ///< amount of work, in any unit that takes about as long each time
  };

  [[nodiscard]] int all() const { return all_; }
  /// Threads of the next block.
  [[nodiscard]] int threads() const { return on_all_ ? all_ : 1; }
  void took(const Block& block);

 private:
  void judge_trial(double pace);

  static constexpr int kFirstWait = 4;  ///< blocks

  int all_;
  bool on_all_ = true;
  bool trial_ = false;     ///< the next block is a trial
  double before_ = 0.0;    ///< time per work before the trial [s]
  double settled_ = 0.0;   ///< time per work of what was kept at the last trial [s]
  int wait_ = kFirstWait;  ///< blocks between two trials
  int left_ = 0;           ///< blocks left before the next trial
};

/// Takes the threads of the program for passes, by the choice that all relaxations and integrations of a thread share,
/// and gives them back at its end. Does nothing inside of parallel work, within another one, with one thread, and for
/// so few bodies that nothing goes on several threads.
class PassThreads {
 public:
  explicit PassThreads(std::size_t bodies);
  ~PassThreads();
  PassThreads(const PassThreads&) = delete;
  PassThreads& operator=(const PassThreads&) = delete;

  /// Passes were made since the last call, each over so many pairs.
  void passed(std::int64_t passes, std::int64_t pairs);

 private:
  void begin();
  void measure();

  int before_ = 0;  ///< threads; 0: nothing is chosen
  Stopwatch clock_;
  double cpu_begin_ = 0.0;
};

/// What passes took so far in this program, where there were several threads to choose from.
struct ThreadUse {
  double seconds = 0.0;  ///< wall-clock time [s]
  double alone = 0.0;    ///< of it on one thread, which was faster
};
ThreadUse thread_use();

// Which share of the work each thread gets: cores differ, and other programs use them.

/// What threads have been measured by. Times decide who does what, never in which order anything is summed.
struct ThreadPace {
  std::vector<double> share;    ///< share of all pairs, per thread; sum 1
  std::vector<double> seconds;  ///< spent by each since the shares were made [s]
  int passes = 0;               ///< since then
  int look_after = 64;          ///< passes between two looks at the pace: ever more, as new shares need a new plan

  /// Makes the shares anew, in proportion to the pairs per second of each thread; equal ones for another number of
  /// threads or before enough has been measured. No thread gets less than a fifth of an equal share: what it is
  /// measured by would be noise.
  void share_out(std::size_t threads);

  /// Whether the fastest thread waits for the slowest long enough for new shares to pay.
  [[nodiscard]] bool uneven() const;
};

}  // namespace softgrain
