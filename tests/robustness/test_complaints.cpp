// What a refused command tells programs, and what it leaves behind.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kWrong = R"(kind = "particles"
[material.grain]
density = -1.0
E = 5e5
nu = 0.3
mistake = 1
)";

TEST(Complaints, JsonIsAnObjectWithEveryMistake) {
  const TemporaryDirectory directory;
  const std::string scene = directory.file("scene.toml");
  const std::string errors = directory.file("errors");
  write_text_atomic(scene, kWrong);
  const ProgramOutcome refused = run_the_program("microsim " + scene + " --json", errors);
  EXPECT_EQ(refused.status, 2);
  const json told = json::parse(refused.output);
  EXPECT_EQ(told.at("status"), "bad input");
  EXPECT_EQ(told.at("exit_status"), 2);
  ASSERT_GE(told.at("errors").size(), 2U);
  bool density = false;
  for (const json& one : told.at("errors")) {
    EXPECT_EQ(one.at("file"), scene);
    density =
        density || (one.at("line") == 3 && one.at("message").get<std::string>().find("density") != std::string::npos);
  }
  EXPECT_TRUE(density) << refused.output;
  EXPECT_NE(read_text(errors).find("softgrain: " + scene + ":3"), std::string::npos) << read_text(errors);
}

TEST(Complaints, JsonAlsoForTheCommandLine) {
  const ProgramOutcome refused = run_the_program("microsim --threads none scene.toml --json", "/dev/null");
  EXPECT_EQ(refused.status, 2);
  const json told = json::parse(refused.output);
  EXPECT_EQ(told.at("exit_status"), 2);
  EXPECT_NE(told.at("errors").at(0).at("message").get<std::string>().find("--threads"), std::string::npos);
  EXPECT_TRUE(run_the_program("microsim --threads none scene.toml", "/dev/null").output.empty());
}

TEST(Complaints, AMacroSceneSaysWhereItsMaterialsComeFrom) {
  const TemporaryDirectory directory;
  const std::string scene = directory.file("scene.toml");
  write_text_atomic(scene, "kind = \"macro\"\nlaw = \"" SOFTGRAIN_SOURCE_DIR
                           "/results/published/law.toml\"\n[material]\nE = 1e9\n[macro]\nbodies = 12\n");
  const ProgramOutcome refused = run_the_program("macrosim " + scene + " --out " + directory.file("run"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.output.find("are those of the law"), std::string::npos) << refused.output;
  EXPECT_FALSE(fs::exists(directory.file("run")));
}

TEST(Complaints, ARefusedRunLeavesNoDirectory) {
  const TemporaryDirectory directory;
  const std::string scene = directory.file("scene.toml");
  write_text_atomic(scene, kWrong);
  EXPECT_EQ(run_the_program("microsim " + scene + " --out " + directory.file("new/deep")).status, 2);
  EXPECT_FALSE(fs::exists(directory.file("new")));
  // One that was there stays.
  fs::create_directories(directory.file("old"));
  EXPECT_EQ(run_the_program("microsim " + scene + " --out " + directory.file("old")).status, 2);
  EXPECT_TRUE(fs::is_directory(directory.file("old")));
}

}  // namespace
