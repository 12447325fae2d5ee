// A macro scene that does not fit into memory is refused by check and by the run alike, before any work.
#include <gtest/gtest.h>

#include <filesystem>

#include "pipelines/kinds/macro/room.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

TEST(MacroMemory, SaysWhatWouldFit) {
  MacroSetup setup;
  setup.spec.bodies = 1000;
  setup.spec.soft_share = 0.5;
  // Of the same sizes half of the volume is half of the bodies.
  setup.spec.soft_radius_max = setup.spec.solid_radius_max;
  setup.spec.soft_polydispersity = setup.spec.solid_polydispersity;
  constexpr double kGrains = 401.0;
  const double needed = macro_memory(1000.0 + 500.0 * kGrains);
  EXPECT_EQ(macro_memory_problem(setup, kGrains, needed), "");
  EXPECT_EQ(macro_memory_problem(setup, kGrains, 0.0), "");  // unknown
  const std::string problem = macro_memory_problem(setup, kGrains, 0.5 * needed);
  EXPECT_NE(problem.find("allowed: up to 500, or more with resolved = false"), std::string::npos) << problem;
  EXPECT_NE(problem.find("a resolved twin of about 2.02e+05 grains needs about 0.157 GB"), std::string::npos)
      << problem;
  // Of half the radius it is eight ninths.
  MacroSetup smaller = setup;
  smaller.spec.soft_radius_max = 0.5 * setup.spec.solid_radius_max;
  const double more = macro_memory(1000.0 + 8000.0 / 9.0 * kGrains);
  EXPECT_EQ(macro_memory_problem(smaller, kGrains, more * (1.0 + 1e-12)), "");
  EXPECT_NE(macro_memory_problem(smaller, kGrains, more * (1.0 - 1e-6)), "");
  setup.twins.clear();
  EXPECT_EQ(macro_memory_problem(setup, kGrains, macro_memory(1000.0)), "");
  EXPECT_NE(macro_memory_problem(setup, kGrains, 0.25 * macro_memory(1000.0)).find("allowed: up to 250"),
            std::string::npos);
}

TEST(MacroMemory, WhatDoesNotFitIsRefusedBeforeAnyWork) {
  for (const KindScene& kind : {KindScene{"macro", "macrosim", kTinyMacro, 0}, {"pipeline", "run", kTinyPipeline, 3}}) {
    const KindRuns runs(kind);
    const std::string errors = runs.out("errors.txt");
    const std::vector<std::string> large{"--set", "macro.bodies=10000000", "--set", "macro.soft_share=0.99"};
    std::vector<std::vector<std::string>> asked{{"check", runs.out("scene.toml")}, runs.arguments("out")};
    for (std::vector<std::string>& words : asked) {
      words.insert(words.end(), large.begin(), large.end());
      const int status = signal_after(start_program(words, errors_to(errors)), 60.0, SIGKILL);
      EXPECT_TRUE(ended_with(status, 2)) << kind.name << " " << words[0] << status;
      const std::string said = read_text(errors);
      EXPECT_NE(said.find("bodies = 10000000: a resolved twin of about"), std::string::npos) << said;
      EXPECT_NE(said.find("allowed: up to"), std::string::npos) << said;
      EXPECT_FALSE(std::filesystem::exists(runs.out("out") + "/work"));
    }
  }
}

}  // namespace
