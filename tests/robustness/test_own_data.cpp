// Own data through the program: a law from a CSV and a macro run with it, the reverse search, the files for calibration
// tools; what is wrong is refused with exit status 2.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/io/text_file.h"
#include "tests/support/markup_check.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"
#include "tests/support/synthetic_law.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;
namespace fs = std::filesystem;

/// The published law with noise, in mm and N.
std::string made_up_curve(double factor, double noise = 0.01) {
  RandomStream random(5, RandomPurpose::test, 0);
  std::ostringstream text;
  text << "# Rs = 16 mm\n# E = 0.5 MPa\nhn [mm]; Fn [N]\n";
  for (int k = 1; k <= 30; ++k) {
    const double d = 0.01 * k;
    text << 16.0 * d << "; " << factor * 128.0 * KnownLaw{}.value(d) + noise * normal_number(random) << "\n";
  }
  return text.str();
}

constexpr const char* kMacro = R"(kind = "macro"
title = "tiny"
seed = 1
[macro]
bodies = 12
steps = 3
strain = 0.2
resolved = false
)";

/// About 40 grains per packing: the search itself is what is tested.
constexpr const char* kInverse = R"(kind = "inverse"
seed = 1
[packing]
trials = 5000
polydispersity = 4.0
rmax_over_shell = 0.5
beta = 6.0
placement = "voids"
count = 6
[measure]
relaxation = "damped"
[measure.damped]
increment = 0.02
tolerance = 1e-2
[target]
file = "target.csv"
[search]
mu = [0.05, 0.9]
budget = 14
replicates = 100
)";

class OwnData : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  void write(const std::string& name, const std::string& text) const { write_text_atomic(file(name), text); }
  [[nodiscard]] json summary(const std::string& run) const {
    return json::parse(read_text(file(run) + "/summary.json"));
  }
  ProgramOutcome calibrate(const std::string& inputs, const std::string& out, const std::string& more = "") const {
    ProgramOutcome outcome =
        run_the_program("calibrate " + inputs + " --quiet --set replicates=60 --out '" + file(out) + "' " + more);
    outcome.output = unwrapped(outcome.output);
    if (std::filesystem::exists(file(out) + "/log.txt")) outcome.output += log_of(file(out));
    return outcome;
  }
  static void expect(const ProgramOutcome& outcome, int status, const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.status, status) << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in " << outcome.output;
  }

  /// A target by our own simulation with mu = 0.3 and another seed, as a CSV with errors.
  void write_target(const std::string& scene_text, int packings) const {
    std::string scene = scene_text.substr(0, scene_text.find("[target]"));
    scene.replace(scene.find("inverse"), 7, "soft-particle");
    scene += "[measure.soft_solid]\ndeltas = [0.1, 0.2, 0.3, 0.4]\n";
    write("made.toml", scene);
    const auto outcome =
        run_the_program("microsim '" + file("made.toml") + "' --quiet --seed 77 --set material.mu=0.3 " +
                        "--set packing.count=" + std::to_string(packings) + " --out '" + file("made") + "'");
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.output;
    std::ostringstream text;
    text << "Delta, Fn [N], se [N]\n0.0, 0.0, 0.001\n";  // five points are the least that a file may have
    const json made = summary("made");
    for (const json& row : made["forces"]["soft-solid"])
      text << row["delta"].get<double>() << ", " << row["force"].get<double>() << ", "
           << row["standard_error"].get<double>() << "\n";
    write("target.csv", text.str());
  }

  TemporaryDirectory directory_;
};

