// What a directory of an earlier run is to a new one: nothing of it is left among the results, nothing that somebody
// may still want is lost, and --resume goes on with the same run alone.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "common/contact/make_laws.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_macro.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

constexpr const char* kParticles = R"(kind = "particles"
title = "one grain"
[material.glass]
density = 2500.0
E = 1e7
nu = 0.25
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 1.0
mu = 0.0
[[particle]]
material = "glass"
radius = 0.01
position = [0.0, 0.0, 0.0]
velocity = [1.0, 0.0, 0.0]
[time]
end = 1.0e-4
)";

class RunDirectory : public ::testing::Test {
 protected:
  RunDirectory() {
    save_card(synthetic::card(), file("law.toml"));
    write_text_atomic(file("macro.toml"), kMacroOfAMoment);
    write_text_atomic(file("particles.toml"), kParticles);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  [[nodiscard]] std::string out(const std::string& name = "") const { return file("out") + "/" + name; }
  ProgramOutcome macro(const std::string& more = "") {
    return run_the_program("macrosim '" + file("macro.toml") + "' --quiet --out '" + file("out") + "' " + more);
  }
  ProgramOutcome particles(const std::string& more = "") {
    return run_the_program("microsim '" + file("particles.toml") + "' --quiet --out '" + file("out") + "' " + more);
  }
  static void expect(const ProgramOutcome& outcome, int status, const std::vector<std::string>& words = {}) {
    EXPECT_EQ(outcome.status, status) << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in " << outcome.output;
  }

  TemporaryDirectory directory_;
};

TEST_F(RunDirectory, ARunOfAnotherKindLeavesNothingInTheReport) {
  expect(macro(), 0);
  ASSERT_TRUE(fs::exists(out("macro.h5")));
  write_text_atomic(out("notes.txt"), "mine");
  write_text_atomic(out("macro_mine.h5"), "mine, and no file of a run");
  expect(particles(), 0);
  for (const char* name : {"macro.h5", "macro_initial.h5"}) EXPECT_FALSE(fs::exists(out(name))) << name;
  EXPECT_EQ(read_text(out("report.html")).find("Macro scene"), std::string::npos);
  EXPECT_EQ(read_text(out("notes.txt")), "mine");
  EXPECT_TRUE(fs::exists(out("macro_mine.h5")));
}

TEST_F(RunDirectory, TheSameKindStartsAnewAndResumeKeeps) {
  expect(macro(), 0);
  ASSERT_TRUE(fs::exists(out("states_macro.h5")));
  save(synthetic::measurements(4), out("measurements.h5"));
  expect(macro("--set output.snapshots=0"), 0);
  EXPECT_FALSE(fs::exists(out("measurements.h5")));
  EXPECT_FALSE(fs::exists(out("states_macro.h5"))) << "of the run before";
  save(synthetic::measurements(4), out("measurements.h5"));
  expect(macro("--resume --set output.snapshots=0"), 0);
  EXPECT_TRUE(fs::exists(out("measurements.h5")));
}

TEST_F(RunDirectory, ExportsAndFiguresOfAnEarlierRunGoAndWhatAUserPutThereStays) {
  expect(macro(), 0);
  expect(run_the_program("export '" + file("out") + "' --to vtp"), 0);
  expect(run_the_program("export '" + file("out") + "' --to csv"), 0);
  write_text_atomic(out("export-csv/mine.txt"), "mine");
  write_text_atomic(out("figures/mine.svg"), "<svg aria-label=\"of another program\"></svg>");
  const auto names = [&](const std::string& directory) {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(out(directory))) found.insert(entry.path().filename().string());
    return found;
  };
  write_text_atomic(out("curves/mine.csv"), "hn [mm],Fn [N]\n1,2\n");
  const std::set<std::string> of_macro = names("figures");
  EXPECT_GT(of_macro.size(), 1U);
  expect(particles(), 0);
  EXPECT_FALSE(fs::exists(out("export-vtp")));
  EXPECT_EQ(names("export-csv"), std::set<std::string>{"mine.txt"});
  for (const char* name : {"states_macro.xdmf", "states_macro_contacts.xdmf"})
    EXPECT_FALSE(fs::exists(out(name))) << name;
  const std::string other = file("other");
  expect(run_the_program("microsim '" + file("particles.toml") + "' --quiet --out '" + other + "'"), 0);
  std::set<std::string> expected{"mine.svg"};
  for (const auto& entry : fs::directory_iterator(other + "/figures"))
    expected.insert(entry.path().filename().string());
  EXPECT_EQ(names("figures"), expected);
  std::set<std::string> tables{"mine.csv"};
  for (const auto& entry : fs::directory_iterator(other + "/curves")) tables.insert(entry.path().filename().string());
  EXPECT_TRUE(tables.contains("energy-over-time.csv"));
  EXPECT_EQ(names("curves"), tables);
  EXPECT_EQ(read_text(out("export-csv/mine.txt")), "mine");
}

TEST_F(RunDirectory, FilesOfNoRunAreNeitherRemovedNorTakenForResults) {
  fs::create_directories(file("out"));
  fs::copy_file(file("law.toml"), out("law.toml"));
  expect(macro(), 2, {"out: holds files that no run of this program left there", "law.toml", "--out"});
  EXPECT_TRUE(fs::exists(out("law.toml")));
  EXPECT_FALSE(fs::exists(out("macro.h5")));
}

