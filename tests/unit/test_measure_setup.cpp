// Which relaxation a scene asks for, and under what name its results go.
#include <gtest/gtest.h>

#include <string>

#include "common/core/error.h"
#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/run/findings.h"

namespace softgrain {
namespace {

MeasureSetup read(const std::string& measure, const std::string& reference = "") {
  const std::string text = "[packing]\ncount = 1\ntrials = 100\npolydispersity = 4.0\n[measure]\n" + measure +
                           "\n[measure.soft_solid]\ndeltas = [0.1]\n" + reference;
  const Scene scene = Scene::parse(text, "scene.toml");
  MeasureSetup setup = read_measure_setup(scene.root());
  scene.root().finish();
  return setup;
}

const std::string kNone = "[measure.least_work]\nincrement_passes = 0\n";

TEST(MeasureSetup, LeastWorkWithoutIncrementsOfLeastWorkIsCalledSlowDynamics) {
  EXPECT_EQ(read("").series[0].relaxation, Relaxation::least_work);
  EXPECT_EQ(read("relaxation = \"least-work\"\n" + kNone).series[0].relaxation, Relaxation::slow_dynamics);
  EXPECT_EQ(read(kNone).series[0].relaxation, Relaxation::slow_dynamics);
  EXPECT_EQ(read("relaxation = \"slow-dynamics\"").series[0].relaxation, Relaxation::slow_dynamics);
  EXPECT_THROW((void)read("relaxation = \"damped\"\n" + kNone), InputError) << "it has no increments by least work";
  const MeasureSetup beside =
      read("relaxation = \"slow-dynamics\"",
           "[reference]\nrelaxation = \"least-work\"\n[reference.soft_solid]\ndeltas = [0.1]\n");
  EXPECT_EQ(beside.series[1].relaxation, Relaxation::least_work);
}

TEST(MeasureSetup, SlowDynamicsAndIncrementsOfLeastWorkExcludeEachOther) {
  const auto refused = [](const std::string& measure, const std::string& reference, const std::string& word) {
    try {
      (void)read(measure, reference);
      ADD_FAILURE() << measure;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  };
  refused("relaxation = \"slow-dynamics\"\n[measure.least_work]\nincrement_passes = 80\n", "", "increment_passes");
  refused(kNone, "[reference]\nrelaxation = \"slow-dynamics\"\n[reference.soft_solid]\ndeltas = [0.1]\n",
          "must differ");
}

/// The scenes that say in their comments that they go by slow dynamics.
TEST(MeasureSetup, TheScenesOfSlowDynamicsRecordItAsThat) {
  for (const char* name : {"quickstart", "published", "calibration"}) {
    const Scene scene = Scene::load(std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/" + name + ".toml");
    EXPECT_EQ(read_measure_setup(scene.root()).series[0].relaxation, Relaxation::slow_dynamics) << name;
  }
}

/// The same scene by its other name costs the same; a run records what it goes by.
TEST(MeasureSetup, SlowDynamicsIsTheSameByEitherName) {
  const MeasureSetup named = read("relaxation = \"slow-dynamics\"");
  const MeasureSetup none = read("relaxation = \"least-work\"\n" + kNone);
  const auto seconds = [](const MeasureSetup& setup, Relaxation relaxation) {
    return measuring_seconds(setup, relaxation, setup.series[0].soft_solid, PairKind::soft_solid, 1e-4);
  };
  EXPECT_EQ(seconds(named, Relaxation::slow_dynamics), seconds(none, Relaxation::slow_dynamics));
  EXPECT_NE(seconds(named, Relaxation::slow_dynamics), seconds(named, Relaxation::least_work));
  EXPECT_EQ(settings_text(named, Relaxation::slow_dynamics), settings_text(none, Relaxation::slow_dynamics));
  EXPECT_NE(settings_text(named, Relaxation::slow_dynamics), settings_text(named, Relaxation::least_work));
  const MeasureSetup coarse = read("relaxation = \"slow-dynamics\"\n[measure.least_work]\nstep_factor = 15.0\n");
  EXPECT_NE(settings_text(named, Relaxation::slow_dynamics), settings_text(coarse, Relaxation::slow_dynamics));
}

TEST(MeasureSetup, CheckNamesWhatWillBeDone) {
  Findings found;
  check_measurements(read("relaxation = \"least-work\"\n" + kNone), found);
  EXPECT_TRUE(found.facts.contains("slow-dynamics soft-solid")) << found.facts.dump();
}

/// sqrt(E/rho) is 14.14 m/s.
TEST(MeasureSetup, EachPlaneThatComesFastIsNamed) {
  const auto warnings = [](const char* least_work, const char* published) {
    return speed_warnings(read(std::string("relaxation = \"slow-dynamics\"\n[measure.least_work]\napproach_speed = ") +
                                   least_work + "\n[measure.published]\napproach_speed = " + published,
                               "[reference]\nrelaxation = \"published\"\n[reference.soft_solid]\ndeltas = [0.1]\n"));
  };
  EXPECT_TRUE(speed_warnings(read("")).empty());
  EXPECT_TRUE(warnings("1.4", "1.4").empty());
  for (const bool published : {false, true}) {
    const auto said = published ? warnings("1.0", "2.83") : warnings("2.83", "1.0");
    ASSERT_EQ(said.size(), 1U);
    const std::string key = published ? "[measure.published]" : "[measure.least_work]";
    EXPECT_TRUE(said[0].starts_with(key + " approach_speed = 2.83 m/s is 0.2 of sqrt(E/rho)")) << said[0];
  }
  EXPECT_EQ(warnings("2.0", "2.0").size(), 2U);
}

/// Time is that of a core that does nothing else; where there is none, it says so.
TEST(Findings, TimeSaysWhatItAssumes) {
  EXPECT_EQ(busy_text(0.4, 1), "");
  EXPECT_EQ(busy_text(3.9, 8), "");
  EXPECT_EQ(busy_text(1.0, 1), "the machine is busy now, load 1.0 on 1 core");
  EXPECT_EQ(busy_text(7.5, 8), "the machine is busy now, load 7.5 on 8 cores");
  Findings out;
  out.spend("measuring", 8.0);
  out.close_times();
  EXPECT_NE(out.lines.find("time: about 8 s of one idle core (measuring 8 s)"), std::string::npos) << out.lines;
  EXPECT_EQ(out.lines.find("by the clock it takes longer") == std::string::npos,
            out.lines.find("the machine is busy now") == std::string::npos);
}

}  // namespace
}  // namespace softgrain
