// Checkpoints and results with flipped bits or cut short: never taken for what they were not.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/state/checkpoint.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"
#include "tests/support/tiny_files.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

void flip(const std::string& path, std::uint64_t byte, unsigned bit) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(static_cast<std::streamoff>(byte));
  const char changed = static_cast<char>(static_cast<unsigned>(file.get()) ^ (1U << bit));
  file.seekp(static_cast<std::streamoff>(byte));
  file.put(changed);
}

class CheckpointDamage : public ::testing::Test {
 protected:
  void SetUp() override {
    write(1);
    write(2);
  }
  /// Numbers in attributes and in data sets of several chunks, and a text too long for a header.
  void write(std::int64_t generation) const {
    write_checkpoint(path_, "scene", [&](const h5::Group& root) {
      root.attribute("generation", generation);
      root.attribute("time", 0.25);
      root.attribute("long", std::string(70000, 'x'));
      root.create("system").write("position", std::vector<double>(3000, 0.125 * static_cast<double>(generation)));
      root.write("none", std::vector<double>{});
    });
  }
  /// Whether the newest checkpoint was taken for sound; then the one before it was not looked at.
  [[nodiscard]] bool newest_is_taken() const {
    std::string note;
    const auto group = open_checkpoint(path_, "scene", note);
    EXPECT_TRUE(group.has_value());
    EXPECT_EQ(group->integer("generation"), note.empty() ? 2 : 1);
    return note.empty();
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_.file("checkpoint.h5");
};

TEST_F(CheckpointDamage, AFlippedBitAnywhereIsFound) {
  ASSERT_TRUE(newest_is_taken());
  const std::uint64_t size = fs::file_size(path_);
  RandomStream random(7, RandomPurpose::test, 1);
  for (int n = 0; n < 1000; ++n) {
    const std::uint64_t byte = random.below(size);
    const auto bit = static_cast<unsigned>(random.below(8));
    flip(path_, byte, bit);
    EXPECT_FALSE(newest_is_taken()) << "bit " << bit << " of byte " << byte << " of " << size;
    flip(path_, byte, bit);
  }
  EXPECT_TRUE(newest_is_taken());
}

TEST_F(CheckpointDamage, ACutAnywhereIsFound) {
  const std::string whole = read_text(path_);
  RandomStream random(7, RandomPurpose::test, 2);
  for (int n = 0; n < 200; ++n) {
    const auto length = n < 40 ? whole.size() - 1 - static_cast<std::size_t>(n) : random.below(whole.size());
    fs::resize_file(path_, length);
    EXPECT_FALSE(newest_is_taken()) << "cut to " << length;
    write_text_atomic(path_, whole);
  }
  EXPECT_TRUE(newest_is_taken());
}

TEST_F(CheckpointDamage, BytesAddedOrExchangedAreFound) {
  std::string whole = read_text(path_);
  write_text_atomic(path_, whole + std::string(16, '\0'));
  EXPECT_FALSE(newest_is_taken());
  std::swap_ranges(whole.begin(), whole.begin() + 8, whole.begin() + 30000);
  write_text_atomic(path_, whole);
  EXPECT_FALSE(newest_is_taken());
}

/// A pipe kept the run waiting for ever.
TEST_F(CheckpointDamage, APipeOrAFolderInItsPlaceIsPassedOver) {
  fs::remove(path_);
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  EXPECT_FALSE(newest_is_taken());
  fs::remove(path_);
  fs::create_directory(path_);
  EXPECT_FALSE(newest_is_taken());
}

TEST_F(CheckpointDamage, BothDamagedIsTrouble) {
  flip(path_, 500, 3);
  flip(path_ + ".previous", 600, 3);
  std::string note;
  EXPECT_THROW((void)open_checkpoint(path_, "scene", note), IoError);
}

/// An older file, whole but without the checksum that later ones have, is refused for its schema.
TEST_F(CheckpointDamage, AnotherSchemaIsRefusedAsSuch) {
  {
    h5::AtomicFile file(path_);
    file.root().attribute("kind", "softgrain checkpoint");
    file.root().attribute("schema", std::int64_t{1});
    file.commit();
  }
  std::string note;
  EXPECT_THROW((void)open_checkpoint(path_, "scene", note), InputError);
}

TEST_F(CheckpointDamage, AnotherSceneIsRefusedAsSuch) {
  std::string note;
  EXPECT_THROW((void)open_checkpoint(path_, "another scene", note), InputError);
}

/// Through the program: the one before is taken with a word, and the run ends in the same bits.
TEST(DamagedRun, GoesOnFromTheCheckpointBefore) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("whole"))), 0));
  const auto both = [&] { return fs::exists(runs.out("out") + "/checkpoint.h5.previous"); };
  ASSERT_TRUE(ended_with(signal_when(start_program(runs.arguments("out")), both, SIGTERM), 130));
  RandomStream random(7, RandomPurpose::test, 3);
  for (int n = 0; n < 8; ++n) {
    const std::string out = "out" + std::to_string(n);
    fs::copy(runs.out("out"), runs.out(out), fs::copy_options::recursive);
    const std::string checkpoint = runs.out(out) + "/checkpoint.h5";
    if (n % 2 == 0)
      flip(checkpoint, random.below(fs::file_size(checkpoint)), 5);
    else
      fs::resize_file(checkpoint, random.below(fs::file_size(checkpoint)));
    ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments(out, {"--resume"}))), 0));
    EXPECT_NE(log_of(runs.out(out)).find("continuing from the checkpoint before it"), std::string::npos);
    expect_same_runs(runs.out("whole"), runs.out(out));
  }
}

