// A packing whose grains are thrown out of their shell ends no run: steps that are too long are shortened, and what
// breaks off all the same is left out, counted and said.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/data/measurements.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;

constexpr const char* kBreaking = R"(kind = "soft-particle"
seed = 1
[material]
E = "0.5 MPa"
[packing]
shell_radius = "16 mm"
trials = 100
polydispersity = 5.0
rmax_over_shell = 0.5
beta = 8.0
count = 6
[measure]
relaxation = "least-work"
[measure.least_work]
increment_passes = 0
approach_speed = 0.1
settle_time = 10.0
path_settle_time = 10.0
step_factor = 20.0
[measure.soft_solid]
deltas = [0.3, 0.6, 0.9]
)";

class PackingsThatBreak : public ::testing::Test {
 protected:
  void SetUp() override { write_text_atomic(directory_.file("scene.toml"), kBreaking); }
  [[nodiscard]] ProgramOutcome run(const std::string& more) const {
    return run_the_program("microsim '" + directory_.file("scene.toml") + "' --quiet --out '" + directory_.file("out") +
                           "' " + more);
  }
  [[nodiscard]] json summary() const { return json::parse(read_text(directory_.file("out") + "/summary.json")); }

  TemporaryDirectory directory_;
};

/// Steps twenty times the published ones throw a grain out of one of these packings; shorter ones do not.
TEST_F(PackingsThatBreak, StepsThatAreTooLongAreShortened) {
  const ProgramOutcome outcome = run("");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_EQ(summary()["packings"]["broke_off"], 0);
  const Measurements data = load_measurements(directory_.file("out") + "/measurements.h5");
  ASSERT_EQ(data.runs.size(), 6U);
  for (const PackingRun& run : data.runs) EXPECT_EQ(run.normal.size(), 3U);
}

/// Pressed by waves of fifty metres a second, some packings burst with any step.
const std::string kBurst = "--set measure.least_work.approach_speed=50 --set measure.soft_solid.deltas=[0.5,0.9] ";

TEST_F(PackingsThatBreak, WhatBurstsIsLeftOutCountedAndSaid) {
  const ProgramOutcome outcome = run(kBurst);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(
      unwrapped(outcome.output).find("is left out: it broke off beyond Delta = 0.5 on the way to Delta = 0.9: grain "),
      std::string::npos)
      << outcome.output;
  const json told = summary();
  const auto lost = told["packings"]["broke_off"].get<std::size_t>();
  EXPECT_GE(lost, 1U);
  EXPECT_LE(lost, 3U);
  ASSERT_EQ(told["warnings"].size(), lost + 1);
  EXPECT_NE(told["warnings"][0].get<std::string>().find("3.5 of sqrt(E/rho): above 0.1 waves"), std::string::npos)
      << told["warnings"][0];
  for (std::size_t k = 1; k <= lost; ++k)
    for (const char* word : {"packing ", "squeezed out of its shell", "may keep it whole"})
      EXPECT_NE(told["warnings"][k].get<std::string>().find(word), std::string::npos) << told["warnings"][k];
  EXPECT_NE(read_text(directory_.file("out") + "/report.html").find("is left out: it broke off"), std::string::npos);
  const Measurements data = load_measurements(directory_.file("out") + "/measurements.h5");
  EXPECT_EQ(data.runs.size(), 6U - lost);
  EXPECT_EQ(told["measurement"]["points"], 2 * (6 - lost));
}

TEST_F(PackingsThatBreak, WithTooFewLeftTheResultIsNotUsable) {
  const ProgramOutcome outcome = run(kBurst + "--set packing.count=1");
  EXPECT_EQ(outcome.status, 3) << outcome.output;
  EXPECT_EQ(summary()["status"], "not usable");
  EXPECT_NE(outcome.output.find("not one of 1 measurements came to its end; packing 0 of soft-solid"),
            std::string::npos)
      << outcome.output;
}

}  // namespace
