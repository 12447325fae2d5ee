// Several runs at once: over seeds, over keys, compared; what is refused, what is resumed, and what the set says of a
// run that failed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "common/io/file_safety.h"
#include "common/io/text_file.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_macro.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;
using nlohmann::json;

class RunSet : public ::testing::Test {
 protected:
  RunSet() {
    save_card(synthetic::card(), file("law.toml"));
    write_text_atomic(file("macro.toml"), kMacroOfAMoment);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  [[nodiscard]] std::string quoted(const std::string& name) const { return "'" + file(name) + "' "; }
  [[nodiscard]] ProgramOutcome program(const std::string& command, const std::string& more) const {
    return run_the_program(command + " " + quoted("macro.toml") + "--quiet --threads 1 " + more);
  }
  static void expect(const ProgramOutcome& outcome, int status, const std::vector<std::string>& words = {}) {
    EXPECT_EQ(outcome.status, status) << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in " << outcome.output;
  }
  /// A number of a run, or of a point, by its name.
  static json number(const json& of, const std::string& name) {
    for (const json& one : of["numbers"])
      if (one["name"] == name) return one;
    ADD_FAILURE() << "no " << name << " in " << of.dump(1);
    return json::object();
  }

  TemporaryDirectory directory_;
};

constexpr const char* kStress = "axial stress at the end";

TEST_F(RunSet, SeedsGiveMeanSpreadAndStandardErrorOfTheRunsThemselves) {
  expect(program("macrosim", "--seeds 1..3 --out " + quoted("out")), 0, {"spread", "standard error", kStress});
  const json summary = summary_of(file("out"));
  ASSERT_EQ(summary["runs"].size(), 3U);
  std::vector<double> stress;
  for (const char* seed : {"1", "2", "3"}) {
    // Each is the run that the seed gives alone.
    expect(program("macrosim", std::string("--seed ") + seed + " --out " + quoted("alone")), 0);
    const json alone = summary_of(file("alone"));
    const json member = summary_of(file("out") + "/seed=" + seed);
    EXPECT_EQ(member["macro"]["contact_evaluations"], alone["macro"]["contact_evaluations"]);
    EXPECT_EQ(member["provenance"]["seed"], alone["provenance"]["seed"]);
    stress.push_back(number(summary["runs"][stress.size()], kStress)["value"]);
  }
  EXPECT_NE(stress[0], stress[1]);
  const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
  double squares = 0.0;
  for (const double s : stress) squares += (s - mean) * (s - mean);
  const json point = number(summary["points"][0], kStress);
  EXPECT_NEAR(point["mean"], mean, 1e-9 * mean);
  EXPECT_NEAR(point["spread"], std::sqrt(squares / 2.0), 1e-9 * mean);
  EXPECT_NEAR(point["standard_error"], std::sqrt(squares / 6.0), 1e-9 * mean);
  const std::string report = read_text(file("out") + "/report.html");
  for (const char* words : {"Runs side by side", "Over seeds", "mean, and one standard deviation between seeds",
                            "href=\"seed=2/report.html\""})
    EXPECT_NE(report.find(words), std::string::npos) << words;
}

TEST_F(RunSet, ASweepHasADirectoryTableAndReportForEveryChoice) {
  expect(program("sweep", "--over macro.bodies=6,9 --over macro.wall_mu=0,0.4 --out " + quoted("out")), 0,
         {"varied: macro.bodies = 6, 9", "bodies=9_wall_mu=0.4"});
  const json summary = summary_of(file("out"));
  EXPECT_EQ(summary["status"], "good");
  ASSERT_EQ(summary["runs"].size(), 4U);
  for (const json& run : summary["runs"]) {
    const std::string directory = file("out") + "/" + run["directory"].get<std::string>();
    for (const char* name : {"summary.json", "report.html", "macro.h5", "log.txt"})
      EXPECT_TRUE(fs::exists(directory + "/" + name)) << directory << " " << name;
    EXPECT_EQ(std::to_string(summary_of(directory)["macro"]["bodies"].get<int>()),
              run["values"]["macro.bodies"].get<std::string>());
  }
  const std::string table = read_text(file("out") + "/table.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5);
  EXPECT_EQ(table.find("run,macro.bodies,macro.wall_mu,seed,status,axial stress at the end [Pa],"), 0U) << table;
  const std::string report = read_text(file("out") + "/report.html");
  EXPECT_NE(report.find("data-x-label=\"macro.bodies\""), std::string::npos) << "no plot over the key";
}

/// Ranges of keys: names are numbers, values stand in the table, and a larger design takes what is there.
TEST_F(RunSet, ADesignRunsPointsOfRangesAndSaysWhatMatters) {
  const std::string over = "--over macro.wall_mu=0.0..0.4 --over macro.bodies=6..9 --out " + quoted("out");
  expect(program("sweep", over + "--sample sobol:4"), 0,
         {"varied: macro.wall_mu = 0.0 to 0.4", "sensitivity: not determined: 4 points, at least 8 are needed"});
  const auto first = fs::last_write_time(file("out") + "/sample_003/macro.h5");
  expect(program("sweep", over + "--sample sobol:12 --resume"), 0, {"sensitivity, with 95 % intervals", "sample_012"});
  EXPECT_EQ(fs::last_write_time(file("out") + "/sample_003/macro.h5"), first);
  const json summary = summary_of(file("out"));
  ASSERT_EQ(summary["runs"].size(), 12U);
  EXPECT_EQ(summary["design"]["sample"], "sobol:12");
  EXPECT_EQ(summary["design"]["seed"], 1);
  for (const json& run : summary["runs"]) {
    const json member = summary_of(file("out") + "/" + run["name"].get<std::string>());
    EXPECT_EQ(std::to_string(member["macro"]["bodies"].get<int>()), run["values"]["macro.bodies"].get<std::string>());
    EXPECT_EQ(member["provenance"]["seed"], 1);
  }
  EXPECT_EQ(summary["sensitivity"][0]["key"], "macro.wall_mu");
  EXPECT_TRUE(summary["sensitivity"][0]["rank_correlation"]["value"].is_number());
  EXPECT_EQ(read_text(file("out") + "/table.csv").find("run,macro.wall_mu,macro.bodies,seed,status,"), 0U);
  EXPECT_NE(read_text(file("out") + "/report.html").find("<h3>Sensitivity</h3>"), std::string::npos);
  // The seed of the program is that of the design and of the scenes.
  expect(program("sweep", over + "--sample sobol:4 --seed 5 --resume"), 2, {"sample_001", "another"});
}

TEST_F(RunSet, RangesAreRefusedWithoutADesign) {
  const std::string out = "--out " + quoted("out");
  expect(program("sweep", "--over macro.wall_mu=0.0..0.4 " + out), 2, {"a range goes with --sample"});
  expect(program("sweep", "--over macro.bodies=6.5..9 --sample lhs:4 " + out), 2, {"the key takes whole numbers"});
  expect(program("sweep", "--over macro.wall_mu=0.0..0.4 --sample grid:4 " + out), 2, {"must be lhs:N, sobol:N"});
  expect(program("sweep", "--over macro.wall_nu=0.0..0.4 --sample lhs:4 " + out), 2,
         {"unknown key 'wall_nu' in [macro]; nearest known key is 'wall_mu'"});
  EXPECT_FALSE(fs::exists(file("out")));
}

TEST_F(RunSet, EverythingThatIsWrongIsSaidBeforeAnyRun) {
  const std::string out = "--out " + quoted("out");
  const ProgramOutcome outcome =
      program("sweep", "--over macro.bodies=6,-1,0 --over macro.stepps=2 --over macro.strain=0.1,0.9 " + out);
  expect(outcome, 2,
         {"--set macro.bodies): bodies = -1: must be a whole number from 1 to", "bodies = 0: must be",
          "unknown key 'stepps' in [macro]; nearest known key is 'steps'", "strain = 0.9: must be",
          "(in the run bodies=-1_stepps=2_strain=0.1 and 1 more)"});
  EXPECT_EQ(outcome.output.find("(in the run", outcome.output.find("stepps' in")),
            outcome.output.find("(in the run", outcome.output.find("strain = 0.9")))
      << "what is wrong with all is said once, and of none in particular";
  std::string values = "-1";
  for (int k = 2; k <= 25; ++k) values += "," + std::to_string(-k);
  const ProgramOutcome many = program("sweep", "--over macro.bodies=" + values + " " + out);
  expect(many, 2, {"bodies = -20: must be", "5 more errors"});
  EXPECT_EQ(many.output.find("bodies = -21"), std::string::npos) << "of hundreds of errors the first are enough";
  EXPECT_FALSE(fs::exists(file("out")));
  expect(program("sweep", "--over law=law.toml,nowhere.toml " + out), 4, {"nowhere.toml: no such file"});
  EXPECT_FALSE(fs::exists(file("out") + "/law=law.toml"));
  expect(program("sweep", out), 2, {"nothing is swept"});
  expect(program("macrosim", "--seeds 3..1 " + out), 2, {"--seeds 3..1", "must rise"});
  expect(program("macrosim", "--seeds 1..2 --seed 4 " + out), 2, {"--seeds: goes without --seed"});
  expect(program("sweep", "--over macro.bodies=6,7 --ranks 2 " + out), 2, {"--ranks"});
}

TEST_F(RunSet, CachesThatAKindHasNothingForAreRefused) {
  const std::vector<std::pair<std::string, std::string>> idle{{"material.toml", "--twin-cache"},
                                                              {"law_table.toml", "--packing-cache"},
                                                              {"inverse.toml", "--law-cache"},
                                                              {"inverse.toml", "--packing-cache"}};
  for (const auto& [scene, option] : idle) {
    const auto outcome = run_the_program("run '" SOFTGRAIN_SOURCE_DIR "/pipelines/" + scene + "' " + option + " '" +
                                         file("kept") + "' --out " + quoted("out"));
    EXPECT_EQ(outcome.status, 2) << scene;
    EXPECT_NE(outcome.output.find(option + ": not for scenes of kind"), std::string::npos) << outcome.output;
    EXPECT_FALSE(fs::exists(file("out")));
  }
}

TEST_F(RunSet, FinishedRunsAreNotRepeatedAndMoreCanBeAdded) {
  const std::string out = "--out " + quoted("out");
  expect(program("sweep", "--over macro.bodies=6,7 " + out), 0);
  const auto first = fs::last_write_time(file("out") + "/bodies=6/macro.h5");
  fs::remove_all(file("out") + "/bodies=7");
  expect(program("sweep", "--over macro.bodies=6,7,8 --resume " + out), 0, {"bodies=8"});
  EXPECT_EQ(fs::last_write_time(file("out") + "/bodies=6/macro.h5"), first);
  EXPECT_TRUE(fs::exists(file("out") + "/bodies=7/macro.h5"));
  EXPECT_EQ(summary_of(file("out"))["runs"].size(), 3U);
  // While runs are added nothing looks as if all were there.
  fs::create_directories(file("out") + "/bodies=9");
  {
    const DirectoryLock somebody(file("out") + "/bodies=9");
    expect(program("sweep", "--over macro.bodies=6,9 --resume " + out), 4, {"bodies=9"});
    EXPECT_FALSE(fs::exists(file("out") + "/summary.json"));
    EXPECT_TRUE(fs::exists(file("out") + "/bodies=6/summary.json"));
  }
  // Not with another scene, engine or number of bands, nor with another law.
  expect(program("sweep", "--over macro.bodies=6,8 --engine lammps --resume " + out), 2, {"its engine is"});
  expect(program("sweep", "--over macro.bodies=6,8 --bands 8 --resume " + out), 2, {"--bands is 0 there and 8 now"});
  expect(program("sweep", "--over macro.bodies=6,7 --set macro.steps=3 --resume " + out), 2, {"another scene"});
  LawCard stiffer = synthetic::card();
  stiffer.pairs[0].normal.a.value *= 2.0;
  stiffer.pairs[0].normal.c.value *= 2.0;
  save_card(stiffer, file("law.toml"));
  expect(program("sweep", "--over macro.bodies=6,7 --resume " + out), 2, {"its law or data file is another"});
  // Anew: runs of the earlier sweep go, files of others stay.
  write_text_atomic(file("out") + "/bodies=7/notes.txt", "mine");
  expect(program("sweep", "--over macro.bodies=6 " + out), 0);
  EXPECT_NE(fs::last_write_time(file("out") + "/bodies=6/macro.h5"), first);
  EXPECT_FALSE(fs::exists(file("out") + "/bodies=8"));
  EXPECT_FALSE(fs::exists(file("out") + "/bodies=7/macro.h5"));
  EXPECT_EQ(read_text(file("out") + "/bodies=7/notes.txt"), "mine");
}

/// A file that a scene takes particles from may change while its text stays.
TEST_F(RunSet, FinishedRunsOfAnotherParticleFileAreRefused) {
  write_text_atomic(file("two.toml"), R"(kind = "particles"
[material.glass]
density = 2500.0
[[contact]]
pair = ["glass", "glass"]
law = "linear-spring"
normal_stiffness = 1000.0
restitution = 0.9
mu = 0.0
[particles]
file = "two.xyzr"
material = "glass"
[cell]
size = "file"
periodic = [true, true, true]
[time]
steps = 10
)");
  write_text_atomic(file("two.xyzr"), "2 1 1 1\n0 0 0 0.001\n0 0 0.0019 0.001\n");
  const std::string command = "sweep " + quoted("two.toml") + "--quiet --threads 1 --out " + quoted("out") +
                              "--resume --over contact.0.restitution=0.9,0.8";
  expect(run_the_program(command), 0);
  expect(run_the_program(command + ",0.7"), 0);
  for (const char* changed : {"2 1 1 1\n0 0 0 0.001\n0 0 0.0015 0.001\n", "2 1 1 2\n0 0 0 0.001\n0 0 0.0019 0.001\n"}) {
    write_text_atomic(file("two.xyzr"), changed);
    expect(run_the_program(command), 2, {"its law or data file is another"});
  }
}

/// Stopped in the midst and gone on with: the same numbers as without a stop.
TEST_F(RunSet, AnInterruptedSweepGoesOnWhereItWas) {
  const std::vector<std::string> words{"sweep", file("macro.toml"), "--over",  "macro.bodies=40,50",
                                       "--set", "macro.steps=20",   "--quiet", "--threads",
                                       "1"};
  const auto arguments = [&](const std::string& out, bool resume) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--out", file(out)});
    if (resume) all.emplace_back("--resume");
    return all;
  };
  ASSERT_TRUE(ended_with(wait_for(start_program(arguments("whole", false))), 0));
  int stops = 0;
  for (int part = 0; part < 200; ++part) {
    const int ended = signal_after(start_program(arguments("parts", part > 0)), 0.15 + 0.05 * part, SIGTERM);
    if (ended_with(ended, 0)) break;
    ASSERT_TRUE(ended_with(ended, 130) || WIFSIGNALED(ended)) << ended;
    EXPECT_FALSE(fs::exists(file("parts") + "/summary.json")) << "it looks as if it had ended";
    ++stops;
  }
  EXPECT_GT(stops, 0);
  const json whole = summary_of(file("whole"));
  const json parts = summary_of(file("parts"));
  ASSERT_EQ(parts["runs"].size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(parts["runs"][k]["numbers"], whole["runs"][k]["numbers"]);
}

/// Numbers of the runs of a set.
std::vector<json> numbers_of_runs(const std::string& directory) {
  std::vector<json> out;
  for (const json& run : summary_of(directory)["runs"])
    out.push_back({run["name"], run["status"], run.value("reason", ""), run["numbers"]});
  return out;
}

/// One of the four does not converge: the same numbers, status and reason as one after another.
TEST_F(RunSet, SeveralAtOnceGiveTheSameAsOneAfterAnother) {
  const std::string over = "--over macro.max_passes=10,20000 --seeds 1..2 ";
  expect(program("sweep", over + "--out " + quoted("one")), 3);
  const ProgramOutcome outcome =
      run_the_program("sweep " + quoted("macro.toml") + over + "--threads 3 --jobs 3 --out " + quoted("several"));
  expect(outcome, 3,
         {"4 runs, 3 at once with 1 thread each", "4 of 4 runs have ended", " left",
          "run max_passes=10_seed=1 is not usable"});
  EXPECT_EQ(numbers_of_runs(file("several")), numbers_of_runs(file("one")));
  EXPECT_EQ(summary_of(file("several"))["points"], summary_of(file("one"))["points"]);
  EXPECT_EQ(read_text(file("several") + "/table.csv"), read_text(file("one") + "/table.csv"));
  EXPECT_FALSE(fs::exists(file("several") + "/.members"));
  // Runs that have ended are not repeated.
  const auto first = fs::last_write_time(file("several") + "/max_passes=20000_seed=2/macro.h5");
  expect(program("sweep", over + "--jobs 2 --resume --out " + quoted("several")), 3);
  EXPECT_EQ(fs::last_write_time(file("several") + "/max_passes=20000_seed=2/macro.h5"), first);
  EXPECT_EQ(numbers_of_runs(file("several")), numbers_of_runs(file("one")));
  expect(program("sweep", over + "--jobs 2 --resume --set macro.steps=3 --out " + quoted("several")), 2,
         {"belongs to another scene"});
  expect(program("sweep", over + "--jobs 2 --slurm --out " + quoted("several")), 2, {"--jobs: ", "--slurm"});
  expect(program("sweep", over + "--jobs 0"), 2, {"--jobs 0: must be a whole number, from 1"});
}

/// A signal stops all that run at once, and the set goes on where they were.
TEST_F(RunSet, AnInterruptedSweepOfSeveralAtOnceGoesOn) {
  const auto arguments = [&](const std::string& out, bool resume) {
    std::vector<std::string> all{"sweep",   file("macro.toml"),
                                 "--over",  "macro.bodies=40,50",
                                 "--set",   "macro.steps=20",
                                 "--quiet", "--threads",
                                 "2",       "--out",
                                 file(out)};
    if (out != "whole") all.insert(all.end(), {"--jobs", "2"});
    if (resume) all.emplace_back("--resume");
    return all;
  };
  ASSERT_TRUE(ended_with(wait_for(start_program(arguments("whole", false))), 0));
  const auto both_began = [&] {
    return fs::exists(file("parts") + "/bodies=40/.run") && fs::exists(file("parts") + "/bodies=50/.run");
  };
  const int ended = signal_when(start_program(arguments("parts", false)), both_began, SIGTERM);
  EXPECT_TRUE(ended_with(ended, 130)) << ended;
  EXPECT_FALSE(fs::exists(file("parts") + "/summary.json"));
  for (const char* run : {"bodies=40", "bodies=50"})
    EXPECT_NO_THROW(DirectoryLock(file("parts") + "/" + run)) << "its process is still at work";
  ASSERT_TRUE(ended_with(wait_for(start_program(arguments("parts", true))), 0));
  EXPECT_EQ(numbers_of_runs(file("parts")), numbers_of_runs(file("whole")));
}

/// One process is killed: its run is marked, the other one stands, and the set goes on.
TEST_F(RunSet, AMemberThatCrashesLeavesTheOthers) {
  const auto start = [&](bool resume) {
    std::vector<std::string> all{"sweep",    file("macro.toml"), "--over",  "macro.bodies=6,60",
                                 "--set",    "macro.steps=20",   "--quiet", "--threads",
                                 "2",        "--jobs",           "2",       "--out",
                                 file("out")};
    if (resume) all.emplace_back("--resume");
    return start_program(all);
  };
  const pid_t set = start(false);
  const std::string lock = file("out") + "/bodies=60/.lock";
  const auto end = std::chrono::steady_clock::now() + kLongestWait;
  pid_t member = 0;
  while (member <= 0 && std::chrono::steady_clock::now() < end) {
    if (fs::exists(file("out") + "/bodies=60/.run")) member = std::atoi(read_text(lock).c_str());
    ::usleep(1000);
  }
  ASSERT_GT(member, 0);
  ::kill(member, SIGKILL);
  EXPECT_TRUE(ended_with(wait_for(set), 3));
  const json summary = summary_of(file("out"));
  EXPECT_EQ(summary["runs"][0]["status"], "good");
  EXPECT_EQ(summary["runs"][1]["status"], "not usable");
  EXPECT_EQ(summary["runs"][1]["reason"], "its process was ended by signal 9");
  EXPECT_TRUE(ended_with(wait_for(start(true)), 0));
  EXPECT_EQ(summary_of(file("out"))["status"], "good");
}

/// What a job array starts, without a cluster: every command of the file, then the set collects.
TEST_F(RunSet, AJobArrayIsWrittenRunAndCollected) {
  const std::string sweep = "--over macro.bodies=6..9 --sample lhs:2 --seed 3 --set macro.steps=1 ";
  expect(program("sweep", sweep + "--out " + quoted("one")), 0);
  expect(program("sweep", sweep + "--slurm --out " + quoted("array")), 0,
         {"2 commands, one per run", "nothing was submitted", "submit: sbatch", "collect"});
  const std::string script = read_text(file("array") + "/slurm/job.sh");
  for (const char* words : {"#SBATCH --array=1-2", "#SBATCH --cpus-per-task=1", "SLURM_ARRAY_TASK_ID", " --resume"})
    EXPECT_NE(script.find(words), std::string::npos) << words;
  EXPECT_FALSE(fs::exists(file("array") + "/sample_001"));
  for (const char* task : {"1", "2"}) {
    const std::string line =
        "SLURM_ARRAY_TASK_ID=" + std::string(task) + " bash " + quoted("array/slurm/job.sh") + " >/dev/null 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0) << line;
  }
  EXPECT_TRUE(fs::exists(file("array") + "/sample_002/macro.h5"));
  {
    const DirectoryLock at_work(file("array") + "/sample_001");
    expect(program("sweep", sweep + "--slurm --out " + quoted("array")), 4, {"sample_001"});
    EXPECT_TRUE(fs::exists(file("array") + "/sample_002/macro.h5")) << "nothing is removed beside a task at work";
  }
  const auto first = fs::last_write_time(file("array") + "/sample_002/macro.h5");
  expect(program("sweep", sweep + "--resume --out " + quoted("array")), 0);
  EXPECT_EQ(fs::last_write_time(file("array") + "/sample_002/macro.h5"), first);
  EXPECT_EQ(numbers_of_runs(file("array")), numbers_of_runs(file("one")));
  expect(program("sweep", sweep + "--only sample_03 --out " + quoted("array")), 2,
         {"--only sample_03: the set has no such run"});
}

/// Too few passes for one of them: status 3, the others stand, and means leave it out.
TEST_F(RunSet, ARunThatDoesNotConvergeIsToldByStatusAndSummary) {
  const std::string out = "--out " + quoted("out");
  expect(program("sweep", "--over macro.max_passes=10,20000 " + out), 3, {"run max_passes=10 is not usable"});
  const json summary = summary_of(file("out"));
  EXPECT_EQ(summary["status"], "not usable");
  EXPECT_EQ(summary["runs"][0]["status"], "not usable");
  EXPECT_EQ(summary["runs"][1]["status"], "good");
  EXPECT_TRUE(summary["points"][0]["numbers"].empty());
  EXPECT_FALSE(summary["points"][1]["numbers"].empty());
  EXPECT_NE(read_text(file("out") + "/report.html").find("Do not use this result as it is"), std::string::npos);
}

TEST_F(RunSet, ASearchAddsRoundsAndRepeatsNoRunWhenItGoesOn) {
  const std::string asked = "--over macro.wall_mu=0.0..0.4 --maximise 'axial stress' --out " + quoted("found");
  expect(program("sweep", asked + "--points 6"), 0, {"largest axial stress at the end [Pa] at macro.wall_mu ="});
  const json first = summary_of(file("found"));
  EXPECT_EQ(first["runs"].size(), 6U);
  EXPECT_EQ(first["search"]["points"], 6);
  EXPECT_TRUE(first["search"]["usable"].get<bool>());
  EXPECT_TRUE(fs::exists(file("found") + "/search.csv"));
  EXPECT_NE(read_text(file("found") + "/report.html").find("Optimum"), std::string::npos);
  // Figures over the key go along it, in whatever order rounds came.
  std::istringstream curve(read_text(file("found") + "/curves/lateral-over-axial-stress-at-the-end.csv"));
  std::string line;
  std::getline(curve, line);
  const std::size_t key = line.find("macro.wall_mu");
  ASSERT_NE(key, std::string::npos) << line;
  const auto column = std::count(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(key), ',');
  std::vector<double> along;
  while (std::getline(curve, line)) {
    std::istringstream fields(line);
    std::string field;
    for (std::ptrdiff_t k = 0; k <= column; ++k) std::getline(fields, field, ',');
    along.push_back(std::stod(field));
  }
  EXPECT_EQ(along.size(), 6U);
  EXPECT_TRUE(std::is_sorted(along.begin(), along.end()));
  const fs::file_time_type before = fs::last_write_time(file("found") + "/wall_mu=0/summary.json");
  expect(program("sweep", asked + "--points 7 --resume"), 0);
  const json second = summary_of(file("found"));
  ASSERT_EQ(second["runs"].size(), 7U);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(second["runs"][k]["numbers"], first["runs"][k]["numbers"]) << k;
  EXPECT_EQ(fs::last_write_time(file("found") + "/wall_mu=0/summary.json"), before);
  expect(program("sweep", asked + "--jobs 2"), 2, {"--maximise: goes without --jobs"});
  expect(program("sweep", "--over macro.wall_mu=0.0..0.4 --maximise ''"), 2,
         {"--maximise: needs the name of a result"});
}

TEST_F(RunSet, ComparisonsSayFirstWhatDiffersAndMakeNoDirectoryUnasked) {
  for (const char* bodies : {"6", "7", "8"})
    expect(program("macrosim", std::string("--set macro.bodies=") + bodies + " --out " + quoted(bodies)), 0);
  const fs::path here = fs::current_path();
  fs::current_path(directory_.path());
  const ProgramOutcome two = run_the_program("compare 6 7 --different");
  expect(two, 0, {"differs: macro.bodies: A 6, B 7", "axial stress, relative L2 difference"});
  EXPECT_EQ(two.output.find("differs: macro.bodies"), 0U) << two.output;
  expect(run_the_program("compare 6 7"), 2, {"--different"});
  const ProgramOutcome three = run_the_program("compare 6 7 8");
  expect(three, 0, {"differs: macro.bodies: A 6, B 7, C 8", kStress, "A  no norm:", "bodies: 6 against 8"});
  EXPECT_FALSE(fs::exists("results"));
  const json summary = json::parse(run_the_program("compare 6 7 8 --different --json", "/dev/null").output);
  EXPECT_EQ(summary["scene_differences"][0]["key"], "macro.bodies");
  EXPECT_EQ(summary["norms"].size(), 2U);
  EXPECT_GT(summary["norms"][0]["percent"].get<double>(), 0.0);
  expect(run_the_program("compare 6 7 8 --out table --quiet"), 0);
  const std::string report = read_text("table/report.html");
  for (const char* words : {"differs in", "macro.bodies", "Axial stress", "href=\"../7/report.html\""})
    EXPECT_NE(report.find(words), std::string::npos) << words;
  fs::current_path(here);
}

/// Kinds without curves have numbers to be set side by side by.
TEST_F(RunSet, RunsWithoutCurvesAreComparedByTheirNumbers) {
  constexpr const char* kGrain =
      "kind = \"particles\"\n[material.a]\ndensity = 1.0\nE = 1.0\nnu = 0.2\n[[particle]]\nmaterial = \"a\"\n"
      "radius = 1.0\nposition = [0.0, 0.0, 0.0]\nvelocity = [1.0, 0.0, 0.0]\n[time]\nstep = 0.1\nend = 0.2\n";
  write_text_atomic(file("grain.toml"), kGrain);
  expect(run_the_program("sweep " + quoted("grain.toml") +
                         "--over 'particle.0.velocity=[1.0, 0.0, 0.0],[2.0, 0.0, 0.0]' --quiet --out " + quoted("out")),
         0, {"kinetic energy at the end"});
  const json summary = summary_of(file("out"));
  EXPECT_NEAR(number(summary["runs"][1], "kinetic energy at the end")["value"].get<double>() /
                  number(summary["runs"][0], "kinetic energy at the end")["value"].get<double>(),
              4.0, 1e-12);
  const std::string a = file("out") + "/" + summary["runs"][0]["directory"].get<std::string>();
  const std::string b = file("out") + "/" + summary["runs"][1]["directory"].get<std::string>();
  expect(run_the_program("compare '" + a + "' '" + b + "'"), 0,
         {"differs: particle.0.velocity: A [1, 0, 0], B [2, 0, 0]", "kinetic energy at the end"});
  expect(run_the_program("microsim " + quoted("grain.toml") + "--seeds 1..2 --out " + quoted("seeds")), 2,
         {"nothing is drawn at random"});
}

}  // namespace
