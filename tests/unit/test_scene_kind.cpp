// A scene given to the wrong command: the message names the right one.
#include <gtest/gtest.h>

#include "common/core/error.h"
#include "pipelines/scene_kind.h"

namespace softgrain {
namespace {

std::string complaint(const std::string& kind, const std::string& command) {
  try {
    refuse_other_commands(Scene::parse("kind = \"" + kind + "\"\n", "s.toml").root(), command);
  } catch (const BadInput& e) {
    return e.what();
  }
  return "";
}

TEST(SceneKind, TheCommandThatRunsAKindIsNamed) {
  EXPECT_EQ(complaint("cohesive-powder", "run"),
            "s.toml:1: kind = \"cohesive-powder\": scenes of this kind run with softgrain microsim, not with run");
  EXPECT_NE(complaint("pipeline", "macrosim").find("softgrain run"), std::string::npos);
  EXPECT_NE(complaint("macro", "microsim").find("softgrain macrosim"), std::string::npos);
}

TEST(SceneKind, RightAndUnknownKindsPass) {
  for (const char* kind : {"pipeline", "macro-comparison", "law-table", "hierarchy", "pipline"})
    EXPECT_EQ(complaint(kind, "run"), "") << kind;
  for (const char* kind : {"soft-particle", "particles", "grain-box", "cohesive-powder"})
    EXPECT_EQ(complaint(kind, "microsim"), "") << kind;
  EXPECT_EQ(complaint("macro", "macrosim"), "");
  EXPECT_NO_THROW(refuse_other_commands(Scene::parse("seed = 1\n", "s.toml").root(), "run"));
}

}  // namespace
}  // namespace softgrain