TEST(DamagedRun, CheckSaysWhatIsGoneOrExchanged) {
  const KindRuns runs({"grain-box", "run", kTinyGrainBox, 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("out"))), 0));
  const std::string record = runs.out("out") + "/grain_box.h5";
  const auto expect_check = [&](int status, const std::string& words) {
    const ProgramOutcome outcome = run_the_program("check '" + runs.out("out") + "' --threads 1");
    EXPECT_EQ(outcome.status, status) << outcome.output;
    EXPECT_NE(unwrapped(outcome.output).find(words), std::string::npos) << words << " not in " << outcome.output;
  };
  fs::remove(record);
  expect_check(0, "the run wrote grain_box.h5, which is not here any more");
  tiny_measurements(record);
  expect_check(4, "grain_box.h5: does not hold what files of this name hold");
}

/// Of a run of many tasks, one whose every copy is damaged is done again with a word; the others go on. The kept states
/// of a task and its own checkpoint belong together.
TEST(DamagedRun, StartsATaskAfreshOfWhichNothingIsLeft) {
  const KindRuns runs({"pipeline", "run", kTinyPipeline, 3});
  const std::vector<std::string> one{"--threads", "1"};
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("whole", one))), 3));
  const std::string work = runs.out("out") + "/work/";
  const auto begun = [&] { return fs::exists(work + "macro-shelled-0.h5"); };
  ASSERT_TRUE(
      interrupted_in_the_middle([&] { return start_program(runs.arguments("out", one)); }, begun, runs.out("out")));
  for (const std::string task : {"damped-soft-solid-0-slow-turn", "damped-soft-solid-0-slow-turn-states",
                                 "damped-soft-soft-1", "macro-shelled-0", "macro-law-0-states"}) {
    const std::string out = "out-" + task;
    fs::copy(runs.out("out"), runs.out(out), fs::copy_options::recursive);
    const std::string file = runs.out(out) + "/work/" + task + ".h5";
    ASSERT_TRUE(fs::exists(file)) << task;
    flip(file, fs::file_size(file) / 2, 4);
    if (fs::exists(file + ".previous")) fs::resize_file(file + ".previous", 100);
    const int status = wait_for(start_program(runs.arguments(out, {"--threads", "1", "--resume"})));
    EXPECT_TRUE(ended_with(status, 3)) << task << status;
    EXPECT_NE(log_of(runs.out(out)).find(task + " starts afresh"), std::string::npos) << task;
    expect_same_runs(runs.out("whole"), runs.out(out));
  }
}

