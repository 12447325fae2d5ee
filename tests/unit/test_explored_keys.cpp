// Which keys a reader asks for in any of its modes (common/io/key_record.h), and that it finds those of every kind.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/io/key_record.h"
#include "pipelines/kinds/kinds.h"
#include "tests/support/changed_keys.h"
#include "tests/support/keyed_scenes.h"
#include "tests/support/what_is_run.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Two modes of a test, one of which has a table with a list of stages below it.
void read_sample(const Scene& scene) {
  scene.read([](const SceneTable& root) {
    (void)root.text({"title", "title of all"}, "");
    const SceneTable test = root.table_or_empty({"test", "the test"});
    const std::string form = test.choice({"form", "which test"}, {"short", "long"}, "short");
    (void)test.number({"strain", "largest strain"}, Unit::none, Range::closed(0.0, 0.5), form == "long" ? 0.2 : 0.1);
    if (form == "long")
      for (const SceneTable& stage : test.tables({"stage", "one step"})) {
        const double length = stage.number({"length", "how far"}, Unit::length, Range::positive());
        if (stage.has("mass") && length > 0.0) (void)stage.number({"mass", "of the load"}, Unit::mass, Range::any());
        if (stage.flag({"held", "whether it waits"}, false)) (void)stage.count({"waits", "how long"}, 1, 9, 3);
      }
    return 0;
  });
}

std::vector<std::string> paths(const std::vector<ExploredKey>& keys) {
  std::vector<std::string> out;
  for (const ExploredKey& k : keys) out.push_back(k.path());
  return out;
}

const ExploredKey& key_at(const std::vector<ExploredKey>& keys, const std::string& path) {
  return *std::ranges::find_if(keys, [&](const ExploredKey& k) { return k.path() == path; });
}

TEST(ExploredKeys, AreThoseOfAllModesInTheOrderOfReading) {
  const auto keys = explore_keys({""}, read_sample);
  EXPECT_EQ(paths(keys),
            (std::vector<std::string>{"title", "test", "test.form", "test.strain", "test.stage", "test.stage.length",
                                      "test.stage.mass", "test.stage.held", "test.stage.waits"}));
}

TEST(ExploredKeys, SayWhatHoldsWithoutThem) {
  const auto keys = explore_keys({""}, read_sample);
  EXPECT_EQ(key_at(keys, "test.strain").defaults, (std::vector<std::string>{"0.1", "0.2"}));
  EXPECT_FALSE(key_at(keys, "test.strain").required);
  EXPECT_TRUE(key_at(keys, "test.stage.length").required);
  EXPECT_TRUE(key_at(keys, "test.stage.length").defaults.empty());
  EXPECT_FALSE(key_at(keys, "test.stage.mass").required) << "it is looked for first";
  EXPECT_EQ(key_at(keys, "test.stage.waits").defaults, (std::vector<std::string>{"3"}));
}

TEST(ExploredKeys, CarryWhatTheReaderSays) {
  const auto keys = explore_keys({""}, read_sample);
  const ExploredKey length = key_at(keys, "test.stage.length");
  EXPECT_EQ(length.asked.meaning, "how far");
  EXPECT_EQ(length.asked.unit, Unit::length);
  EXPECT_EQ(range_text(length.asked.range), "above 0");
  EXPECT_EQ(si_unit(length.asked.unit), "m");
  EXPECT_EQ(key_at(keys, "test.form").asked.words, (std::vector<std::string>{"short", "long"}));
}

TEST(RangeText, SaysBothEnds) {
  EXPECT_EQ(range_text(Range::any()), "");
  EXPECT_EQ(range_text(Range::closed(0.0, 0.5)), "from 0 to 0.5");
  EXPECT_EQ(range_text(Range{0.0, 1.0, true, false}), "above 0 and at most 1");
  EXPECT_EQ(range_text(Range{0.0, 1.0, false, true}), "at least 0 and below 1");
}

class ExploredKind : public ::testing::TestWithParam<KindScene> {};

/// "variant.0.name" as the exploration calls it.
std::string without_numbers(const std::string& path) {
  std::string out;
  std::istringstream parts(path);
  for (std::string part; std::getline(parts, part, '.');)
    if (part.find_first_not_of("0123456789") != std::string::npos) out += (out.empty() ? "" : ".") + part;
  return out;
}

/// "material.soft.E": "material.NAME.E".
std::string with_free_name(const std::string& path) {
  const std::size_t first = path.find('.');
  if (first == std::string::npos) return path;
  const std::size_t second = path.find('.', first + 1);
  return path.substr(0, first + 1) + kFreeName + (second == std::string::npos ? "" : path.substr(second));
}

/// No key that a scene of the tests has, or is asked for, is missing; and each says what it means.
TEST_P(ExploredKind, HasEveryKeyThatItsScenesAreAskedFor) {
  const TemporaryDirectory directory;
  write_keyed_files(directory);
  const KeyedText text{GetParam().text, directory.file("scene.toml")};
  const Scene scene = text.scene();
  const SceneKind& kind = kind_of(scene);
  std::set<std::string> known;
  for (const ExploredKey& k : keys_of(kind)) {
    known.insert(k.path());
    EXPECT_FALSE(k.asked.meaning.empty()) << k.path() << ": say what it means where it is read";
  }
  for (const auto& [path, key] : asked_keys(text, [](const Scene& s) { (void)what_is_run(s); })) {
    if (key.form == KeyForm::any || key.retired) continue;
    EXPECT_TRUE(known.contains(without_numbers(path)) || known.contains(with_free_name(without_numbers(path)))) << path;
  }
}

/// Loadings of both kinds are read by the same reader.
TEST(ExploredKeys, ModelsOfMaterialsHaveAllLoadingsOfMaterials) {
  std::map<std::string, std::set<std::string>> loadings;
  for (const SceneKind& kind : scene_kinds())
    if (std::string(kind.name).starts_with("material"))
      for (const ExploredKey& k : keys_of(kind))
        if (k.path().starts_with("loading.")) loadings[kind.name].insert(k.path());
  EXPECT_TRUE(loadings["material"].contains("loading.stage.lateral_stress"));
  EXPECT_EQ(loadings["material-models"], loadings["material"]);
}

TEST(ExploredKeys, AreAllThatShippedScenesHave) {
  std::size_t scenes = 0;
  for (const auto& file : std::filesystem::directory_iterator(SOFTGRAIN_SOURCE_DIR "/pipelines")) {
    if (file.path().extension() != ".toml") continue;
    const Scene scene = Scene::load(file.path().string());
    std::set<std::string> known;
    for (const ExploredKey& k : keys_of(kind_of(scene))) known.insert(k.path());
    for (const auto& [path, value] : flat_scene(scene.text(), file.path().string()))
      EXPECT_TRUE(known.contains(without_numbers(path)) || known.contains(with_free_name(without_numbers(path))))
          << file.path().filename() << ": " << path;
    ++scenes;
  }
  EXPECT_GT(scenes, 20U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ExploredKind, ::testing::ValuesIn(keyed_scenes()), name_of_kind);

}  // namespace
