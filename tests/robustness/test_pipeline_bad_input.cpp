// Wrong pipelines, scenes, cards and data: one clear message with place and key, status 2 or 4, before any work.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "common/io/text_file.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_pipeline.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

class PipelineBadInput : public ::testing::Test {
 protected:
  /// Replaces the first `from` of the good pipeline by `to`; expects status 2 and, in one line, the place and all
  /// words.
  void expect(const std::string& from, const std::string& to, const std::vector<std::string>& words,
              const std::string& more = "") {
    std::string text = kTinyPipeline;
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    expect_text(text.replace(at, from.size(), to), words, more);
  }
  void expect_text(const std::string& text, const std::vector<std::string>& words, const std::string& more = "",
                   const std::string& command = "run") {
    write_text_atomic(directory_.file("scene.toml"), text);
    check(command + " '" + directory_.file("scene.toml") + "' --out '" + out() + "' " + more, 2, words);
    EXPECT_TRUE(nothing_done());
  }
  static void check(const std::string& arguments, int status, const std::vector<std::string>& words) {
    const ProgramOutcome outcome = run_the_program(arguments);
    EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in: " << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    EXPECT_EQ(outcome.output.rfind("softgrain: ", 0), 0U) << outcome.output;
  }
  [[nodiscard]] std::string out() const { return directory_.file("out"); }
  [[nodiscard]] bool nothing_done() const { return !fs::exists(out()) || fs::is_empty(out()); }
  TemporaryDirectory directory_;
};

TEST_F(PipelineBadInput, ATableOfLawsIsOneAndGoesWithAMacroScene) {
  const std::string card = SOFTGRAIN_SOURCE_DIR "/results/published/law.toml";
  const std::string table = SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml";
  expect("[macro]", "[law]\ntable = \"" + card + "\"\n[macro]", {"scene.toml:28", "table = ", "is no law table"});
  expect("[macro]", "[law]\ntable = \"" + table + "\"\nform = \"pair\"\n[macro]",
         {"scene.toml:29", "form = ", "the one that this run measures"});
  expect("[macro]\nbodies = 8\nsteps = 4\nstrain = 0.3\n", "[law]\ntable = \"" + table + "\"\n",
         {"scene.toml:27", "law: ", "goes with [macro]"});
  expect("[macro]", "[law]\ntabel = \"" + table + "\"\n[macro]", {"'table'"});
}

TEST_F(PipelineBadInput, UnknownKeysNameTheNearest) {
  expect("trials = 100", "trails = 100", {"scene.toml:9", "unknown key 'trails'", "nearest known key is 'trials'"});
  expect("relaxation = \"damped\"", "relaxation = \"damped\"\nshell_turn = true",
         {"scene.toml:16", "nearest known key is 'shell_turns'"});
  expect("[macro]", "[makro]", {"scene.toml:27", "'makro'", "'macro'"});
  expect("bodies = 8", "bodys = 8", {"scene.toml:28", "'bodys'", "'bodies'"});
  expect("increment = 0.02", "incremnt = 0.02", {"scene.toml:17", "'increment'"});
  expect("[measure.soft_soft]", "[measure.softsoft]", {"scene.toml:22", "'soft_soft'"});
  expect("min_packings = 2", "min_packing = 2", {"scene.toml:25", "'min_packings'"});
}

TEST_F(PipelineBadInput, UnitsMustFit) {
  expect("\"16 mm\"", "\"16 Pa\"", {"scene.toml:8: shell_radius", "unknown unit 'Pa'", "mm"});
  expect("\"0.5 MPa\"", "\"0.5 mm\"", {"scene.toml:5: E", "unknown unit 'mm'"});
  expect("\"16 mm\"", "\"sixteen\"", {"scene.toml:8: shell_radius", "must be a number"});
  expect("mu = 0.3", "mu = \"0.3 N\"", {"scene.toml:6: mu", "'N'"});
}

TEST_F(PipelineBadInput, MaterialAndSizes) {
  expect("\"0.5 MPa\"", "0.0", {"scene.toml:5: E = 0", "above 0"});
  expect("\"0.5 MPa\"", "-1e5", {"scene.toml:5: E = -100000", "above 0"});
  expect("\"0.5 MPa\"", "nan", {"scene.toml:5: E = nan", "finite"});
  expect("\"0.5 MPa\"", "inf", {"scene.toml:5: E = inf", "finite"});
  expect("mu = 0.3", "mu = -0.1", {"scene.toml:6: mu = -0.1", "from 0 to 1000"});
  expect("mu = 0.3", "nu = 0.51", {"scene.toml:6: nu = 0.51", "0.5"});
  expect("mu = 0.3", "density = 0", {"scene.toml:6: density = 0", "above 0"});
  expect("mu = 0.3", "restitution = 1.1", {"scene.toml:6: restitution = 1.1", "from 0 to 1"});
  expect("\"16 mm\"", "0.0", {"scene.toml:8: shell_radius = 0", "above 0"});
  expect("\"16 mm\"", "\"-16 mm\"", {"scene.toml:8: shell_radius", "above 0"});
  expect("\"16 mm\"", "nan", {"scene.toml:8: shell_radius", "finite"});
}