/// The task went on with states of an earlier moment: those in between were not in the results, and nothing said so.
TEST(DamagedRun, DoesNotTakeStatesThatAreOlderThanTheirTask) {
  const KindRuns runs({"soft-particle", "microsim", kTinySoftParticle, 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("whole"))), 0));
  const std::string ending = ".previous";
  const auto states = [&] {
    std::string found;
    std::error_code not_there_yet;
    for (const auto& entry : fs::directory_iterator(runs.out("out") + "/work", not_there_yet))
      if (entry.path().string().ends_with("-states.h5" + ending)) found = entry.path().string();
    return found;
  };
  const auto start = [&] {
    return start_program(runs.arguments("out", {"--threads", "1", "--checkpoint-every", "0"}));
  };
  ASSERT_TRUE(interrupted_in_the_middle(
      start, [&] { return !states().empty(); }, runs.out("out")));
  const std::string name = fs::path(states()).filename().string();
  for (const std::string out : {"flipped", "newest-gone", "all-gone"}) {
    fs::copy(runs.out("out"), runs.out(out), fs::copy_options::recursive);
    const std::string older = (fs::path(runs.out(out)) / "work" / name).string();
    const std::string file = older.substr(0, older.size() - ending.size());
    if (out == "flipped")
      flip(file, fs::file_size(file) / 2, 4);
    else
      fs::remove(file);
    if (out == "all-gone") fs::remove(older);
    ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments(out, {"--resume"}))), 0));
    EXPECT_NE(log_of(runs.out(out)).find("starts afresh"), std::string::npos) << out;
    expect_same_runs(runs.out("whole"), runs.out(out));
  }
}

/// All tasks of a run have the fingerprint of its scene.
TEST(DamagedRun, DoesNotTakeTheFileOfAnotherTask) {
  const KindRuns runs({"powder", "run", kTinyPowder, 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("whole"))), 0));
  const std::string work = runs.out("out") + "/work/";
  const auto begun = [&] { return fs::exists(work + "powder-0.h5") && fs::exists(work + "powder-1.h5"); };
  const auto start = [&] {
    return start_program(runs.arguments("out", {"--threads", "2", "--checkpoint-every", "0"}));
  };
  ASSERT_TRUE(interrupted_in_the_middle(start, begun, runs.out("out")));
  fs::copy_file(work + "powder-0.h5", work + "powder-1.h5", fs::copy_options::overwrite_existing);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("out", {"--resume"}))), 0));
  EXPECT_NE(log_of(runs.out("out")).find("holds the task powder-0: powder-1 starts afresh"), std::string::npos);
  expect_same_runs(runs.out("whole"), runs.out("out"));
}

/// The files below a run directory from which --resume goes on.
std::vector<fs::path> kept_files(const std::string& directory) {
  std::vector<fs::path> kept;
  std::error_code not_there_yet;
  for (const auto& entry : fs::recursive_directory_iterator(directory, not_there_yet)) {
    const std::string name = entry.path().filename().string();
    const bool checkpoint = name.starts_with("checkpoint.h5") || entry.path().parent_path().filename() == "work";
    if (checkpoint && entry.is_regular_file() && !name.ends_with(".tmp")) kept.push_back(entry.path());
  }
  return kept;
}

/// Whatever the kind: where every copy of everything that was kept is damaged, the run begins again with a word, and
/// ends in the same bits.
class DamagedEverywhere : public ::testing::TestWithParam<KindScene> {
 protected:
  DamagedEverywhere() : runs_(GetParam()) {}

