// Choices and their words: each word stands for one value, and scenes read them.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "common/contact/law_set.h"
#include "common/core/error.h"
#include "common/data/macro_result.h"
#include "common/data/multi_contact_law.h"
#include "common/data/snapshot.h"
#include "common/io/scene.h"
#include "microsim/multi_contact_arrangements.h"
#include "microsim/protocol.h"

namespace softgrain {
namespace {

enum class Colour { red, green, dark_blue };

}  // namespace

template <>
inline constexpr auto enum_names<Colour> =
    enum_name_list<Colour>({{Colour::red, "red"}, {Colour::green, "green"}, {Colour::dark_blue, "dark-blue"}});

namespace {

template <class Enum>
class WordsOf : public ::testing::Test {};
using Choices = ::testing::Types<Colour, LawForm, LawStatus, RangePolicy, Extrapolation, PairKind, PartnerKind,
                                 Placement, MultiContactMove, MultiContactUse, LawType, Tangential, Arrangement,
                                 Relaxation, Twin, MacroTest, SnapshotKind, ParticleRole, WallShape, Moment>;
TYPED_TEST_SUITE(WordsOf, Choices);

TYPED_TEST(WordsOf, AreOneForEachValue) {
  std::set<TypeParam> values;
  for (const auto& [value, text] : enum_names<TypeParam>) {
    EXPECT_EQ(to_string(value), text);
    EXPECT_EQ(parse_enum<TypeParam>(text), value) << text;
    EXPECT_TRUE(values.insert(value).second) << text;
  }
  for (std::size_t k = 0; k < values.size(); ++k) EXPECT_TRUE(values.contains(static_cast<TypeParam>(k))) << k;
  EXPECT_FALSE(values.contains(static_cast<TypeParam>(values.size())));
  EXPECT_EQ(parse_enum<TypeParam>("no such word"), std::nullopt);
  EXPECT_EQ(parse_enum<TypeParam>(""), std::nullopt);
}

SceneTable scene(const std::string& text) { return Scene::parse(text, "scene.toml").root(); }

std::string refusal(const std::string& text) {
  try {
    (void)scene(text).choice("paint", {Colour::red, Colour::dark_blue});
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(WordsOfAScene, AreReadAsTheirValues) {
  EXPECT_EQ(scene("paint = \"dark-blue\"").choice<Colour>("paint"), Colour::dark_blue);
  EXPECT_EQ(scene("paint = \"red\"").choice<Colour>("paint", Colour::green), Colour::red);
  EXPECT_EQ(scene("").choice<Colour>("paint", Colour::green), Colour::green);
  EXPECT_THROW((void)scene("").choice<Colour>("paint"), InputError);
}

TEST(WordsOfAScene, OthersAreRefusedWithThoseThatAreAllowed) {
  EXPECT_NE(refusal("paint = \"dark-blu\"").find("must be \"red\" or \"dark-blue\"; nearest is \"dark-blue\""),
            std::string::npos);
  EXPECT_NE(refusal("paint = \"green\"").find("scene.toml:1"), std::string::npos) << "a word, but none of these two";
  EXPECT_EQ(refusal("paint = \"red\""), "");
}

}  // namespace
}  // namespace softgrain