TEST_F(PipelineBadInput, Packings) {
  expect("beta = 8.0", "beta = 1.0", {"scene.toml:12: beta = 1", "above 1"});
  expect("beta = 8.0", "beta = 0.5", {"scene.toml:12: beta = 0.5", "above 1"});
  expect("polydispersity = 5.0", "polydispersity = 1.0", {"scene.toml:10: polydispersity = 1", "above 1"});
  expect("polydispersity = 5.0", "exponent = 1.0", {"scene.toml:10: exponent = 1", "above 1"});
  expect("rmax_over_shell = 0.5", "rmax_over_shell = 1.0", {"scene.toml:11: rmax_over_shell = 1", "below 1"});
  expect("rmax_over_shell = 0.5", "rmax = \"17 mm\"", {"scene.toml:11: rmax", "larger than the largest grain"});
  expect("rmax_over_shell = 0.5", "rmax = 0", {"scene.toml:11: rmax = 0", "above 0"});
  expect("rmax_over_shell = 0.5", "rmax_over_shell = 0.5\nrmax = \"8 mm\"", {"rmax_over_shell"});
  expect("trials = 100", "trials = 0", {"scene.toml:9: trials = 0", "from 1"});
  expect("trials = 100", "trials = 10.5", {"scene.toml:9: trials = 10.5", "whole number"});
  expect("count = 4", "count = 0", {"scene.toml:13: count = 0", "from 1"});
}

TEST_F(PipelineBadInput, Measurements) {
  expect("deltas = [0.1, 0.2,", "deltas = [0.2, 0.1,", {"scene.toml:19: deltas", "ascend"});
  expect("deltas = [0.1, 0.2,", "deltas = [0.1, 0.1,", {"scene.toml:19: deltas", "ascend"});
  expect("deltas = [0.1, 0.2,", "deltas = [0.0, 0.2,", {"scene.toml:19: deltas", "above 0"});
  expect("deltas = [0.1, 0.2,", "deltas = [nan, 0.2,", {"scene.toml:19: deltas", "finite"});
  expect("deltas = [0.1, 0.2, 0.3, 0.35, 0.4, 0.45]", "deltas = []", {"scene.toml:19: deltas", "at least one"});
  expect("tangential_deltas = [0.35,", "tangential_deltas = [0.34,",
         {"scene.toml:20: tangential_deltas", ": 0.34 is not among deltas"});
  expect("angles_deg = [-0.05, 0.05]", "angles_deg = [-0.05, 0.0]",
         {"scene.toml:21: angles_deg", "0 is recorded anyway"});
  expect("angles_deg = [-0.05, 0.05]", "angles_deg = [-91.0]", {"scene.toml:21: angles_deg", "-90"});
  expect("relaxation = \"damped\"", "relaxation = \"dampd\"", {"scene.toml:15: relaxation", "damped"});
  expect("increment = 0.02", "increment = 0", {"scene.toml:17: increment = 0", "from 1e-07 to 0.1"});
  expect("increment = 0.02", "tolerance = -1", {"scene.toml:17: tolerance = -1", "above 0"});
  const auto least_work = [&](const std::string& line, const std::vector<std::string>& words) {
    expect("[measure.damped]", "[measure.least_work]\n" + line + "\n[measure.damped]", words);
  };
  least_work("settle_time = -1", {"scene.toml:17: settle_time = -1", "from 0 to 1000000"});
  // So long that its steps could not be counted: none was made.
  for (const char* key : {"settle_time", "path_settle_time", "settle_time_rotated"})
    least_work(std::string(key) + " = 1e99", {std::string("scene.toml:17: ") + key + " = 1e+99", "from 0 to 1000000"});
  least_work("step_factor = 1e-30", {"scene.toml:17: step_factor = 1e-30", "from 0.01 to 20"});
  least_work("step_factor_rotated = 1e-30", {"scene.toml:17: step_factor_rotated = 1e-30", "from 0.01 to 20"});
  // 1e-7 and 10 of sqrt(E/rho), 14.1421 m/s here.
  least_work("approach_speed = 200", {"scene.toml:17: approach_speed = 200", "from 1.41421356"});
  least_work("approach_speed = 1e-6", {"scene.toml:17: approach_speed = 1e-06", "from 1.41421356"});
  const auto published = [&](const std::string& line, const std::vector<std::string>& words) {
    expect("[measure.damped]", "[measure.published]\n" + line + "\n[measure.damped]", words);
  };
  published("approach_speed = 200", {"scene.toml:17: approach_speed = 200", "from 1.41421356"});
  published("stop_interval = 1e29", {"scene.toml:17: stop_interval = 1e+29", "at most 1131.37"});
  published("step_fraction = 1e-30", {"scene.toml:17: step_fraction = 1e-30", "from 0.002 to 0.6"});
  published("crowded_fraction = 1e-30", {"scene.toml:17: crowded_fraction = 1e-30", "from 0.01 to 1"});
  least_work("increment = 0.5", {"scene.toml:17: increment = 0.5", "0.1"});
  least_work("approach_speed = 0", {"scene.toml:17: approach_speed = 0", "from 1.41421356"});
  least_work("step_factor = 30", {"scene.toml:17: step_factor = 30", "20"});
  expect("increment = 0.02", "incremnt = 0.02", {"scene.toml:17", "unknown key 'incremnt'", "'increment'"});
  expect("[calibrate]", "[reference]\nrelaxation = \"damped\"\n[reference.soft_solid]\ndeltas = [0.2]\n[calibrate]",
         {"scene.toml:25: relaxation = \"damped\"", "must differ"});
}

