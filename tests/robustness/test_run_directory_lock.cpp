// Two runs never share a directory: the second one is told, the first one is not disturbed.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/core/error.h"
#include "common/io/file_safety.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

std::string line_of(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += "'" + word + "' ";
  return line;
}

void expect_refused(const std::vector<std::string>& words, const std::string& directory) {
  const ProgramOutcome outcome = run_the_program(line_of(words));
  EXPECT_EQ(outcome.status, 4) << outcome.output;
  EXPECT_NE(outcome.output.find(directory + ": another run (process " + std::to_string(::getpid()) + ") is at work"),
            std::string::npos)
      << outcome.output;
}

TEST(RunDirectoryLock, EveryCommandAsksForIt) {
  for (const KindScene& kind : every_kind()) {
    const KindRuns runs(kind);
    fs::create_directories(runs.out("out"));
    write_text_atomic(runs.out("out") + "/summary.json", "of the first run");
    const DirectoryLock lock(runs.out("out"));
    expect_refused(runs.arguments("out"), runs.out("out"));
    expect_refused(runs.arguments("out", {"--resume"}), runs.out("out"));
    EXPECT_EQ(read_text(runs.out("out") + "/summary.json"), "of the first run");
  }
}

TEST(RunDirectoryLock, ReportAndCalibrateAskForItToo) {
  const TemporaryDirectory directory;
  save(synthetic::measurements(), directory.file("measurements.h5"), {});
  const DirectoryLock lock(directory.path());
  expect_refused({"report", directory.path()}, directory.path());
  expect_refused({"calibrate", directory.file("measurements.h5"), "--out", directory.path()}, directory.path());
}

TEST(RunDirectoryLock, IsReleasedWhenItsHolderEnds) {
  const TemporaryDirectory directory;
  { const DirectoryLock lock(directory.path()); }
  const DirectoryLock again(directory.path());
  EXPECT_THROW(DirectoryLock(directory.path()), IoError);
}

/// The first run is at work when the second one comes; then it is killed, and the third one goes on.
TEST(RunDirectoryLock, ASecondRunLeavesTheFirstAlone) {
  const KindRuns runs({"particles", "microsim", tiny_particles(), 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("whole"))), 0));
  const pid_t first = start_program(runs.arguments("out"));
  while (!fs::exists(runs.out("out") + "/checkpoint.h5")) ::usleep(1000);
  ::kill(first, SIGSTOP);  // it is at work for as long as the second one looks
  EXPECT_EQ(run_the_program(line_of(runs.arguments("out"))).status, 4);
  ::kill(first, SIGCONT);
  ASSERT_TRUE(ended_with(wait_for(first), 0));
  expect_same_runs(runs.out("whole"), runs.out("out"));
  const pid_t killed = start_program(runs.arguments("out"));
  ::usleep(50000);
  (void)signal_after(killed, 0.0, SIGKILL);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("out", {"--resume"}))), 0));
  expect_same_runs(runs.out("whole"), runs.out("out"));
}

}  // namespace
