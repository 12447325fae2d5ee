// What is recorded on the way does not change where a run ends; and the comparison of runs sees what differs.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;

TEST(OutputChangesNothing, ParticlesWithAndWithoutATrajectory) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  const std::vector<std::vector<std::string>> ways{
      {}, {"--set", "output={record=false}"}, {"--set", "output.every=0.05"}, {"--set", "checkpoint.every_steps=64"}};
  for (std::size_t k = 0; k < ways.size(); ++k)
    ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments(std::to_string(k), ways[k]))), 0)) << k;
  const json whole = summary_of(runs.out("0"));
  ASSERT_EQ(whole["particles"].size(), 60U);
  for (std::size_t k = 1; k < ways.size(); ++k)
    EXPECT_EQ(whole["particles"], summary_of(runs.out(std::to_string(k)))["particles"]) << ways[k][1];
}

/// Enough grains for threads inside the force loop and for grains that are put in another order.
TEST(OutputChangesNothing, ManyParticlesOnAnyNumberOfThreads) {
  const TemporaryDirectory directory;
  const std::string scene = std::string(SOFTGRAIN_SOURCE_DIR) + "/tests/bench/scenes/A_shear.toml";
  for (const char* threads : {"1", "2", "3", "8"})
    ASSERT_TRUE(
        ended_with(wait_for(start_program({"microsim", scene, "--out", directory.file(threads), "--threads", threads,
                                           "--quiet", "--set", "time.steps=10", "--set", "time.warm_up_steps=0",
                                           "--set", "output.record=true", "--set", "output.every=1.0"})),
                   0));
  for (const char* threads : {"2", "3", "8"}) expect_same_runs(directory.file("1"), directory.file(threads));
}

/// A comparison that finds nothing would let every test pass that relies on it.
TEST(RunComparison, FindsWhatDiffers) {
  const KindRuns runs({"macro-comparison", "run", kTinyComparison, 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("b", {"--seed", "2"}))), 0));
  std::string all;
  for (const std::string& d : run_differences(runs.out("a"), runs.out("b"))) all += d + "\n";
  for (const char* what : {"macro_oedometric-35.h5/", "macro_initial_oedometric-35.h5/sample_0/bodies: differs",
                           "summary.json: ", "comparison.json: ", "table.csv: ", "table.md: "})
    EXPECT_NE(all.find(what), std::string::npos) << what << "\n" << all;
  std::filesystem::remove(runs.out("b") + "/table.md");
  EXPECT_NE(run_differences(runs.out("a"), runs.out("b")).size(), 0U);
}

TEST(RunComparison, SeesAttributesAndLastBits) {
  const TemporaryDirectory directory;
  const auto write = [&](const std::string& name, double attribute, double value) {
    std::filesystem::create_directories(directory.file(name));
    h5::AtomicFile file(directory.file(name) + "/data.h5");
    file.root().attribute("number", attribute);
    file.root().create("group").write("values", std::vector<double>{1.0, value});
    file.root().open("group").attribute("seconds", attribute);
    file.commit();
  };
  write("a", 1.0, 2.0);
  write("b", 1.0, std::nextafter(2.0, 3.0));
  write("c", 1.5, 2.0);
  EXPECT_EQ(run_differences(directory.file("a"), directory.file("a")).size(), 0U);
  EXPECT_EQ(run_differences(directory.file("a"), directory.file("b")),
            std::vector<std::string>{"data.h5/group/values: differs"});
  EXPECT_EQ(run_differences(directory.file("a"), directory.file("c")),
            std::vector<std::string>{"data.h5@number: differs"});
}

}  // namespace