TEST_F(PipelineBadInput, MultiContactsAreMeasuredForAMacroSceneAndInOnePlaceOnly) {
  const std::string one = "[[configuration]]\narrangement = \"one\"\npartner = \"plane\"\noverlap = 0.4\n";
  const std::string table = SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml";
  expect("[macro]", one + "[law]\ntable = \"" + table + "\"\n[macro]",
         {"scene.toml:31", "law: ", "measures a multi-contact law already"});
  expect("[macro]\nbodies = 8\nsteps = 4\nstrain = 0.3\n", one, {"configuration: ", "goes with [macro]", "law-table"});
  expect("[macro]", "[multi_contact]\npoints = 4\n[macro]",
         {"scene.toml:27", "multi_contact: ", "goes with [[configuration]]"});
  expect("[macro]", one + "[multi_contact]\npackings_min = 2\npackings_max = 3\n[macro]",
         {"packings_max", "min_packings"});
  expect("[macro]", one + "[calibrate.multi_contact]\nbest = \"pair\"\n[macro]",
         {"scene.toml:32: best", "directional"});
  expect("[macro]", "[[configuration]]\narrangement = \"cube\"\npartner = \"plane\"\noverlap = 0.3\n[macro]",
         {"configuration", "one plane alone"});
}

TEST_F(PipelineBadInput, FitAndMacro) {
  expect("min_packings = 2", "min_packings = 1", {"scene.toml:25: min_packings = 1", "from 2"});
  expect("min_packings = 2", "delta_low = 0.3\ndelta_high = 0.2", {"scene.toml:26: delta_high = 0.2", "above 0.3"});
  expect("bodies = 8", "bodies = 0", {"scene.toml:28: bodies = 0", "from 1"});
  expect("bodies = 8", "soft_share = 1.1", {"scene.toml:28: soft_share = 1.1", "from 0 to 1"});
  expect("bodies = 8", "soft_share = -0.1", {"scene.toml:28: soft_share = -0.1", "from 0 to 1"});
  expect("bodies = 8", "solid_radius_max = 0", {"scene.toml:28: solid_radius_max = 0", "above 0"});
  expect("bodies = 8", "soft_radius_max = -0.01", {"scene.toml:28: soft_radius_max = -0.01", "above 0"});
  expect("bodies = 8", "soft_polydispersity = 1", {"scene.toml:28: soft_polydispersity = 1", "above 1"});
  expect("steps = 4", "steps = 0", {"scene.toml:29: steps = 0", "from 1"});
  expect("strain = 0.3", "strain = 0.6", {"scene.toml:30: strain = 0.6", "0.5"});
  expect("strain = 0.3", "test = \"odometric\"", {"scene.toml:30: test", "oedometric"});
}

TEST_F(PipelineBadInput, KindMustBeThatOfTheCommand) {
  expect("kind = \"pipeline\"", "kind = \"pipelin\"", {"scene.toml:1: kind", "pipeline"});
  expect("kind = \"pipeline\"\n", "", {"scene.toml", "missing key 'kind'"});
  expect_text(kTinyPipeline, {"scene.toml:1: kind = \"pipeline\"", "with softgrain run"}, "", "microsim");
  expect_text(kTinyPipeline, {"scene.toml:1: kind = \"pipeline\"", "with softgrain run, not"}, "", "macrosim");
}

TEST_F(PipelineBadInput, MissingTables) {
  expect_text("kind = \"pipeline\"\n", {"scene.toml", "missing table [measure]"});
  expect_text("kind = \"pipeline\"\n[measure]\nrelaxation = \"damped\"\n",
              {"scene.toml:2", "soft_solid", "at least one"});
}