TEST_F(OwnData, ACsvGivesALawThatAMacroRunTakes) {
  write("plane.csv", made_up_curve(1.0));
  write("macro.toml", kMacro);
  expect(calibrate("'" + file("plane.csv") + "'", "law", "--kind soft-solid --set mirror=true"), 0,
         {"soft-solid: good", "residuals", "law card"});
  const LawCard card = load_card(file("law") + "/law.toml");
  EXPECT_EQ(card.relaxation, "experiment");
  ASSERT_EQ(card.pairs.size(), 2U);
  EXPECT_NEAR(card.pairs[0].normal.value(0.25) / KnownLaw{}.value(0.25), 1.0, 0.02);
  const std::string page = read_text(file("law") + "/report.html");
  EXPECT_EQ(unbalanced_tags(page), "");
  for (const char* words : {"Measured curves", "sample plane", "95 % interval (bootstrap of residuals about the law)"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  EXPECT_EQ(page.find("over packings"), std::string::npos);
  expect(run_the_program("macrosim '" + file("macro.toml") + "' --quiet --law '" + file("law") + "/law.toml' --out '" +
                         file("macro") + "'"),
         0, {});
  expect(run_the_program("check '" + file("law") + "/law.toml'"), 0, {"experiment"});
}

/// A press test measures no tangential stiffness: without an assumed one mu of a scene changed no digit.
TEST_F(OwnData, FrictionCountsWithALawOfAPressTest) {
  write("plane.csv", made_up_curve(1.0));
  write("macro.toml", kMacro);
  expect(calibrate("'" + file("plane.csv") + "'", "law", "--kind soft-solid --set mirror=true"), 0,
         {"tangential stiffness of soft-solid and soft-soft contacts was not measured", "is assumed"});
  const std::string law = "'" + file("law") + "/law.toml'";
  EXPECT_NE(read_text(file("law") + "/law.toml").find("[pair.tangential_assumed]"), std::string::npos);
  expect(run_the_program("law show " + law), 0, {"is assumed"});
  expect(run_the_program("check " + law), 0, {"is assumed"});
  std::vector<double> stress;
  for (const char* mu : {"0", "0.3", "0.6"}) {
    const std::string out = file(std::string("mu") + mu);
    expect(run_the_program("macrosim '" + file("macro.toml") + "' --quiet --law " + law + " --set macro.mu=" + mu +
                           " --set macro.preparation=frictionless --set macro.soft_share=0.9 --out '" + out + "'"),
           0, {});
    EXPECT_NE(read_text(out + "/summary.json").find("is assumed"), std::string::npos);
    stress.push_back(load_macro(out + "/macro.h5").at(0).stress_axial.back());
  }
  EXPECT_GT(std::abs(stress[1] - stress[0]), 1e-4 * stress[0]);
  EXPECT_GT(std::abs(stress[2] - stress[1]), 1e-6 * stress[0]);
}

TEST_F(OwnData, OptionsThatContradictTheFileAreRefused) {
  write("plane.csv", "# kind = soft-solid\n" + made_up_curve(1.0));
  const std::string plane = "'" + file("plane.csv") + "'";
  expect(calibrate(plane, "x", "--kind soft-soft"), 2, {"plane.csv:1", "kind = soft-solid", "--kind soft-soft"});
  expect(calibrate(plane, "x", "--radius '32 mm'"), 2, {"plane.csv:2", "Rs = 16 mm", "--radius 0.032 m"});
  expect(calibrate(plane, "x", "--modulus '1 MPa'"), 2, {"plane.csv:3", "E = 0.5 MPa", "--modulus 1e+06 Pa"});
  EXPECT_FALSE(fs::exists(file("x") + "/law.toml"));
  expect(calibrate(plane, "law", "--kind soft-solid --radius 1.6cm --modulus 500kPa"), 0, {"soft-solid: good"});
  write("scene.toml", kInverse);
  write("target.csv",
        "# kind = soft-solid\n# Rs = 20 mm\nDelta, Fn [N]\n0.1, 0\n0.2, 0.1\n0.3, 0.4\n0.4, 0.9\n0.5, 2\n");
  expect(run_the_program("check '" + file("scene.toml") + "'"), 2, {"Rs = 20 mm", "shell_radius of [packing]"});
}

TEST_F(OwnData, AForceOffsetIsTakenOff) {
  std::string text = "# kind = soft-solid\n# Rs = 16 mm\n# E = 0.5 MPa\nhn [mm]; Fn [N]\n";
  RandomStream random(5, RandomPurpose::test, 0);
  for (int k = 1; k <= 30; ++k) {
    const double d = 0.01 * k;
    text += std::to_string(16.0 * d) + "; " +
            std::to_string(0.5 + 128.0 * KnownLaw{}.value(d) + 0.002 * normal_number(random)) + "\n";
  }
  write("plane.csv", text);
  const std::string plane = "'" + file("plane.csv") + "'";
  expect(calibrate(plane, "law"), 0, {"soft-solid: good", "was subtracted from all forces"});
  EXPECT_NEAR(128.0 * load_card(file("law") + "/law.toml").pairs.at(0).normal.value(0.2), 128.0 * KnownLaw{}.value(0.2),
              0.01);
  EXPECT_NEAR(summary("law")["experiment"][0]["force"][0].get<double>(), 0.0, 0.02);
  expect(run_the_program("check " + plane), 0, {"was subtracted from all forces"});
  const ProgramOutcome kept = calibrate(plane, "kept", "--set offset=keep");
  EXPECT_EQ(kept.output.find("was subtracted from all forces"), std::string::npos);
}

/// Names of files may be any bytes.
TEST_F(OwnData, ANameThatIsNoUtf8GivesACardThatCanBeRead) {
  write("M\xfcller.csv", "# kind = soft-solid\n" + made_up_curve(1.0));
  expect(calibrate("'" + file("M\xfcller.csv") + "'", "law"), 0, {});
  EXPECT_NO_THROW((void)load_card(file("law") + "/law.toml"));
  EXPECT_TRUE(summary("law").is_object());
  expect(run_the_program("check '" + file("law") + "'"), 0, {});
}

/// What the data do not say is not known: absent in the card, read back so, and no twin is made of guesses.
TEST_F(OwnData, WhatIsInsideIsNotInvented) {
  write("plane.csv", "# mu = 0.25\n" + made_up_curve(1.0));
  expect(calibrate("'" + file("plane.csv") + "'", "law", "--kind soft-solid --set mirror=true"), 0, {});
  const std::string law = "'" + file("law") + "/law.toml'";
  const std::string text = read_text(file("law") + "/law.toml");
  for (const char* key : {"\nexponent = ", "\npolydispersity", "\nrmax_over_shell", "\nbeta", "\ntrials", "\nplacement",
                          "\npoisson_ratio", "\ndensity", "\nrestitution"})
    EXPECT_EQ(text.find(key), std::string::npos) << key;
  EXPECT_NE(text.find("\nfriction = 0.25"), std::string::npos);
  const LawCard card = load_card(file("law") + "/law.toml");
  EXPECT_FALSE(packing_known(card.spec));
  EXPECT_EQ(card.spec.friction, 0.25);
  EXPECT_FALSE(is_known(card.spec.poisson_ratio));
  EXPECT_EQ(card.spec.shell_radius, 0.016);
  expect(run_the_program("law show " + law), 0, {"from an experiment", "what is inside"});
  EXPECT_NE(read_text(file("law") + "/report.html").find("what is inside is not known"), std::string::npos);

  std::string scene = kMacro;
  write("alone.toml", scene);
  write("twin.toml", scene.replace(scene.find("resolved = false\n"), 17, ""));
  const auto macro = [&](const std::string& command, const std::string& name) {
    return run_the_program(command + " '" + file(name) + "' --quiet --law " + law +
                           (command == "check" ? "" : " --out '" + file(name) + ".run'"));
  };
  for (const char* command : {"macrosim", "check"})
    expect(macro(command, "twin.toml"), 2, {"resolved", "does not say what is inside", "law.toml"});
  EXPECT_FALSE(fs::exists(file("twin.toml") + ".run/macro.h5"));
  expect(macro("check", "alone.toml"), 0, {"nu = 0.3, density = 2500 kg/m^3"});
  expect(macro("macrosim", "alone.toml"), 0, {});
  EXPECT_NE(summary("alone.toml.run")["remarks"].dump().find("nu = 0.3, density = 2500 kg/m^3"), std::string::npos);
}

/// A report that nobody can open shows nothing: of very long series a part is drawn, and it says which.
TEST_F(OwnData, AVeryLongSeriesIsThinnedForDrawingOnly) {
  std::ostringstream text;
  text << "# Rs = 16 mm\n# E = 0.5 MPa\nhn [mm]; Fn [N]\n";
  RandomStream random(6, RandomPurpose::test, 0);
  constexpr int kRows = 30000;
  for (int k = 1; k <= kRows; ++k) {
    const double d = 0.3 * k / kRows;
    // One point far off, which must not be lost among the others.
    const double odd = k == 12345 ? 0.5 : 0.0;
    text.precision(10);
    text << 16.0 * d << "; " << 128.0 * KnownLaw{}.value(d) + odd + 0.01 * normal_number(random) << "\n";
  }
  write("long.csv", text.str());
  expect(calibrate("'" + file("long.csv") + "'", "law", "--kind soft-solid"), 0,
         {"of 30000 points", "are drawn and in the summary; the fit is to all"});
  const json drawn = summary("law")["experiment"][0];
  EXPECT_LE(drawn["delta"].size(), 4000U);
  EXPECT_GE(drawn["delta"].size(), 1000U);
  EXPECT_EQ(drawn["points"], kRows);
  EXPECT_DOUBLE_EQ(drawn["delta"].back().get<double>(), 0.3);
  const std::vector<double> forces = drawn["force"];
  EXPECT_GT(*std::max_element(forces.begin(), forces.begin() + static_cast<std::ptrdiff_t>(forces.size() / 2)), 0.45);
  const std::string page = read_text(file("law") + "/report.html");
  EXPECT_LT(page.size(), 3'000'000U);
  EXPECT_NE(page.find("measured points, of every stretch the lowest and the highest force"), std::string::npos);
  EXPECT_NEAR(load_card(file("law") + "/law.toml").pairs.at(0).normal.value(0.25) / KnownLaw{}.value(0.25), 1.0, 0.01);
}

TEST_F(OwnData, TwoKindsInTwoFilesMakeOneCard) {
  write("plane.csv", "# kind = soft-solid\n" + made_up_curve(1.0));
  write("pair.csv", "# kind = soft-soft\n" + made_up_curve(0.2, 0.002));
  expect(calibrate("'" + file("plane.csv") + "' '" + file("pair.csv") + "'", "law"), 0,
         {"soft-solid: good", "soft-soft: good"});
}

TEST_F(OwnData, WrongInputEndsWithStatusTwoBeforeAnyWork) {
  write("plane.csv", made_up_curve(1.0));
  write("bad.csv", made_up_curve(1.0) + "5.0; \n");
  const std::string plane = "'" + file("plane.csv") + "'";
  expect(calibrate(plane, "x"), 2, {"--kind"});
  expect(calibrate(plane, "x", "--kind hard"), 2, {"soft-soft"});
  expect(calibrate(plane, "x", "--kind soft-solid --radius 16s"), 2, {"--radius", "unknown unit"});
  expect(calibrate("'" + file("bad.csv") + "'", "x", "--kind soft-solid"), 2, {"bad.csv:34", "missing"});
  expect(calibrate(plane, "x", "--kind soft-solid --set replicatse=5"), 2, {"replicates"});
  expect(calibrate(plane + " data.h5", "x", "--kind soft-solid"), 2, {"a run each"});
  expect(calibrate("data.h5", "x", "--kind soft-solid"), 2, {"--kind", ".csv"});
  EXPECT_FALSE(fs::exists(file("x") + "/law.toml"));
}

TEST_F(OwnData, NoThresholdCrossingEndsWithStatusThree) {
  write("flat.csv", made_up_curve(0.0));
  expect(calibrate("'" + file("flat.csv") + "'", "law", "--kind soft-solid"), 3, {"no threshold crossing"});
  EXPECT_EQ(summary("law")["status"], "not usable");
  EXPECT_EQ(load_card(file("law") + "/law.toml").pairs.at(0).status, LawStatus::no_threshold_crossing);
}

TEST_F(OwnData, TheReverseSearchFindsTheFrictionOfATargetMadeWithOtherSeeds) {
  write_target(kInverse, 12);
  write("scene.toml", kInverse);
  const auto outcome =
      run_the_program("run '" + file("scene.toml") + "' --quiet --threads 2 --out '" + file("a") + "'");
  expect(outcome, 0, {"mu = "});
  const json inverse = summary("a")["inverse"];
  const json mu = inverse["parameters"][0];
  EXPECT_LE(mu["interval"][0].get<double>(), 0.3) << outcome.output;
  EXPECT_GE(mu["interval"][1].get<double>(), 0.3) << outcome.output;
  EXPECT_EQ(inverse["evaluations"].size(), 14U);
  EXPECT_LE(inverse["confirmed"]["misfit"].get<double>(), 4.0);
  const std::string page = read_text(file("a") + "/report.html");
  EXPECT_EQ(unbalanced_tags(page), "");
  EXPECT_NE(page.find("The soft particle behind a curve"), std::string::npos);
  EXPECT_FALSE(fs::exists(file("a") + "/work"));
  expect(run_the_program("check '" + file("scene.toml") + "'"), 0, {"14 evaluations", "mu from 0.05 to 0.9"});

  // Other threads, and a run that was stopped: the same bits.
  const std::string again = "run '" + file("scene.toml") + "' --quiet --threads 1 --out '" + file("b") + "'";
  const pid_t child = start_program({"run", file("scene.toml"), "--quiet", "--threads", "1", "--out", file("b")});
  const fs::path seventh = fs::path(file("b")) / "work" / "evaluation-7-packing-0.h5";
  (void)signal_when(
      child, [&] { return fs::exists(seventh); }, SIGTERM);
  expect(run_the_program(again + " --resume"), 0, {});
  EXPECT_EQ(summary("a")["inverse"]["parameters"], summary("b")["inverse"]["parameters"]);
  EXPECT_EQ(read_text(file("a") + "/evaluations.csv"), read_text(file("b") + "/evaluations.csv"));
}

/// Two parameters, packings of the published kind, least work: minutes.
TEST_F(OwnData, SlowTheReverseSearchFindsFrictionAndDensityOfAFullPacking) {
  std::string scene = kInverse;
  const auto replace = [&](const std::string& from, const std::string& to) {
    scene.replace(scene.find(from), from.size(), to);
  };
  replace("polydispersity = 4.0", "polydispersity = 10.0");
  replace("beta = 6.0", "beta = 3.0");
  replace("trials = 5000", "trials = 10000");
  replace("count = 6", "count = 10");
  replace("relaxation = \"damped\"\n[measure.damped]\nincrement = 0.02\ntolerance = 1e-2",
          "relaxation = \"least-work\"");
  replace("mu = [0.05, 0.9]\nbudget = 14", "mu = [0.05, 0.7]\nbeta = [1.5, 5.0]\nbudget = 36");
  write_target(scene, 16);
  replace("beta = 3.0\n", "");  // what is searched is not given as well
  write("scene.toml", scene);
  expect(run_the_program("run '" + file("scene.toml") + "' --quiet --out '" + file("a") + "'"), 0,
         {"mu = ", "beta = "});
  const std::vector<std::pair<std::string, double>> truth{{"beta", 3.0}, {"mu", 0.3}};
  const json parameters = summary("a")["inverse"]["parameters"];
  ASSERT_EQ(parameters.size(), truth.size());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_EQ(parameters[k]["name"], truth[k].first);
    EXPECT_LE(parameters[k]["interval"][0].get<double>(), truth[k].second) << truth[k].first;
    EXPECT_GE(parameters[k]["interval"][1].get<double>(), truth[k].second) << truth[k].first;
  }
}

TEST_F(OwnData, ReverseScenesThatAreWrongAreRefused) {
  write("target.csv", "Delta, Fn [N]\n0.1, 0\n0.2, 0.1\n0.3, 0.4\n0.4, 0.9\n0.5, 2\n");
  const auto refuse = [&](const std::string& from, const std::string& to, const std::vector<std::string>& words) {
    std::string text = kInverse;
    text.replace(text.find(from), from.size(), to);
    write("scene.toml", text);
    expect(run_the_program("run '" + file("scene.toml") + "' --quiet --out '" + file("x") + "'"), 2, words);
  };
  refuse("mu = [0.05, 0.9]", "mu = [0.9, 0.05]", {"scene.toml:18", "mu", "rising"});
  refuse("mu = [0.05, 0.9]", "", {"nothing is searched", "beta"});
  refuse("mu = [0.05, 0.9]", "muu = [0.05, 0.9]", {"nothing is searched"});
  refuse("mu = [0.05, 0.9]", "mu = [0.05, 0.9]\nbeta = [0.5, 2]", {"beta", "above 1"});
  refuse("budget = 14", "budget = 2", {"budget"});
  refuse("file = \"target.csv\"", "delta = [0.1, 0.2, 0.3]\nforce = [0, 1]", {"force", "as many values"});
  refuse("file = \"target.csv\"", "delta = [0.1, 0.2, 0.3]\nforce = [0, 0, 0]", {"above zero"});
  refuse("file = \"target.csv\"", "file = \"target.csv\"\ndiscrepancy = 0", {"discrepancy"});
}

TEST_F(OwnData, ObservablesAreWrittenAsCalibrationToolsReadThem) {
  std::string scene = kInverse;
  scene = scene.substr(0, scene.find("[target]")) + "[measure.soft_solid]\ndeltas = [0.3, 0.5]\n";
  scene.replace(scene.find("inverse"), 7, "soft-particle");
  write("scene.toml", scene);
  const std::string prefix = file("iter0/softgrain_Iter0_Sample3");
  const auto outcome = run_the_program("microsim '" + file("scene.toml") + "' --quiet --set material.mu=0.5 --set " +
                                       "material.mu=0.25 --set packing.beta=5 --observables '" + prefix + "'");
  ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.output;
  EXPECT_EQ(read_text(prefix + "_param.txt"), "# mu beta\n0.25 5\n");
  std::istringstream text(read_text(prefix + "_sim.txt"));
  std::string header;
  std::getline(text, header);
  EXPECT_EQ(header, "# Delta Fn Fn_error");
  double delta = 0.0, force = 0.0, error = 0.0;
  const json rows = json::parse(read_text(prefix + "_run/summary.json"))["forces"]["soft-solid"];
  for (const json& row : rows) {
    ASSERT_TRUE(text >> delta >> force >> error);
    EXPECT_NEAR(force, row["force"].get<double>(), 1e-9 * std::abs(force));
  }
  EXPECT_EQ(delta, 0.5);
  const std::string units = file("iter1/a");
  (void)run_the_program("microsim '" + file("scene.toml") + "' --quiet --set 'material.E=50 GPa' --set " +
                        "'packing.shell_radius=\"20 mm\"' --set measure.relaxation=damped --observables '" + units +
                        "'");
  EXPECT_EQ(read_text(units + "_param.txt"), "# E shell_radius\n5e+10 0.02\n");
  // Without --set there are no parameters, and those of the run before do not pass for its own.
  (void)run_the_program("microsim '" + file("scene.toml") + "' --quiet --observables '" + units + "'");
  EXPECT_TRUE(std::filesystem::exists(units + "_sim.txt"));
  EXPECT_FALSE(std::filesystem::exists(units + "_param.txt"));
  write("grains.toml", "kind = \"particles\"\n");
  expect(run_the_program("microsim '" + file("grains.toml") + "' --observables '" + file("p") + "'"), 2, {"particles"});
}

TEST_F(OwnData, TheExampleForCalibrationToolsRunsWithoutThem) {
  const std::string line =
      "python3 '" SOFTGRAIN_SOURCE_DIR "/pipelines/grainlearning_example/calibrate.py' --softgrain '" +
      std::string(SOFTGRAIN_PROGRAM) + "' --samples 3 --out '" + file("example") + "' > '" + file("log") + "' 2>&1";
  const int status = std::system(line.c_str());
  EXPECT_TRUE(ended_with(status, 0)) << read_text(file("log"));
  EXPECT_NE(read_text(file("log")).find("truth 0.3"), std::string::npos);
  EXPECT_TRUE(fs::exists(file("example") + "/sim_data/iter0/softgrain_Iter0_Sample2_param.txt"));
}

}  // namespace
