// A run that is killed at any moment and resumed ends with the same bits as one that was left alone.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/io/hdf5_file.h"
#include "common/io/text_file.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

pid_t start(const std::string& scene, const std::string& out, bool resume) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int quiet = ::open("/dev/null", O_WRONLY);
  ::dup2(quiet, STDOUT_FILENO);
  ::dup2(quiet, STDERR_FILENO);
  ::execl(SOFTGRAIN_PROGRAM, SOFTGRAIN_PROGRAM, "microsim", scene.c_str(), "--out", out.c_str(), "--threads", "1",
          "--quiet", resume ? "--resume" : nullptr, static_cast<char*>(nullptr));
  ::_exit(127);
}

/// Sends `signal` as soon as `ready` says so, unless the program has ended; returns the wait status.
int end_when(pid_t child, const std::function<bool()>& ready, int signal) {
  int status = 0;
  while (!ready()) {
    if (::waitpid(child, &status, WNOHANG) == child) return status;
    ::usleep(1000);
  }
  ::kill(child, signal);
  ::waitpid(child, &status, 0);
  return status;
}

/// Seconds of processor time.
int end_after(pid_t child, double seconds, int signal) { return signal_after(child, seconds, signal); }

constexpr double kPatience = 100.0;  // seconds of processor time

bool ended_well(int status) { return WIFEXITED(status) && WEXITSTATUS(status) == 0; }

/// All data sets below two groups have the same bits.
void expect_same_data(const h5::Group& a, const h5::Group& b, const std::string& where) {
  ASSERT_EQ(a.children(), b.children()) << where;
  for (const std::string& name : a.children()) {
    if (name == "provenance") continue;
    bool is_group = true;
    try {
      (void)a.open(name);
    } catch (const Error&) {
      is_group = false;
    }
    if (is_group) {
      expect_same_data(a.open(name), b.open(name), where + "/" + name);
      continue;
    }
    const auto x = a.doubles(name);
    const auto y = b.doubles(name);
    ASSERT_EQ(x.size(), y.size()) << where << "/" << name;
    if (x.empty()) continue;  // has no address
    EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(double)), 0) << where << "/" << name;
  }
}

/// Summaries agree but for times, paths and the command line.
nlohmann::json without_circumstances(nlohmann::json summary) {
  for (const char* key : {"provenance", "files", "seconds"}) summary.erase(key);
  // Parts of the loop are counted per process, as is memory.
  for (const char* key : {"seconds", "warm_up", "measured", "peak_memory", "memory_before_scene"})
    summary["cost"].erase(key);
  return summary;
}

class ParticlesKill : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text_atomic(scene_, tiny_particles("1.2"));
    ASSERT_TRUE(ended_well(end_after(start(scene_, directory_.file("whole"), false), kPatience, SIGKILL)));
  }
  /// A run that is asked to end once `file` exists.
  void stop_at(const std::string& out, const std::string& file) {
    const int status = end_when(
        start(scene_, out, false), [&] { return fs::exists(out + "/" + file); }, SIGTERM);
    ASSERT_TRUE(WIFEXITED(status));
    ASSERT_EQ(WEXITSTATUS(status), 130);
  }
  void expect_same_end(const std::string& out) {
    EXPECT_EQ(without_circumstances(summary_of(directory_.file("whole"))), without_circumstances(summary_of(out)));
    expect_same_data(h5::open_file(directory_.file("whole") + "/run.h5"), h5::open_file(out + "/run.h5"), "");
    EXPECT_FALSE(fs::exists(out + "/checkpoint.h5"));
    EXPECT_FALSE(fs::exists(out + "/checkpoint.h5.previous"));
  }
  TemporaryDirectory directory_;
  std::string scene_ = directory_.file("scene.toml");
};

TEST_F(ParticlesKill, KilledAtRandomAndResumedIsBitwiseTheSame) {
  RandomStream random(20, RandomPurpose::test, 7);
  const std::string out = directory_.file("killed");
  int kills = 0;
  for (int attempt = 0; attempt < 60; ++attempt) {
    // Long enough for a checkpoint most of the time; the last attempts are left alone.
    const double wait = attempt < 8 ? 0.04 + 0.16 * random.uniform() : kPatience;
    const int status = end_after(start(scene_, out, attempt > 0), wait, SIGKILL);
    if (ended_well(status)) break;
    ASSERT_TRUE(WIFSIGNALED(status)) << "status " << status;
    ++kills;
  }
  EXPECT_GE(kills, 1);
  expect_same_end(out);
}

TEST_F(ParticlesKill, ATerminatedRunSaysSoAndResumes) {
  const std::string out = directory_.file("stopped");
  stop_at(out, "checkpoint.h5");
  EXPECT_TRUE(fs::exists(out + "/checkpoint.h5"));
  EXPECT_FALSE(fs::exists(out + "/run.h5"));
  ASSERT_TRUE(ended_well(end_after(start(scene_, out, true), kPatience, SIGKILL)));
  expect_same_end(out);
}

TEST_F(ParticlesKill, ACheckpointOfAnotherSceneIsRefused) {
  const std::string out = directory_.file("stopped");
  stop_at(out, "checkpoint.h5");
  const auto outcome =
      run_the_program("microsim '" + scene_ + "' --out '" + out + "' --quiet --resume --set time.end=0.7");
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_NE(outcome.output.find("another scene"), std::string::npos) << outcome.output;
}

TEST_F(ParticlesKill, ADamagedCheckpointFallsBackToTheOneBefore) {
  const std::string out = directory_.file("stopped");
  stop_at(out, "checkpoint.h5.previous");
  fs::resize_file(out + "/checkpoint.h5", 1000);
  ASSERT_TRUE(ended_well(end_after(start(scene_, out, true), kPatience, SIGKILL)));
  expect_same_end(out);
}

/// The only one there is: what it was saved for is run again from the beginning, and the log says so.
TEST_F(ParticlesKill, WhereTheOnlyCheckpointIsDamagedTheRunStartsAfresh) {
  const std::string out = directory_.file("stopped");
  stop_at(out, "checkpoint.h5");
  fs::remove(out + "/checkpoint.h5.previous");
  write_text_atomic(out + "/checkpoint.h5", "nonsense");
  ASSERT_TRUE(ended_well(end_after(start(scene_, out, true), kPatience, SIGKILL)));
  EXPECT_NE(log_of(out).find("checkpoint is left: the run starts afresh"), std::string::npos);
  expect_same_end(out);
}

}  // namespace
