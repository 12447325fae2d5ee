// Scenes to begin with: softgrain new for every kind, softgrain examples.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>

#include "common/io/text_file.h"
#include "pipelines/kinds/kinds.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

std::vector<std::string> names_of_kinds() {
  std::vector<std::string> names;
  for (const SceneKind& kind : scene_kinds()) names.emplace_back(kind.name);
  return names;
}

/// Keys of the first table of each name that stand without a comment before them.
std::vector<std::string> unexplained_keys(const std::string& scene) {
  std::vector<std::string> keys;
  std::set<std::string> met;
  bool first = true;
  std::string before;
  std::istringstream lines(scene);
  for (std::string line; std::getline(lines, line); before = line) {
    if (line.starts_with('[')) first = met.insert(line).second;
    const bool key = !line.empty() && !line.starts_with('#') && !line.starts_with('[');
    if (key && first && !before.starts_with("# ")) keys.push_back(line);
  }
  return keys;
}

class NewScene : public ::testing::TestWithParam<std::string> {};

TEST_P(NewScene, PassesCheckAndExplainsItsKeys) {
  const TemporaryDirectory directory;
  const std::string file = directory.file("scene.toml");
  const ProgramOutcome written = run_the_program("new " + GetParam() + " --out '" + file + "'");
  ASSERT_EQ(written.status, 0) << written.output;
  EXPECT_NE(written.output.find("softgrain run " + file), std::string::npos) << written.output;
  const ProgramOutcome checked = run_the_program("check '" + file + "'");
  EXPECT_EQ(checked.status, 0) << checked.output;
  EXPECT_NE(checked.output.find("scene of kind " + GetParam()), std::string::npos) << checked.output;
  const std::string text = read_text(file);
  EXPECT_TRUE(unexplained_keys(text).empty()) << unexplained_keys(text).front();
}

INSTANTIATE_TEST_SUITE_P(Kinds, NewScene, ::testing::ValuesIn(names_of_kinds()),
                         [](const ::testing::TestParamInfo<std::string>& tested) {
                           std::string name = tested.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(NewSceneFile, IsNeverWrittenOverAnother) {
  const TemporaryDirectory directory;
  const std::string file = directory.file("mine.toml");
  write_text_atomic(file, "mine\n");
  for (const std::string command : {"new particles", "examples quickstart"}) {
    const ProgramOutcome outcome = run_the_program(command + " --out '" + file + "'");
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_NE(outcome.output.find("mine.toml: is there already"), std::string::npos) << outcome.output;
    EXPECT_EQ(read_text(file), "mine\n");
  }
}

TEST(NewSceneFile, HasFurtherKeysAsCommentsThatCanBeTakenIntoUse) {
  const TemporaryDirectory directory;
  std::string text = run_the_program("new particles").output;
  EXPECT_NE(text.find("\n#[cell]\n"), std::string::npos) << text;
  const std::string idle = "\n#dimension = 3\n";
  ASSERT_NE(text.find(idle), std::string::npos) << text;
  text.erase(text.find(idle) + 1, 1);
  write_text_atomic(directory.file("scene.toml"), text);
  EXPECT_EQ(run_the_program("check '" + directory.file("scene.toml") + "'").status, 0);
  const std::string all = run_the_program("new particles --all").output;
  EXPECT_GT(all.size(), text.size() + 1000);
  write_text_atomic(directory.file("all.toml"), all);
  EXPECT_EQ(run_the_program("check '" + directory.file("all.toml") + "'").status, 0);
}

TEST(NewSceneFile, RunsAtOnce) {
  const TemporaryDirectory directory;
  const std::string file = directory.file("scene.toml");
  ASSERT_EQ(run_the_program("new macro --out '" + file + "'").status, 0);
  const ProgramOutcome ran = run_the_program("run '" + file + "' --quiet --out '" + directory.file("out") + "'");
  EXPECT_EQ(ran.status, 0) << ran.output;
  EXPECT_EQ(summary_of(directory.file("out"))["kind"], "macro");
}

TEST(NewSceneFile, UnknownKindNamesTheNearest) {
  const ProgramOutcome outcome = run_the_program("new pipline");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.output.find("new pipline: no such kind; nearest is 'pipeline'"), std::string::npos)
      << outcome.output;
  const ProgramOutcome list = run_the_program("new");
  EXPECT_EQ(list.status, 0);
  for (const std::string& kind : names_of_kinds())
    EXPECT_NE(list.output.find("  " + kind + "\n"), std::string::npos) << kind;
}

const std::string kShipped = SOFTGRAIN_SOURCE_DIR "/pipelines";

TEST(Examples, AreAllListedWithKindAndTitle) {
  const ProgramOutcome outcome = run_the_program("examples --json");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const nlohmann::json list = nlohmann::json::parse(outcome.output)["examples"];
  std::set<std::string> names;
  for (const nlohmann::json& one : list) {
    names.insert(one["name"]);
    EXPECT_FALSE(one["title"].get<std::string>().empty()) << one;
    EXPECT_TRUE(std::ranges::count(names_of_kinds(), one["kind"].get<std::string>()) == 1) << one;
    EXPECT_TRUE(fs::exists(one["file"].get<std::string>())) << one;
    if (one["name"] == "quickstart") {
      EXPECT_EQ(one["time"], "Three quarters of a minute on two cores.");
    }
  }
  std::size_t shipped = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(kShipped))
    if (entry.path().extension() == ".toml") ++shipped;
  EXPECT_EQ(names.size(), shipped);
  const std::string text = run_the_program("examples").output;
  EXPECT_NE(text.find("\nquickstart (pipeline): Quickstart"), std::string::npos) << text;
}

TEST(Examples, CopiesFindTheFilesThatTheyName) {
  const TemporaryDirectory directory;
  // The first names law card and law table, the second nothing.
  for (const std::string name : {"macro_vs_resolved", "quickstart.toml"}) {
    const std::string file = directory.file(name.substr(0, name.find('.')) + "_copy.toml");
    const ProgramOutcome copied = run_the_program("examples " + name + " --out '" + file + "'");
    ASSERT_EQ(copied.status, 0) << copied.output;
    const ProgramOutcome checked = run_the_program("check '" + file + "'");
    EXPECT_EQ(checked.status, 0) << checked.output;
  }
  EXPECT_EQ(read_text(directory.file("quickstart_copy.toml")), read_text(kShipped + "/quickstart.toml"));
  EXPECT_EQ(run_the_program("examples quickstart").output, read_text(kShipped + "/quickstart.toml"));
}

TEST(Examples, UnknownOneNamesTheNearest) {
  const ProgramOutcome outcome = run_the_program("examples quickstrat --out x.toml");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.output.find("nearest is 'quickstart'"), std::string::npos) << outcome.output;
  EXPECT_FALSE(fs::exists("x.toml"));
}

TEST(Examples, ACopyIsNoList) {
  const ProgramOutcome outcome = run_the_program("examples quickstart --json");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.output.find("--json: goes with the list of scenes"), std::string::npos) << outcome.output;
}

}  // namespace