TEST_F(RunDirectory, WhatARunReadsStaysWhereItIs) {
  fs::create_directories(file("out"));
  save_card(synthetic::card(), out("law.toml"));
  const std::string law = read_text(out("law.toml"));
  for (int k = 0; k < 2; ++k) {
    expect(macro("--law '" + out("law.toml") + "'"), 0);
    EXPECT_EQ(read_text(out("law.toml")), law);
    EXPECT_TRUE(fs::exists(out("law.h5")));
  }
  // The key of a scene counts as much as the command line.
  write_text_atomic(
      file("macro.toml"),
      std::string(kMacroOfAMoment).replace(std::string(kMacroOfAMoment).find("law.toml"), 8, "out/law.toml"));
  expect(macro(), 0);
  EXPECT_EQ(read_text(out("law.toml")), law);
}

TEST_F(RunDirectory, ResultsBesideAnInputAreNotLost) {
  expect(macro(), 0);
  save(synthetic::measurements(12), out("measurements.h5"));
  const std::string calibrate = "calibrate '" + out("measurements.h5") +
                                "' --quiet --set replicates=0 --set relaxation=damped --out '" + file("out") + "'";
  expect(run_the_program(calibrate), 2, {"macro.h5", "do not belong to this one", "--out"});
  EXPECT_TRUE(fs::exists(out("macro.h5")));
  for (const char* name : {"macro.h5", "macro_initial.h5", "states_macro.h5"}) fs::remove(out(name));
  expect(run_the_program(calibrate), 3, {"no bootstrap replicates"});
  EXPECT_TRUE(fs::exists(out("law.toml")));
  EXPECT_TRUE(fs::exists(out("measurements.h5")));
}

TEST_F(RunDirectory, ComparisonsDoNotReplaceRuns) {
  expect(macro(), 0);
  const std::string run = "'" + file("out") + "' ";
  expect(run_the_program("compare " + run + run + "--out " + run), 2, {"macro.h5", "--out"});
  EXPECT_TRUE(fs::exists(out("macro.h5")));
  EXPECT_TRUE(fs::exists(out("summary.json")));
  const std::string other = "'" + file("compared") + "' ";
  expect(run_the_program("compare " + run + run + "--out " + other), 0);
  expect(run_the_program("compare " + run + run + "--out " + other), 0);
}

TEST_F(RunDirectory, ComparingInsideAnUnfinishedRunSaysSo) {
  fs::create_directories(out("work"));
  save(synthetic::measurements(12), out("measurements.h5"));
  const std::string compare = "compare '" + file("out") + "'";
  expect(run_the_program(compare), 0, {"relaxations", "note: the run has not come to its end", "--resume"});
  fs::remove_all(out("work"));
  EXPECT_EQ(run_the_program(compare).output.find("has not come to its end"), std::string::npos);
}

TEST_F(RunDirectory, ResumeOfAFinishedRunRefusesAnotherSceneSeedOrLaw) {
  LawCard stiffer = synthetic::card();
  stiffer.pairs[0].normal.a.value *= 2.0;
  stiffer.pairs[0].normal.c.value *= 2.0;
  save_card(stiffer, file("stiffer.toml"));
  expect(macro(), 0);
  const std::string macro_file = read_text(out("macro.h5"));
  const std::string summary = read_text(out("summary.json"));
  const std::vector<std::string> words{"belongs to another scene", "--resume"};
  expect(macro("--resume --law '" + file("stiffer.toml") + "'"), 2, words);
  expect(macro("--resume --seed 7"), 2, words);
  expect(macro("--resume --set macro.strain=0.04"), 2, words);
  // What changed, from what to what, and what can be done.
  expect(macro("--resume --set macro.strain=0.04"), 2, {"macro.strain is ", " there and 0.04 now", "another --out"});
  expect(macro("--resume --set title=other"), 2, {"title is ", "other now"});
  expect(macro("--resume --seed 7"), 2, {"its seed is ", " there and 7 now"});
  expect(macro("--resume --law '" + file("stiffer.toml") + "'"), 2, {"its law or data file is another"});
  EXPECT_EQ(read_text(out("macro.h5")), macro_file);
  EXPECT_EQ(read_text(out("summary.json")), summary);
  const double stress = load_macro(out("macro.h5")).at(0).stress_axial.back();
  expect(macro("--resume"), 0);
  EXPECT_EQ(load_macro(out("macro.h5")).at(0).stress_axial.back(), stress);
  expect(particles("--resume"), 2, words);
  EXPECT_EQ(load_macro(out("macro.h5")).at(0).stress_axial.back(), stress);
  // Runs of before say scene and seed in their summary alone.
  fs::remove(out(".run"));
  expect(macro("--resume --seed 7"), 2, words);
  expect(macro("--law '" + file("stiffer.toml") + "'"), 0);
  EXPECT_NE(load_macro(out("macro.h5")).at(0).stress_axial.back(), stress);
}

/// The command of a kind and `run` are two names for the same: either goes on with what the other began.
TEST_F(RunDirectory, RunAndTheCommandOfTheKindGoOnWithEachOther) {
  const auto by_run = [&](const std::string& scene, const std::string& more) {
    return run_the_program("run '" + file(scene) + "' --quiet --out '" + file("out") + "' " + more);
  };
  expect(by_run("macro.toml", "--law '" + file("law.toml") + "'"), 0);
  EXPECT_EQ(summary_of(file("out"))["command"], "macrosim");
  expect(macro("--resume"), 0);
  expect(by_run("macro.toml", "--resume"), 0);
  expect(by_run("macro.toml", "--resume --seed 7"), 2, {"belongs to another scene"});
  expect(macro(), 0);
  expect(by_run("macro.toml", "--resume"), 0);
  expect(by_run("particles.toml", "--law '" + file("law.toml") + "' --bands 20"), 2,
         {"--law, --bands: not for scenes of kind \"particles\"", "\"macro\""});
  expect(by_run("particles.toml", ""), 0);
  EXPECT_EQ(summary_of(file("out"))["command"], "microsim");
  expect(particles("--resume"), 0);
}

}  // namespace
