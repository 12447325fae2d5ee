// All threads or one: by the pace that was measured.
#include <gtest/gtest.h>
#include <omp.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <thread>

#include "common/core/cost.h"
#include "common/dynamics/core_use.h"
#include "common/dynamics/thread_choice.h"

namespace softgrain {
namespace {

/// Goes through blocks of a machine where a block takes so long [s] on all threads and on one; returns the total time.
double go(ThreadChoice& choice, int blocks, double on_all, double on_one, double cpu_share) {
  double total = 0.0;
  for (int k = 0; k < blocks; ++k) {
    const bool all = choice.threads() > 1;
    const double seconds = all ? on_all : on_one;
    choice.took({seconds, (all ? cpu_share * choice.all() : 1.0) * seconds, 1.0});
    total += seconds;
  }
  return total;
}

TEST(ThreadChoice, StaysWithAllThreadsThatGetTheirCores) {
  ThreadChoice choice(2);
  EXPECT_NEAR(go(choice, 1000, 0.02, 0.035, 0.95), 1000 * 0.02, 1e-9);
  EXPECT_EQ(choice.threads(), 2);
}

/// Fourteen times as slow as one thread: soon it is one, and trials cost little.
TEST(ThreadChoice, OneThreadWhereOthersTakeTheCores) {
  ThreadChoice choice(2);
  const double one = 1000 * 0.02;
  EXPECT_LT(go(choice, 1000, 0.28, 0.02, 0.5), 1.2 * one);
  EXPECT_EQ(choice.threads(), 1);
  // Quiet again: all come back.
  go(choice, 600, 0.02, 0.035, 0.95);
  EXPECT_EQ(choice.threads(), 2);
  EXPECT_NEAR(go(choice, 100, 0.02, 0.035, 0.95), 100 * 0.02, 1e-9);
}

/// Threads that wait for each other although nobody takes their cores are still faster than one: trials become rare.
TEST(ThreadChoice, TrialsThatChangeNothingBecomeRare) {
  ThreadChoice choice(4);
  int trials = 0;
  for (int k = 0; k < 2000; ++k) {
    trials += choice.threads() == 1 ? 1 : 0;
    go(choice, 1, 0.02, 0.05, 0.5);
  }
  EXPECT_GT(trials, 3);
  EXPECT_LT(trials, 20);
}

/// However rare trials have become, a machine that slows down is noticed.
TEST(ThreadChoice, ALoadThatComesLaterIsNoticedSoon) {
  ThreadChoice choice(4);
  go(choice, 2000, 0.02, 0.05, 0.5);
  while (choice.threads() == 1) go(choice, 1, 0.02, 0.05, 0.5);
  go(choice, 3, 0.28, 0.05, 0.3);
  EXPECT_EQ(choice.threads(), 1);
}

TEST(ThreadChoice, NothingToChooseWithOneThread) {
  ThreadChoice choice(1);
  go(choice, 50, 0.02, 0.02, 0.1);
  EXPECT_EQ(choice.threads(), 1);
}

/// Of threads that wait all the time half as many again are too many, less what waits on a quiet machine too.
TEST(ThreadChoice, AsManyFewerAsWait) {
  struct Waiting {
    double threads;
    int left;
  };
  constexpr double kSeconds = 0.02;
  for (const auto& [waiting, left] : {Waiting{0.1, 8}, {0.2, 7}, {0.65, 7}, {0.75, 7}, {0.8, 6}, {2.0, 5}, {5.0, 1}}) {
    ThreadChoice choice(8);
    const double waited = waiting * kSeconds;
    choice.took({kSeconds, 8.0 * kSeconds - waited, 1.0, waited, -1.0});
    EXPECT_EQ(choice.threads(), left) << waiting;
  }
}

/// Two threads on two cores; of the second core another program takes every other slice, however short. The first
/// thread begins a pass when the second one has ended the last.
struct SharedCore {
  double pass = 1.2e-3;    ///< on one thread [s]
  double slice = 3e-3;     ///< [s]
  double two = 1.75;       ///< speed of two threads that nobody disturbs
  bool spins = true;       ///< whether a thread that waits for the other one takes its core meanwhile
  double busy_from = 0.0;  ///< [s]
  double busy_to = 1e9;
  double now = 0.0;

