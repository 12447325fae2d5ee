// A run that is ended by signals at random moments and gone on with each time, until it comes to its end.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>

#include "common/core/random.h"
#include "tests/support/process.h"

namespace softgrain::test {

struct Disturbance {
  int signal = SIGKILL;
  int times = 1;         ///< at most: a run may come to its end before
  double longest = 0.1;  ///< processor time [s]: each part of the run is left alone for a random share of it
  std::uint64_t stream = 0;
};

/// `start(part)` starts the program, with --resume when part > 0. Returns how many times it was disturbed before it
/// ended with `status`. Fails the running test when it ends in another way, or when a run that was stopped looks in
/// `directory` like one that has ended.
inline int run_disturbed(const Disturbance& d, const std::string& directory, int status,
                         const std::function<pid_t(int part)>& start) {
  RandomStream random(41, RandomPurpose::test, d.stream);
  for (int happened = 0;;) {
    const pid_t child = start(happened);
    const int ended =
        happened < d.times ? signal_after(child, d.longest * random.uniform(), d.signal) : wait_for(child);
    if (ended_with(ended, status)) return happened;
    // A signal that comes before the program has asked to be told of signals ends it at once.
    const bool stopped = ended_with(ended, 130) || (WIFSIGNALED(ended) && WTERMSIG(ended) == d.signal);
    EXPECT_TRUE(stopped) << "wait status " << ended << " after " << happened << " signals";
    if (!stopped) return happened;
    if (d.signal != SIGKILL) {
      EXPECT_FALSE(std::filesystem::exists(directory + "/summary.json")) << "it looks as if it had ended";
    }
    ++happened;
  }
}

/// Processor time of the programs that `work` runs to their end [s]: it does not depend on what else the machine does.
inline double child_seconds_of(const std::function<void()>& work) {
  const auto used = [] {
    rusage children{};
    ::getrusage(RUSAGE_CHILDREN, &children);
    return processor_seconds(children);
  };
  const double before = used();
  work();
  return used() - before;
}

}  // namespace softgrain::test