TEST_F(PipelineBadInput, OverridesAreNamedAsSuch) {
  expect("beta = 8.0", "beta = 8.0", {"--set packing.beta", "above 1"}, "--set packing.beta=0.5");
  expect("beta = 8.0", "beta = 8.0", {"--set", "bta", "nearest known key is 'beta'"}, "--set packing.bta=2");
}

TEST_F(PipelineBadInput, OptionsOfTheCommandLine) {
  expect("beta = 8.0", "beta = 8.0", {"--threads 0"}, "--threads 0");
  expect("beta = 8.0", "beta = 8.0", {"--threads 2.5"}, "--threads 2.5");
  expect("beta = 8.0", "beta = 8.0", {"--seed"}, "--seed nine");
}

TEST_F(PipelineBadInput, FilesThatAreNotThere) {
  check("run '" + directory_.file("absent.toml") + "' --out '" + out() + "'", 4, {"absent.toml", "no such file"});
  check("calibrate '" + directory_.file("absent.h5") + "' --out '" + out() + "'", 4, {"absent.h5"});
  write_text_atomic(directory_.file("scene.toml"), "kind = \"macro\"\n[macro]\nbodies = 8\n");
  check("macrosim '" + directory_.file("scene.toml") + "' --law '" + directory_.file("absent-law.toml") + "' --out '" +
            out() + "'",
        4, {"absent-law.toml"});
  check("macrosim '" + directory_.file("scene.toml") + "' --out '" + out() + "'", 2, {"scene.toml", "law", "--law"});
  EXPECT_TRUE(nothing_done());
}

TEST_F(PipelineBadInput, ARunDirectoryThatCannotBeWritten) {
  write_text_atomic(directory_.file("scene.toml"), kTinyPipeline);
  check("run '" + directory_.file("scene.toml") + "' --out /dev/null/run", 4, {"/dev/null/run"});
  check("run '" + directory_.file("scene.toml") + "' --out '" + directory_.file("scene.toml") + "'", 4, {"scene.toml"});
  if (::geteuid() == 0) return;  // nothing is unwritable for root
  fs::create_directory(out());
  fs::permissions(out(), fs::perms::owner_read | fs::perms::owner_exec);
  check("run '" + directory_.file("scene.toml") + "' --out '" + out() + "'", 4, {out()});
}

/// Files of a good run, cut short.
class DamagedFiles : public PipelineBadInput {
 protected:
  void SetUp() override {
    write_text_atomic(directory_.file("scene.toml"), kTinyPipeline);
    const std::string good = directory_.file("good");
    ASSERT_TRUE(
        ended_with(wait_for(start_program({"run", directory_.file("scene.toml"), "--out", good, "--quiet"})), 3));
    measurements_ = good + "/measurements.h5";
    law_ = good + "/law.toml";
  }
  std::string measurements_;
  std::string law_;
};

TEST_F(DamagedFiles, TruncatedMeasurements) {
  const auto size = fs::file_size(measurements_);
  for (const double share : {0.9, 0.5, 0.01, 0.0}) {
    fs::resize_file(measurements_, static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    check("calibrate '" + measurements_ + "' --out '" + out() + "'", 4, {measurements_});
    EXPECT_TRUE(nothing_done());
  }
}

TEST_F(DamagedFiles, TruncatedLawCards) {
  write_text_atomic(directory_.file("macro.toml"), "kind = \"macro\"\n[macro]\nbodies = 8\nresolved = false\n");
  const std::string text = read_text(law_);
  for (const double share : {0.9, 0.5, 0.2, 0.0}) {
    write_text_atomic(law_, text.substr(0, static_cast<std::size_t>(share * static_cast<double>(text.size()))));
    const auto outcome =
        run_the_program("macrosim '" + directory_.file("macro.toml") + "' --law '" + law_ + "' --out '" + out() + "'");
    EXPECT_TRUE(outcome.status == 2 || outcome.status == 4) << outcome.status << outcome.output;
    EXPECT_NE(outcome.output.find("law.toml"), std::string::npos) << outcome.output;
    EXPECT_TRUE(nothing_done());
  }
}

TEST_F(DamagedFiles, OtherFilesAreNotTakenForData) {
  check("calibrate '" + law_ + "' --out '" + out() + "'", 4, {"law.toml"});
  write_text_atomic(directory_.file("macro.toml"), "kind = \"macro\"\n[macro]\nbodies = 8\n");
  check("macrosim '" + directory_.file("macro.toml") + "' --law '" + directory_.file("macro.toml") + "' --out '" +
            out() + "'",
        2, {"macro.toml"});
  EXPECT_TRUE(nothing_done());
}

}  // namespace