  [[nodiscard]] bool taken(double at) const {
    return at >= busy_from && at < busy_to && static_cast<std::int64_t>(at / slice) % 2 == 0;
  }

  /// When the second core has done so much from `at` on.
  [[nodiscard]] double end_of(double at, double work) const {
    while (work > 0.0) {
      const double next = (std::floor(at / slice * (1.0 + 1e-12)) + 1.0) * slice;
      const double part = taken(at + 1e-3 * slice) ? 0.0 : std::min(work, next - at);
      work -= part;
      at = work > 0.0 ? next : at + part;
    }
    return at;
  }

  ThreadChoice::Block block(int threads) {
    ThreadChoice::Block out{.waited = 0.0, .idle = -1.0};
    const double begin = now;
    while (now < begin + 0.02) {
      out.work += 1.0;
      const double part = pass / two;
      const double end = threads == 1 ? now + pass : std::max(now + part, end_of(now, part));
      if (threads > 1) out.waited += end - now - part;
      out.cpu_seconds += threads == 1 ? pass : part + (spins ? end - now : part);
      now = end;
    }
    out.seconds = now - begin;
    if (threads == 1) out.idle = now >= busy_from && now < busy_to ? 0.0 : out.seconds;
    return out;
  }

  /// Passes so many times; returns the time that it took over that of one thread.
  double go(ThreadChoice& choice, double passes) {
    const double begin = now;
    double work = 0.0;
    while (work < passes) {
      const ThreadChoice::Block made = block(choice.threads());
      choice.took(made);
      work += made.work;
    }
    return (now - begin) / (work * pass);
  }
};

/// Runs of two to three seconds beside a program that never rests, from the first pass on.
TEST(ThreadChoice, BesideABusyProgramTwoThreadsTakeNoLongerThanOne) {
  for (const double slice : {1e-3, 3e-3, 6e-3})
    for (const double pass : {0.2e-3, 1.2e-3, 5e-3})
      for (const bool spins : {true, false}) {
        ThreadChoice choice(2);
        SharedCore machine{.pass = pass, .slice = slice, .spins = spins};
        const double ratio = machine.go(choice, 2.5 / pass);
        EXPECT_LT(ratio, 1.02) << slice << " " << pass << " " << spins;
      }
}

/// The other program comes after a second and goes after another two: all threads are back within a quarter of one.
TEST(ThreadChoice, AllThreadsComeBackWhenCoresAreIdle) {
  ThreadChoice choice(2);
  SharedCore machine{.busy_from = 1.0, .busy_to = 3.0};
  EXPECT_NEAR(machine.go(choice, 0.97 * 1.75 / machine.pass), 1.0 / 1.75, 1e-3);
  EXPECT_EQ(choice.threads(), 2);
  EXPECT_LT(machine.go(choice, (3.0 - machine.now) / machine.pass), 1.03);
  EXPECT_EQ(choice.threads(), 1);
  (void)machine.go(choice, 0.25 / machine.pass);
  EXPECT_EQ(choice.threads(), 2);
  EXPECT_NEAR(machine.go(choice, 1000.0), 1.0 / 1.75, 1e-3);
}

/// A program that wakes up for some milliseconds every second takes no thread away.
TEST(ThreadChoice, AMomentOfAnotherProgramTriesNothing) {
  ThreadChoice choice(2);
  for (int k = 0; k < 200; ++k) {
    const double waited = k % 50 == 10 ? 5e-3 : 0.0;
    choice.took({0.02, 0.04 - waited, 1.0, waited, -1.0});
    EXPECT_EQ(choice.threads(), 2) << k;
  }
}

/// A block of which the kernel told nothing, as after long other work, leaves the next ones what they know.
TEST(ThreadChoice, WhatOneBlockDoesNotKnowTheNextOneDoes) {
  ThreadChoice choice(2);
  choice.took({0.02, 0.04, 1.0, -1.0, -1.0});
  EXPECT_EQ(choice.threads(), 2);
  choice.took({0.02, 0.04, 1.0, 0.01, -1.0});
  EXPECT_EQ(choice.threads(), 1);
}

/// Of eight cores others keep some busy: so many threads remain as there are cores left, not one.
TEST(ThreadChoice, AsManyThreadsAsCoresAreLeft) {
  for (const int others : {1, 3}) {
    ThreadChoice choice(8);
    const auto go_on = [&](int blocks, int busy) {
      int fewest = 8;
      for (int k = 0; k < blocks; ++k) {
        const int threads = choice.threads();
        fewest = std::min(fewest, threads);
        const int lacking = std::max(0, threads + busy - 8);
        const double speed = 0.9 * threads * (lacking > 0 ? 0.5 : 1.0);
        const double idle = threads < 8 ? 0.02 * std::max(0, 8 - threads - busy) : -1.0;
        choice.took({0.02, 0.02 * (threads - 0.5 * lacking), 0.02 * speed, 0.01 * lacking, idle});
      }
      return fewest;
    };
    EXPECT_EQ(go_on(50, 0), 8);
    const int fewest = go_on(100, others);
    EXPECT_EQ(choice.threads(), 8 - others);
    EXPECT_GE(fewest, 8 - others);
    go_on(20, 0);
    EXPECT_EQ(choice.threads(), 8);
  }
}

/// Two threads that want one core: at every moment one of them waits.
TEST(CoreUse, ThreadsThatWaitForACoreAreNoticed) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  ASSERT_EQ(sched_getaffinity(0, sizeof(allowed), &allowed), 0);
  unsigned core = 0;
  while (!CPU_ISSET(core, &allowed)) ++core;
  CoreWaits waits;
  if (!waits.since_last()) GTEST_SKIP() << "the kernel does not tell";
  IdleCores idle;
  const Stopwatch clock;
  const auto spin = [&] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(core, &one);
    (void)sched_setaffinity(0, sizeof(one), &one);
    while (clock.seconds() < 0.2) {
    }
  };
  std::thread first(spin);
  std::thread second(spin);
  while (clock.seconds() < 0.18) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const double waited = waits.since_last().value_or(0.0);  // while both are there
  first.join();
  second.join();
  EXPECT_GT(waited, 0.08);
  EXPECT_LT(idle.since_last().value_or(0.0), CPU_COUNT(&allowed) * (clock.seconds() + 0.02));
}

