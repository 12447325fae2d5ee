// All threads or one: by the pace that was measured.
#include <gtest/gtest.h>
#include <omp.h>

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

TEST(PassThreads, GiveTheThreadsBack) {
  const int before = omp_get_max_threads();
  const ThreadUse use = thread_use();
  omp_set_num_threads(3);
  for (int k = 0; k < 3; ++k) {
    PassThreads threads(10000);
    const double begin = omp_get_wtime();
    while (omp_get_wtime() < begin + 0.1) threads.passed(1, 10);  // one of three threads works: others are tried
  }
  EXPECT_EQ(omp_get_max_threads(), 3);
  const ThreadUse after = thread_use();
  EXPECT_NEAR(after.seconds - use.seconds, 0.3, 0.1);
  EXPECT_GT(after.alone - use.alone, 0.0) << "trials on one thread";
  EXPECT_LT(after.alone - use.alone, after.seconds - use.seconds);
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
