// What a refused command tells programs, and what it leaves behind.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

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

TEST(Complaints, JsonSaysKeyValueAllowedAndNearest) {
  const TemporaryDirectory directory;
  const std::string scene = directory.file("scene.toml");
  write_text_atomic(scene, std::string(kWrong) + "densty = 2.0\n");
  const ProgramOutcome refused = run_the_program("check " + scene + " --json --set material.grain.nu=0.7", "/dev/null");
  const json told = json::parse(refused.output);
  std::map<std::string, json> by_key;
  for (const json& one : told.at("errors"))
    if (one.contains("key")) by_key[one["key"]] = one;
  ASSERT_TRUE(by_key.contains("density") && by_key.contains("densty") && by_key.contains("nu")) << refused.output;
  EXPECT_EQ(by_key["density"]["value"], "-1");
  EXPECT_EQ(by_key["density"]["allowed"], "must be above 0");
  EXPECT_EQ(by_key["densty"]["nearest"], "density");
  EXPECT_EQ(by_key["densty"]["table"], "material.grain");
  EXPECT_EQ(by_key["nu"]["setting"], "material.grain.nu");
  EXPECT_FALSE(by_key["nu"].contains("line"));
}

/// A name of a file may look like a place in one.
TEST(Complaints, JsonOfALineThatIsNoNumberOfALine) {
  const ProgramOutcome refused = run_the_program("check 'a:99999999999999999999: b' --json", "/dev/null");
  EXPECT_EQ(refused.status, 4) << refused.output;
  const json told = json::parse(refused.output);
  EXPECT_FALSE(told.at("errors").at(0).contains("line"));
  EXPECT_NE(told.at("errors").at(0).at("message").get<std::string>().find("a:99999999999999999999: b"),
            std::string::npos);
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
