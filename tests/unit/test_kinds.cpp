// The table of kinds, and a scene given to the wrong command: the message names the right one.
#include <gtest/gtest.h>

#include <set>

#include "common/core/error.h"
#include "pipelines/kinds/kinds.h"

namespace softgrain {
namespace {

std::string complaint(const std::string& kind, const std::string& command) {
  try {
    (void)kind_of(Scene::parse("kind = \"" + kind + "\"\n", "s.toml"), command);
  } catch (const BadInput& e) {
    return e.what();
  }
  return "";
}

TEST(Kinds, EveryOneIsWholeAndNamedOnce) {
  std::set<std::string> names;
  for (const SceneKind& k : scene_kinds()) {
    EXPECT_TRUE(names.insert(k.name).second) << k.name;
    EXPECT_TRUE(k.run != nullptr && k.check != nullptr && k.read != nullptr) << k.name;
    EXPECT_EQ(complaint(k.name, k.command), "") << k.name;
    EXPECT_STREQ(kind_of(Scene::parse("kind = \"" + std::string(k.name) + "\"\n", "s.toml")).name, k.name);
  }
  EXPECT_EQ(names.size(), 10U);
}

TEST(Kinds, TheCommandThatRunsAKindIsNamed) {
  EXPECT_EQ(complaint("cohesive-powder", "run"),
            "s.toml:1: kind = \"cohesive-powder\": scenes of this kind run with softgrain microsim, not with run");
  EXPECT_NE(complaint("pipeline", "macrosim").find("softgrain run"), std::string::npos);
  EXPECT_NE(complaint("macro", "microsim").find("softgrain macrosim"), std::string::npos);
}

TEST(Kinds, UnknownOnesAreNamedWithTheNearest) {
  EXPECT_NE(complaint("pipline", "run").find("nearest is \"pipeline\""), std::string::npos)
      << complaint("pipline", "run");
  EXPECT_THROW((void)kind_of(Scene::parse("seed = 1\n", "s.toml"), "run"), BadInput);
}

}  // namespace
}  // namespace softgrain
