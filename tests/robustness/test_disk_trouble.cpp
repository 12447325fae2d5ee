// Disks that are full or read-only: status 4 with a message, no broken file under the name of a result, and once there
// is room the run goes on to the same bits.
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

/// Kinds whose files are of different nature: one checkpoint that grows, many small ones, several results.
std::vector<KindScene> three_kinds() {
  return {{"particles", "microsim", tiny_particles("0.2"), 0},
          {"grain-box", "microsim", kTinyGrainBox, 0},
          {"pipeline", "run", kTinyPipeline, 3}};
}

/// Everything under a good name can be read to the end.
void expect_nothing_broken(const std::string& directory) {
  if (fs::exists(directory + "/summary.json")) {  // all but the report was written
    EXPECT_TRUE(nlohmann::json::parse(read_text(directory + "/summary.json")).is_object());
  }
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.path().extension() != ".h5") continue;
    for (const auto& [name, value] : hdf5_contents(entry.path().string()))
      EXPECT_EQ(value.find("unreadable"), std::string::npos) << entry.path() << name;
  }
}

void expect_trouble(int wait_status, const std::string& errors, const std::string& word) {
  EXPECT_TRUE(ended_with(wait_status, 4)) << wait_status << "\n" << read_text(errors);
  const std::string said = read_text(errors);
  EXPECT_NE(said.find(word), std::string::npos) << said;
  // Once, and nothing of how a library says it.
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_TRUE(said.starts_with("softgrain: ")) << said;
  for (const char* inner : {"errno", "descriptor", "HDF5-DIAG", "LOG ERROR"})
    EXPECT_EQ(said.find(inner), std::string::npos) << said;
}

/// No file may grow beyond so many bytes.
std::function<void()> limited(rlim_t bytes, const std::string& errors) {
  return [=] {
    errors_to(errors)();
    const rlimit limit{bytes, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  };
}

TEST(DiskTrouble, FilesThatMayNotGrow) {
  for (const KindScene& kind : three_kinds()) {
    const KindRuns runs(kind);
    ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("whole"))), kind.status)) << kind.name;
    for (const rlim_t bytes : {3000U, 9000U}) {
      const std::string name = "limit" + std::to_string(bytes);
      const std::string errors = runs.out(name + ".txt");
      const int status = wait_for(start_program(runs.arguments(name), limited(bytes, errors)));
      expect_trouble(status, errors, "cannot be written");
      expect_nothing_broken(runs.out(name));
      ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments(name, {"--resume"}))), kind.status)) << kind.name;
      expect_same_runs(runs.out("whole"), runs.out(name));
    }
  }
}

/// A mounted directory, given back at the end.
class Mounted {
 public:
  explicit Mounted(std::string path) : path_(std::move(path)) {}
  ~Mounted() { ::umount2(path_.c_str(), MNT_DETACH); }
  Mounted(const Mounted&) = delete;
  Mounted& operator=(const Mounted&) = delete;

 private:
  std::string path_;
};

TEST(DiskTrouble, AFullDisk) {
  for (const KindScene& kind : three_kinds()) {
    const KindRuns runs(kind);
    const std::string disk = runs.out("disk");
    fs::create_directories(disk);
    if (::mount("none", disk.c_str(), "tmpfs", 0, "size=40k") != 0) GTEST_SKIP() << "mounting is not allowed here";
    const Mounted mounted(disk);
    ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("whole"))), kind.status)) << kind.name;
    const std::string errors = runs.out("errors.txt");
    const int status = wait_for(start_program(runs.arguments("disk/run"), errors_to(errors)));
    expect_trouble(status, errors, "annot be ");  // created or written
    expect_nothing_broken(disk + "/run");
    ASSERT_EQ(::mount("none", disk.c_str(), "tmpfs", MS_REMOUNT, "size=100m"), 0);
    ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("disk/run", {"--resume"}))), kind.status))
        << kind.name;
    expect_same_runs(runs.out("whole"), disk + "/run");
  }
}

TEST(DiskTrouble, AReadOnlyDisk) {
  const KindRuns runs(three_kinds().front());
  const std::string disk = runs.out("disk");
  fs::create_directories(disk);
  if (::mount("none", disk.c_str(), "tmpfs", MS_RDONLY, "size=40k") != 0)
    GTEST_SKIP() << "mounting is not allowed here";
  const Mounted mounted(disk);
  const std::string errors = runs.out("errors.txt");
  expect_trouble(wait_for(start_program(runs.arguments("disk"), errors_to(errors))), errors, "Read-only file system");
  expect_trouble(wait_for(start_program(runs.arguments("disk/run"), errors_to(errors))), errors,
                 "Read-only file system");
}

TEST(DiskTrouble, ADirectoryBelowAFile) {
  for (const KindScene& kind : every_kind()) {
    const KindRuns runs(kind);
    const std::string errors = runs.out("errors.txt");
    const int status = wait_for(start_program(runs.arguments("law.toml/run"), errors_to(errors)));
    expect_trouble(status, errors, "the directory cannot be made");
  }
}

/// The disk fills up while a checkpoint is there: it stays, as does the one before it.
TEST(DiskTrouble, ACheckpointOutlivesTheOneThatFindsNoRoom) {
  const KindRuns runs(three_kinds().front());
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("whole"))), 0));
  const auto both = [&] { return fs::exists(runs.out("out") + "/checkpoint.h5.previous"); };
  ASSERT_TRUE(ended_with(signal_when(start_program(runs.arguments("out")), both, SIGTERM), 130));
  const std::string before = read_text(runs.out("out") + "/checkpoint.h5");
  const std::string errors = runs.out("errors.txt");
  const int status = wait_for(start_program(runs.arguments("out", {"--resume"}), limited(9000, errors)));
  expect_trouble(status, errors, "cannot be written");
  EXPECT_EQ(read_text(runs.out("out") + "/checkpoint.h5"), before);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("out", {"--resume"}))), 0));
  expect_same_runs(runs.out("whole"), runs.out("out"));
}

}  // namespace
