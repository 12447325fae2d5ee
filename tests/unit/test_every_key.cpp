// Every key of every kind, in every place where it may stand: with another value the scene is refused, or something
// else is run. Keys are those that the readers ask for (common/io/key_record.h), so that a new one is tried by itself.
// SlowEveryKey in tests/robustness does the same with the results of runs.
#include <gtest/gtest.h>

#include <cstdio>
#include <set>

#include "tests/support/changed_keys.h"
#include "tests/support/keyed_scenes.h"
#include "tests/support/what_is_run.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Keys that are not tried, in all scenes or one, and why.
const std::map<std::string, std::string> kElsewhere{
    {"kind", "another kind is another scene, with keys of its own"},
    {"recipe levels.ratio", "decides how many levels there are: here two at every ratio that is allowed"},
    {"recipe-stages levels.ratio", "decides how many levels there are: here two at every ratio that is allowed"},
    {"disks material.powder.E",
     "describes the material; a remark says that no contact of it has a law that goes by it"},
    {"disks material.powder.nu",
     "describes the material; a remark says that no contact of it has a law that goes by it"},
    {"disks material.powder.rigid",
     "describes the material; a remark says that no contact of it has a law that goes by it"},
    {"disks contact.1.pair", "its order does not matter, and without one of the two a contact has no law"},
    {"particles-drawn material.soft.rigid",
     "describes the material; a remark says that no contact of it has a law that goes by it"},
    {"particles-drawn particle.0.inside", "there is no sphere that they could be inside: \"none\" is all it takes"},
    {"particles-drawn particle.1.inside", "there is no sphere that they could be inside: \"none\" is all it takes"},
    {"particles-drawn contact.0.pair", "its order does not matter, and without one of the two a contact has no law"},
    {"particles-drawn particle.2.inside", "there is no sphere that they could be inside: \"none\" is all it takes"},
};

struct KeyTally {
  std::size_t places = 0;
  std::size_t values = 0;
  std::size_t refused = 0;  ///< keys of which every value is
  std::vector<std::string> without_effect{};
};

class EveryKey : public ::testing::TestWithParam<KindScene> {
 protected:
  EveryKey() { write_keyed_files(directory_); }
  [[nodiscard]] KeyedText scene() const { return {GetParam().text, directory_.file("scene.toml")}; }

  /// Empty when it is refused.
  static std::string fingerprint(const KeyedText& text) {
    try {
      return what_is_run(text.scene());
    } catch (const Error&) {
      return "";
    }
  }

  static Keys keys_of_scene(const KeyedText& text) {
    return asked_keys(text, [](const Scene& s) { (void)what_is_run(s); });
  }

  /// One key: false when no other value changes what is run though one at least was taken.
  static void try_key(const KeyedText& text, const std::string& base, const std::string& path, const AskedKey& key,
                      const std::set<std::string>& texts, KeyTally& tally) {
    std::size_t same = 0;
    std::size_t other = 0;
    std::string example;
    for (const std::string& value : other_values(key, texts)) {
      if (means_the_same(path, value)) continue;
      const std::string now = fingerprint(text.with(path + "=" + value));
      ++tally.values;
      if (now.empty()) continue;
      ++(now == base ? same : other);
      if (now == base && example.empty()) example = value;
      if (other > 0 && key.form != KeyForm::choice && key.form != KeyForm::flag) break;
    }
    ++tally.places;
    if (same + other == 0) ++tally.refused;
    // Of keys that were not there it is not known which word they stand for.
    const bool words = key.form == KeyForm::choice || key.form == KeyForm::flag;
    const std::size_t may_be_default = words && key.texts.empty() && key.numbers.empty() ? 1 : 0;
    const bool idle = words ? same > may_be_default : other == 0 && same > 0;
    if (idle) tally.without_effect.push_back(path + " = " + example);
  }

  static bool is_tried(const std::string& path, const Keys& keys) {
    return !kElsewhere.contains(path) && !kElsewhere.contains(GetParam().name + " " + path) &&
           stands_for_all(path, keys) && !given_in_a_part(path, keys);
  }

  static KeyTally try_all(const KeyedText& text) {
    KeyTally tally;
    const std::string base = fingerprint(text);
    if (base.empty()) return tally;
    const Keys keys = keys_of_scene(text);
    const std::set<std::string> texts = texts_of(keys);
    for (const auto& [path, key] : keys)
      if (is_tried(path, keys)) try_key(text, base, path, key, texts, tally);
    return tally;
  }

  TemporaryDirectory directory_;
};

std::string joined_lines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& l : lines) text += "  " + l + "\n";
  return text;
}

TEST_P(EveryKey, ChangesWhatIsRunOrIsRefused) {
  ASSERT_NO_THROW((void)what_is_run(scene().scene()));
  const KeyTally tally = try_all(scene());
  std::printf("%s: %zu keys and places, %zu values, %zu keys refused with every value\n", GetParam().name.c_str(),
              tally.places, tally.values, tally.refused);
  EXPECT_GT(tally.places, GetParam().instant ? 5U : 10U);
  EXPECT_TRUE(tally.without_effect.empty()) << "taken without effect:\n" << joined_lines(tally.without_effect);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryKey, ::testing::ValuesIn(keyed_scenes()), name_of_kind);

/// The same under every other word and flag of the scene.
class SlowEveryKeyOfEveryMode : public EveryKey {};

TEST_P(SlowEveryKeyOfEveryMode, ChangesWhatIsRunOrIsRefused) {
  const Keys keys = keys_of_scene(scene());
  const std::set<std::string> texts = texts_of(keys);
  std::size_t modes = 0;
  KeyTally all;
  std::set<std::string> idle;
  for (const auto& [path, key] : keys) {
    if ((key.form != KeyForm::choice && key.form != KeyForm::flag) || !is_tried(path, keys)) continue;
    for (const std::string& value : other_values(key, texts)) {
      if (means_the_same(path, value)) continue;
      const KeyTally tally = try_all(scene().with(path + "=" + value));
      if (tally.places == 0) continue;
      ++modes;
      all.places += tally.places;
      all.values += tally.values;
      for (const std::string& w : tally.without_effect) idle.insert(w + " under " + path + " = " + value);
    }
  }
  std::printf("%s: %zu modes, %zu keys and places, %zu values\n", GetParam().name.c_str(), modes, all.places,
              all.values);
  EXPECT_TRUE(idle.empty()) << "taken without effect:\n" << joined_lines({idle.begin(), idle.end()});
}

INSTANTIATE_TEST_SUITE_P(Kinds, SlowEveryKeyOfEveryMode, ::testing::ValuesIn(keyed_scenes()), name_of_kind);

}  // namespace
