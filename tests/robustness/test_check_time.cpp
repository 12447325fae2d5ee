// How long a run takes by softgrain check, beside how long it takes, and how long the check itself does.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>

#include "pipelines/run/findings.h"
#include "tests/support/check_facts.h"

namespace softgrain {
namespace {

using nlohmann::json;
using test::Check;
using test::run_the_program;
namespace fs = std::filesystem;

/// Processor time of the programs that were run and have ended [s].
double time_of_children() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// tests/bench/check_times.py does this for the shipped scenes; here one of each way of telling, in small.
TEST_F(Check, TheTimeIsThatOfTheRun) {
  const std::string measured =
      "kind = \"soft-particle\"\n[packing]\ncount = 10\nplacement = \"voids\"\n[measure]\nrelaxation = \"damped\"\n"
      "[measure.soft_solid]\ndeltas = [0.1, 0.15, 0.2, 0.25, 0.3]\n";
  const std::string assembled =
      "kind = \"cohesive-powder\"\nsamples = 1\n[disks]\ncount = 300\n[contact]\nkappa = 1e3\n[assembly]\npressure = "
      "0.01\n";
  const std::string packed =
      "kind = \"grain-box\"\n[box]\ngrains = 200\n[generation]\npressure = \"10 MPa\"\n[loading]\nend_stress = "
      "\"40 MPa\"\n";
  for (const std::string& scene : {measured, assembled, packed}) {
    const json expected = scene_facts(scene);
    double parts = 0.0;
    for (const auto& part : expected["core_seconds_parts"]) parts += part.get<double>();
    EXPECT_DOUBLE_EQ(expected["core_seconds"].get<double>(), parts);
    const double before = time_of_children();
    const test::ProgramOutcome outcome = run_the_program("microsim '" + directory_.file("scene.toml") +
                                                         "' --threads 1 --out '" + directory_.file("run") + "'");
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const double ratio = expected["core_seconds"].get<double>() / (time_of_children() - before);
    EXPECT_GT(ratio, 1.0 / 3.0) << scene;
    EXPECT_LT(ratio, 3.0) << scene;
    fs::remove_all(directory_.file("run"));
  }
}

/// A packing of span 30 does not jam within a moment. Its time was taken from how far it came, and that of its tests
/// from the same: 80 s in place of an hour. A run of 80,000 grains took 100 to 200 times as long to prepare as one of
/// 8,000 at span 12, and 24 to 47 times as long to test.
TEST_F(Check, WideSpansTakeTheTimeOfTheirGrains) {
  const auto parts = [&](const char* grains) {
    return scene_facts(std::string("kind = \"material\"\nsamples = 1\n[grains]\n") + grains +
                       "radius_max = \"16 mm\"\n[packing]\npreparation = \"fast\"\nstart_pressure = 1e-4\n[test]\n"
                       "strain = 0.08\nsteps = 16\nincrements_per_step = 4\ntolerance = 1e-2\n")["core_seconds_parts"];
  };
  const json narrow = parts("count = 8000\nratio = 12\n");
  const json wide = parts("count = 80000\nratio = 30\n");
  const auto ratio = [&](const char* part) { return wide[part].get<double>() / narrow[part].get<double>(); };
  EXPECT_GT(ratio("preparation"), 35.0);
  EXPECT_LT(ratio("preparation"), 400.0);
  EXPECT_GT(ratio("tests"), 12.0);
  EXPECT_LT(ratio("tests"), 150.0);
}

/// The trial sees the isotropic preload alone, whose increments take half the time: a third of the time was told.
TEST_F(Check, IncrementsThatShearTakeLonger) {
  const auto tests = [&](const std::string& kind) {
    return scene_facts(
               "kind = \"material\"\nsamples = 1\n[grains]\ncount = 8000\nratio = 12\n[packing]\npreparation = "
               "\"fast\"\n"
               "balance = \"own-load\"\npreparation_tolerance = 0.1\n[test]\nincrements_per_step = 4\n[[stage]]\nkind "
               "= "
               "\"isotropic\"\nstrain = 0.02\nsteps = 4\n[[stage]]\nkind = \"" +
               kind + "\"\nstrain = 0.1\nsteps = 16\n")["core_seconds_parts"]["tests"]
        .get<double>();
  };
  EXPECT_GT(tests("triaxial"), 1.2 * tests("isotropic"));  // 1.0 where all increments count alike, up to 1.9
}

TEST_F(Check, AMaterialSaysItsTimeAndNothingOfSoftParticles) {
  const std::string scene =
      "kind = \"material\"\nsamples = 2\n[grains]\ncount = 700\nratio = 4\n[packing]\npreparation = "
      "\"fast\"\n[test]\nstrain = 0.04\nsteps = 4\n";
  const json expected = scene_facts(scene);
  const std::string said = run_the_program("check '" + directory_.file("scene.toml") + "'").output;
  EXPECT_EQ(said.find("of them soft"), std::string::npos) << said;
  EXPECT_NE(said.find("time: about"), std::string::npos) << said;
  const double before = time_of_children();
  const test::ProgramOutcome outcome =
      run_the_program("run '" + directory_.file("scene.toml") + "' --threads 1 --out '" + directory_.file("run") + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const double ratio = expected["core_seconds"].get<double>() / (time_of_children() - before);
  EXPECT_GT(ratio, 1.0 / 3.0);
  EXPECT_LT(ratio, 3.0);
}

/// It was 38 digits of days.
TEST_F(Check, ATimeBeyondReasonIsNotCountedInDays) { EXPECT_EQ(time_text(1e43), "millions of years"); }

TEST_F(Check, TakesAMoment) {
  const double before = time_of_children();
  for (const char* name : {"powder_method1", "glass_beads_small"})
    (void)facts(std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/" + name + ".toml");
  EXPECT_LT(time_of_children() - before, 30.0) << "processor time; the runs take minutes to hours";
}

}  // namespace
}  // namespace softgrain