TEST(PassThreads, GiveTheThreadsBack) {
  const int before = omp_get_max_threads();
  const ThreadUse use = thread_use();
  const std::uint64_t changes = thread_changes();
  ThreadPace pace;
  (void)pace.forget_changed();
  pace.share_out(3);
  omp_set_num_threads(3);
  for (int k = 0; k < 3; ++k) {
    PassThreads threads(10000);
    const double begin = omp_get_wtime();
    while (omp_get_wtime() < begin + 0.1) threads.passed(1, 10);  // one of three threads works: others are tried
  }
  EXPECT_EQ(omp_get_max_threads(), 3);
  const ThreadUse after = thread_use();
  EXPECT_NEAR(after.seconds - use.seconds, 0.3, 0.1);
  EXPECT_GT(after.fewer - use.fewer, 0.0) << "trials on one thread";
  EXPECT_LT(after.fewer - use.fewer, after.seconds - use.seconds);
  EXPECT_GT(thread_changes(), changes);
  EXPECT_TRUE(pace.forget_changed()) << "shares of another time";
  EXPECT_TRUE(pace.share.empty());
  EXPECT_FALSE(pace.forget_changed());
  omp_set_num_threads(before);
}

/// One within another, and one for a few bodies, leave the choice alone: whatever they are told, all threads stay.
TEST(PassThreads, OneAtATimeAndForManyBodies) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(3);
  const auto idle = [](PassThreads& threads) {
    for (int k = 0; k < 3; ++k) {
      const double begin = omp_get_wtime();
      while (omp_get_wtime() < begin + 0.03) threads.passed(1, 10);
      EXPECT_EQ(omp_get_max_threads(), 3);
    }
  };
  PassThreads few(10);
  idle(few);
  PassThreads outer(10000);
  omp_set_num_threads(3);
  PassThreads inner(10000);
  idle(inner);
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace softgrain
