// Every kind of run, stopped by signals or killed at random moments and gone on with, ends with the same bits in every
// file.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/io/text_file.h"
#include "tests/support/disturbed_run.h"
#include "tests/support/every_kind.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

class RestartEverywhere : public ::testing::TestWithParam<KindScene> {
 protected:
  RestartEverywhere() : runs_(GetParam()) {}

  /// Parts of a run take turns between one and two threads, and between saving whenever possible and now and then.
  [[nodiscard]] pid_t start(const std::string& name, int part) const {
    std::vector<std::string> more{"--threads", part % 2 == 0 ? "1" : "2"};
    if (name != "whole" && part % 3 < 2) more.insert(more.end(), {"--checkpoint-every", "0"});
    if (part > 0) more.emplace_back("--resume");
    return start_program(runs_.arguments(name, more));
  }
  /// Undisturbed; returns how long it took.
  [[nodiscard]] double run_whole() const {
    return child_seconds_of([&] { EXPECT_TRUE(ended_with(wait_for(start("whole", 0)), GetParam().status)); });
  }
  int disturb(const std::string& name, const Disturbance& d) const {
    const int times = run_disturbed(d, runs_.out(name), GetParam().status, [&](int part) { return start(name, part); });
    expect_same_runs(runs_.out("whole"), runs_.out(name));
    for (const char* left : {"/work", "/checkpoint.h5", "/checkpoint.h5.previous"})
      EXPECT_FALSE(fs::exists(runs_.out(name) + left)) << left;
    return times;
  }
  /// In as many runs as it takes.
  void kill_fifty_times(double longest) const {
    int kills = 0;
    for (std::uint64_t round = 0; kills < 50 && round < 50; ++round)
      kills += disturb("killed" + std::to_string(round), {SIGKILL, 50 - kills, longest, round});
    EXPECT_EQ(kills, 50);
  }

  KindRuns runs_;
};

TEST_P(RestartEverywhere, TerminatedAtRandomItEndsInTheSameBits) {
  double longest = 0.8 * run_whole();
  // On a machine that others use as well a run may be much quicker than the one before.
  for (std::uint64_t round = 0; round < 8; ++round, longest *= 0.6)
    if (disturb("stopped" + std::to_string(round), {SIGTERM, 2, longest, 100 + round}) > 0) return;
  ADD_FAILURE() << "every run ended before the signal came";
}

using SlowRestartEverywhere = RestartEverywhere;

TEST_P(SlowRestartEverywhere, TerminatedAtRandomItEndsInTheSameBits) {
  const double whole = run_whole();
  int stops = 0;
  for (std::uint64_t round = 0; round < 6; ++round)
    stops += disturb("stopped" + std::to_string(round), {SIGTERM, 3, 0.6 * whole, 200 + round});
  EXPECT_GE(stops, 3);
}

TEST_P(SlowRestartEverywhere, KilledFiftyTimesItEndsInTheSameBits) { kill_fifty_times(0.2 * run_whole()); }

/// Law tables and hierarchies have tests of a stop of their own among the default ones.
INSTANTIATE_TEST_SUITE_P(Kinds, RestartEverywhere, ::testing::ValuesIn(quick_kinds()), name_of_kind);
INSTANTIATE_TEST_SUITE_P(Kinds, SlowRestartEverywhere, ::testing::ValuesIn(every_kind()), name_of_kind);

/// Of the default tests, the one with fifty kills: each engine of the others is killed as often by the slow tests.
using FiftyKills = RestartEverywhere;
TEST_P(FiftyKills, OfParticlesLeaveTheSameBits) { kill_fifty_times(0.1 * run_whole()); }
INSTANTIATE_TEST_SUITE_P(Particles, FiftyKills,
                         ::testing::Values(KindScene{"particles", "microsim", tiny_particles(), 0}), name_of_kind);

TEST(RestartQuickstart, SlowKilledFiftyTimesItEndsInTheSameBits) {
  const TemporaryDirectory directory;
  const std::string scene = std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/quickstart.toml";
  const auto start = [&](const std::string& out, int part) {
    std::vector<std::string> words{"run", scene, "--out", directory.file(out), "--quiet"};
    if (part > 0) words.emplace_back("--resume");
    return start_program(words);
  };
  int status = 0;
  const double whole = child_seconds_of([&] { status = wait_for(start("whole", 0)); });
  ASSERT_TRUE(ended_with(status, 0)) << status;
  // Fifty parts of 1/40 of the run on average: what a kill takes back is the point under way on each thread.
  const int kills = run_disturbed({SIGKILL, 50, 0.05 * whole, 7}, directory.file("killed"), 0,
                                  [&](int part) { return start("killed", part); });
  EXPECT_EQ(kills, 50);
  expect_same_runs(directory.file("whole"), directory.file("killed"));
}

/// A relaxation of minutes between two points that are saved does not keep a signal waiting.
TEST(RestartSignal, IsAnsweredInTheMiddleOfALongRelaxation) {
  const TemporaryDirectory directory;
  std::string text = kTinySoftParticle;
  text += "[measure.published]\nstop_interval = \"1000 s\"\n";
  text.replace(text.find("\"least-work\""), 12, "\"published\"");
  text.erase(text.find("[reference]"), text.find("[measure.published]") - text.find("[reference]"));
  write_text_atomic(directory.file("scene.toml"), text);
  const std::string out = directory.file("out");
  const pid_t child = start_program({"microsim", directory.file("scene.toml"), "--out", out, "--threads", "1"});
  const Signalled ended = signalled_after(child, 0.6, SIGTERM);
  EXPECT_TRUE(ended_with(ended.status, 130)) << ended.status;
  EXPECT_LT(ended.after, 2.0) << "of a relaxation that takes minutes";
}

}  // namespace