  void interrupt() const {
    const auto start = [&] { return start_program(runs_.arguments("out", {"--checkpoint-every", "0"})); };
    const auto begun = [&] { return !kept_files(runs_.out("out")).empty(); };
    ASSERT_TRUE(interrupted_in_the_middle(start, begun, runs_.out("out")));
  }
  static void damage(const std::vector<fs::path>& files) {
    for (std::size_t k = 0; k < files.size(); ++k)
      if (k % 2 == 0)
        flip(files[k].string(), fs::file_size(files[k]) / 2, 4);
      else
        fs::resize_file(files[k], fs::file_size(files[k]) / 3);
  }
  /// Of the run, and of the parts of a series.
  [[nodiscard]] std::string logs() const {
    std::string text;
    for (const auto& entry : fs::recursive_directory_iterator(runs_.out("out")))
      if (entry.path().filename() == "log.txt") text += log_of(entry.path().parent_path().string());
    return text;
  }
  void expect_to_start_afresh() const {
    ASSERT_TRUE(ended_with(wait_for(start_program(runs_.arguments("whole"))), GetParam().status));
    interrupt();
    const std::vector<fs::path> kept = kept_files(runs_.out("out"));
    ASSERT_FALSE(kept.empty());
    damage(kept);
    const int status = wait_for(start_program(runs_.arguments("out", {"--resume"})));
    EXPECT_TRUE(ended_with(status, GetParam().status)) << status;
    EXPECT_NE(logs().find("starts afresh"), std::string::npos) << logs();
    expect_same_runs(runs_.out("whole"), runs_.out("out"));
  }

  KindRuns runs_;
};

TEST_P(DamagedEverywhere, StartsAfreshWhereNothingIsLeft) { expect_to_start_afresh(); }
INSTANTIATE_TEST_SUITE_P(Kinds, DamagedEverywhere, ::testing::ValuesIn(quick_kinds_with_tasks()), name_of_kind);

using SlowDamagedEverywhere = DamagedEverywhere;
TEST_P(SlowDamagedEverywhere, StartsAfreshWhereNothingIsLeft) { expect_to_start_afresh(); }
INSTANTIATE_TEST_SUITE_P(Kinds, SlowDamagedEverywhere, ::testing::ValuesIn(slow_kinds()), name_of_kind);

/// A law that was changed between two parts of a run is another run.
TEST(DamagedRun, DoesNotGoOnWithAnotherLaw) {
  const KindRuns runs({"macro-comparison", "run", kTinyComparison, 0});
  const std::string work = runs.out("out") + "/work";
  const auto begun = [&] { return fs::exists(work) && !fs::is_empty(work); };
  ASSERT_TRUE(ended_with(signal_when(start_program(runs.arguments("out")), begun, SIGTERM), 130));
  LawCard other = synthetic::card();
  other.pairs.at(0).normal.a.value *= 2.0;
  other.pairs.at(0).normal.c.value *= 2.0;
  save_card(other, runs.out("law.toml"));
  const std::string errors = runs.out("errors.txt");
  EXPECT_TRUE(ended_with(wait_for(start_program(runs.arguments("out", {"--resume"}), errors_to(errors))), 2));
  EXPECT_NE(read_text(errors).find("another scene"), std::string::npos) << read_text(errors);
}

/// Result files have no seal of their own; cut short they are refused wherever they are read.
TEST(DamagedResults, CutShortAreRefused) {
  const TemporaryDirectory directory;
  const std::string file = directory.file("measurements.h5");
  save(synthetic::measurements(), file, {});
  const std::string whole = read_text(file);
  RandomStream random(7, RandomPurpose::test, 4);
  for (int n = 0; n < 12; ++n) {
    write_text_atomic(file, whole.substr(0, random.below(whole.size())));
    const auto outcome = run_the_program("calibrate '" + file + "' --out '" + directory.file("out") + "'");
    EXPECT_EQ(outcome.status, 4) << outcome.output;
    EXPECT_NE(outcome.output.find(file), std::string::npos) << outcome.output;
    EXPECT_FALSE(fs::exists(directory.file("out") + "/law.toml"));
  }
}

}  // namespace
