// tests/bench/compare_engines does its work: a short run without the other programs, and what it writes.
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain::test;

struct ScriptOutcome {
  int status = -1;
  std::string output;
};

ScriptOutcome run_script(const std::string& arguments) {
  const std::string line =
      "python3 '" SOFTGRAIN_SOURCE_DIR "/tests/bench/compare_engines' --program '" SOFTGRAIN_PROGRAM "' " + arguments;
  ScriptOutcome outcome;
  FILE* pipe = ::popen((line + " 2>&1 </dev/null").c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

class CompareEngines : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("python3 --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no Python";
  }
  TemporaryDirectory directory_;
};

TEST_F(CompareEngines, AShortRunOfOurOwn) {
  const std::string file = directory_.file("speed.json");
  const auto outcome =
      run_script("--peers none --scenes A_hold --warm-up 2 --steps 5 --rounds 1 --json '" + file + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const auto report = nlohmann::json::parse(softgrain::read_text(file));
  EXPECT_EQ(report["steps"], 5);
  EXPECT_TRUE(report["problems"].empty());
  const auto& ours = report["scenes"]["A_hold"]["engines"]["softgrain"];
  EXPECT_EQ(ours["grains"], 20000);
  // The packing is at rest: hardly anything changes in seven steps.
  EXPECT_NEAR(ours["pressure"], 495.0, 15.0);
  EXPECT_NEAR(ours["coordination_number"], 5.83, 0.01);
  EXPECT_NEAR(ours["contacts"], 10000.0 * ours["coordination_number"].get<double>(), 1e-6);
  EXPECT_GT(ours["peak_memory"], 20000 * 300);
  EXPECT_GE(ours["listed_pairs"], ours["contacts"]);
  const double ns = ours["ns_per_contact"];
  EXPECT_GT(ns, 1.0);
  EXPECT_NEAR(ours["particle_steps_per_second"].get<double>() * ns * 1e-9 * ours["contacts"].get<double>() / 20000.0,
              1.0, 1e-9);
  EXPECT_NE(outcome.output.find("ns/contact"), std::string::npos) << outcome.output;
}

TEST_F(CompareEngines, WrongArgumentsAndMissingPrograms) {
  EXPECT_EQ(run_script("--scenes D_hold").status, 2);
  EXPECT_EQ(run_script("--peers fortran").status, 2);
  const auto outcome = run_script("--program /nowhere/softgrain --peers none --scenes A_hold");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.output.find("left out: softgrain"), std::string::npos) << outcome.output;
}

}  // namespace
