// Strict reading of scenes: values, messages with file and line, unknown keys, overrides.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "common/core/error.h"
#include "common/core/law_range.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"

namespace softgrain {
namespace {

constexpr const char* kText = R"(kind = "soft-particle"
gravity = [0.0, 0, "-981 cm/s^2"]
[packing]
radius = "16 mm"
beta = 3
trials = 1e4
turns = true
[material.glass]
E = "48 GPa"
[[contact]]
pair = ["glass", "glass"]
mu = 0.5
[[contact]]
pair = ["glass", "steel"]
mu = 0.25
)";

Scene parse(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return Scene::parse(text, "scene.toml", overrides);
}

/// The message of the InputError that `action` throws; empty when it throws none.
template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Scene, ReadsEveryKindOfValue) {
  const Scene scene = parse(kText);
  const SceneTable root = scene.root();
  EXPECT_EQ(root.choice("kind", {"grain-box", "soft-particle"}), "soft-particle");
  EXPECT_EQ(root.vector3("gravity", Unit::acceleration), (Vec3{{0.0, 0.0, -9.81}}));
  const SceneTable packing = root.table("packing");
  EXPECT_EQ(packing.number("radius", Unit::length, Range::positive()), 0.016);
  EXPECT_EQ(packing.number("beta", Unit::none), 3.0);
  EXPECT_EQ(packing.count("trials", 1, 1000000), 10000);
  EXPECT_TRUE(packing.flag("turns", false));
  EXPECT_EQ(packing.number("absent", Unit::none, Range::any(), 7.0), 7.0);
  const SceneTable materials = root.table("material");
  ASSERT_EQ(materials.keys(), std::vector<std::string>{"glass"});
  EXPECT_EQ(materials.named("glass").number("E", Unit::pressure), 48e9);
  const std::vector<SceneTable> contacts = root.tables("contact");
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_EQ(contacts[1].texts("pair"), (std::vector<std::string>{"glass", "steel"}));
  EXPECT_EQ(contacts[0].number("mu", Unit::none), 0.5);
  EXPECT_EQ(contacts[1].number("mu", Unit::none), 0.25);
  EXPECT_EQ(contacts[0].texts("pair").size(), 2U);
  EXPECT_NO_THROW(scene.root().finish());
}

TEST(Scene, RangeMessageNamesPlaceValueAndLimit) {
  const Scene scene = parse("[packing]\nradius = 1.0\nbeta = 0.9\n");
  const SceneTable packing = scene.root().table("packing");
  EXPECT_EQ(message_of([&] { (void)packing.number("beta", Unit::none, Range::above(1.0)); }),
            "scene.toml:3: beta = 0.9: must be above 1");
  EXPECT_EQ(message_of([&] { (void)packing.number("beta", Unit::none, Range::closed(1.0, 2.5)); }),
            "scene.toml:3: beta = 0.9: must be from 1 to 2.5");
  EXPECT_EQ(message_of([&] {
              (void)packing.number("radius", Unit::length, Range{0.0, 1.0, false, true});
            }),
            "scene.toml:2: radius = 1: must be at least 0 and below 1");
}

TEST(Scene, UnknownKeyNamesTheNearestAskedFor) {
  const Scene scene = parse("kind = \"x\"\n[packing]\nbeta = 2.0\nraddius = 1.0\n");
  (void)scene.root().text("kind");
  const SceneTable packing = scene.root().table("packing");
  (void)packing.number("beta", Unit::none);
  (void)packing.number("radius", Unit::length, Range::any(), 1.0);
  EXPECT_EQ(message_of([&] { scene.root().finish(); }),
            "scene.toml:4: unknown key 'raddius' in [packing]; nearest known key is 'radius'");
}

TEST(Scene, UnknownKeyWithoutNearOneListsTheKnown) {
  const Scene scene = parse("zzzzzz = 1\nbeta = 2.0\n");
  (void)scene.root().number("beta", Unit::none);
  EXPECT_EQ(message_of([&] { scene.root().finish(); }),
            "scene.toml:1: unknown key 'zzzzzz' at the top level; known keys are beta");
}

/// What was written in the wrong table, or without its table on the command line, is named with the right one.
TEST(Scene, UnknownKeyThatAnotherTableHasNamesThatTable) {
  const auto read = [](const Scene& scene) {
    (void)scene.root().count("seed", 0, 10, 1);
    (void)scene.root().table("material").number("mu", Unit::none);
    for (const char* name : {"solid", "soft"})
      (void)scene.root().table_or_empty(name).number("angle", Unit::none, Range::any(), 1.0);
  };
  const auto complaint = [&](const std::string& text, const std::vector<std::string>& settings) {
    const Scene scene = Scene::parse(text, "scene.toml", settings);
    read(scene);
    return message_of([&] { scene.root().finish(); });
  };
  const std::string text = "[material]\nmu = 0.3\n";
  EXPECT_EQ(complaint(text, {"mu=0.5"}),
            "scene.toml (--set mu): unknown key 'mu' at the top level; nearest known key is 'material.mu'");
  EXPECT_EQ(complaint("mu = 0.5\n" + text, {}),
            "scene.toml:1: unknown key 'mu' at the top level; nearest known key is 'mu' in [material]");
  EXPECT_EQ(complaint(text + "seed = 3\n", {}),
            "scene.toml:3: unknown key 'seed' in [material]; nearest known key is 'seed' at the top level");
  EXPECT_EQ(complaint(text, {"angle=2"}),
            "scene.toml (--set angle): unknown key 'angle' at the top level; nearest known keys are 'soft.angle', "
            "'solid.angle'");
}

/// A word from the command line may ask for other keys than the scene has beside it.
TEST(Scene, UnknownKeyBesideASettingSaysHowToReplaceTheTable) {
  const Scene scene = Scene::parse("[sizes]\nform = \"fuller\"\nzzz = 2.0\n", "scene.toml", {"sizes.form=list"});
  (void)scene.root().table("sizes").text("form");
  EXPECT_EQ(message_of([&] { scene.root().finish(); }),
            "scene.toml:3: unknown key 'zzz' in [sizes]; known keys are form; with --set sizes.form it may no longer "
            "fit: --set 'sizes={...}' replaces the whole table");
  const Scene file_alone = Scene::parse("[sizes]\nform = \"fuller\"\nzzz = 2.0\n", "scene.toml", {"seed=1"});
  (void)file_alone.root().table("sizes").text("form");
  (void)file_alone.root().number("seed", Unit::none);
  EXPECT_EQ(message_of([&] { file_alone.root().finish(); }),
            "scene.toml:3: unknown key 'zzz' in [sizes]; known keys are form");
}

TEST(Scene, WhatSoftgrainDoesNotModelIsSaidBesideTheNearestKey) {
  const Scene scene = parse("beta = 2.0\n[packing]\naspect_ratio = 2.0\nbata = 1.0\nfluid_viscosity = 1e-3\n");
  (void)scene.root().number("beta", Unit::none);
  (void)scene.root().table("packing").number("beta", Unit::none, Range::any(), 1.0);
  EXPECT_EQ(message_of([&] { scene.root().finish(); }),
            "scene.toml:3: unknown key 'aspect_ratio' in [packing]; known keys are beta; softgrain has no "
            "non-spherical grains: see README, 'What it is not for'\n"
            "scene.toml:4: unknown key 'bata' in [packing]; nearest known key is 'beta'\n"
            "scene.toml:5: unknown key 'fluid_viscosity' in [packing]; known keys are beta; softgrain has no fluids: "
            "see README, 'What it is not for'");
  EXPECT_NE(out_of_scope_text("STL").find("walls from meshes"), std::string::npos);
  EXPECT_NE(out_of_scope_text("strength").find("breakage"), std::string::npos);
  EXPECT_NE(out_of_scope_text("gravity").find("kind \"particles\""), std::string::npos);
  for (const char* key : {"restrength", "mu_r", "bondary", "reshaped", "fluidity", ""})
    EXPECT_EQ(out_of_scope_text(key), "") << key;
}

/// The messages point to it.
TEST(Scene, ReadmeSaysWhatItIsNotFor) {
  EXPECT_NE(read_text(SOFTGRAIN_SOURCE_DIR "/README.md").find("### What it is not for\n"), std::string::npos);
}

TEST(Scene, UnknownKeysAreFoundInsideElementsOfArrays) {
  const Scene scene = parse("[[contact]]\nmu = 1.0\n[[contact]]\nmu = 1.0\nmuu = 2.0\n");
  for (const SceneTable& contact : scene.root().tables("contact")) (void)contact.number("mu", Unit::none);
  EXPECT_EQ(message_of([&] { scene.root().finish(); }),
            "scene.toml:5: unknown key 'muu' in [[contact]]; nearest known key is 'mu'");
}

TEST(Scene, MissingKeyNamesTableAndLikelyTypo) {
  const Scene scene = parse("\n[packing]\nraddius = 1.0\n");
  const SceneTable packing = scene.root().table("packing");
  EXPECT_EQ(message_of([&] { (void)packing.number("radius", Unit::length); }),
            "scene.toml:2: missing key 'radius' in [packing]; did 'raddius' at scene.toml:3 mean it?");
  EXPECT_EQ(message_of([&] { (void)scene.root().table("macro"); }), "scene.toml:1: missing table [macro]");
  EXPECT_EQ(message_of([&] {
              (void)scene.root().table({"fines", "what fills the voids"});
            }),
            "scene.toml:1: missing table [fines]: what fills the voids");
  EXPECT_EQ(scene.root().table_or_empty("macro").count("samples", 1, 9, 4), 4);
}

TEST(Scene, WrongTypesAreRefused) {
  const Scene scene = parse("a = true\nb = nan\nc = inf\nd = \"word\"\ne = 2.5\nf = [1, 2]\ng = 3\n");
  const SceneTable root = scene.root();
  const std::string number = "must be a number";
  EXPECT_EQ(message_of([&] { (void)root.number("a", Unit::none); }), "scene.toml:1: a = true: must be a number");
  for (const char* key : {"b", "c", "d", "f"})
    EXPECT_NE(message_of([&] { (void)root.number(key, Unit::length); }), "") << key;
  EXPECT_NE(message_of([&] { (void)root.count("e", 0, 10); }).find("must be a whole number"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)root.count("g", 4, 10); }).find("from 4 to 10"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)root.flag("g", false); }).find("true or false"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)root.vector3("f", Unit::length); }).find("three components"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)root.text("g"); }), "");
  EXPECT_NE(message_of([&] { (void)root.table("g"); }).find("must be a table [g]"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)root.tables("f"); }).find("[[f]]"), std::string::npos);
}

/// The message of a scene that is read with all its mistakes.
template <class Reader>
std::string errors_of(const Scene& scene, Reader reader) {
  return message_of([&] {
    (void)scene.read([&](const SceneTable& root) {
      reader(root);
      return 0;
    });
  });
}

TEST(SceneErrors, ComeInTheOrderOfTheFileWithTheCommandLineLast) {
  const Scene scene = parse("a = -1\n[b]\nc = 2.5\nzz = 1\n", {"d=x"});
  EXPECT_EQ(errors_of(scene,
                      [](const SceneTable& root) {
                        (void)root.count("d", 0, 9);
                        (void)root.table("b").count("c", 0, 9);
                        EXPECT_EQ(root.number("a", Unit::none, Range::positive(), 4.0), 4.0) << "the fallback";
                        EXPECT_FALSE(!root.has_errors());
                      }),
            "scene.toml:1: a = -1: must be above 0\n"
            "scene.toml:3: c = 2.5: must be a whole number from 0 to 9\n"
            "scene.toml:4: unknown key 'zz' in [b]; known keys are c\n"
            "scene.toml (--set d): d = \"x\": must be a whole number from 0 to 9");
}

TEST(SceneErrors, ThatFollowFromOthersAreNotTold) {
  const Scene scene = parse("[a]\nform = \"rond\"\nradius = 2\nlow = 9\n");
  EXPECT_EQ(errors_of(scene,
                      [](const SceneTable& root) {
                        const SceneTable a = root.table("a");
                        EXPECT_EQ(a.choice("form", {"flat", "round"}), "flat");
                        (void)a.number("width", Unit::none);  // missing, but a round one has a radius instead
                        a.add_error("low", "must be below high");
                        root.check([&] { a.throw_error("low", "must be below high"); });
                        const SceneTable b = root.table({"b", "what else there is"});
                        (void)b.number("x", Unit::none);
                        (void)b.table("c").text("y");
                        (void)root.table("b");
                      }),
            "scene.toml:1: missing table [b]: what else there is\n"
            "scene.toml:2: form = \"rond\": must be \"flat\" or \"round\"; nearest is \"round\"");
}

TEST(SceneErrors, OfAPartEndNoMoreThanIt) {
  const Scene scene = parse("[a]\nx = 1\ny = 2\n[b]\nz = -1\n");
  EXPECT_EQ(errors_of(scene,
                      [](const SceneTable& root) {
                        const SceneTable a = root.table("a");
                        a.section([&] {
                          (void)a.has("x");
                          a.throw_error("x", "does not fit");
                        });
                        (void)root.table("b").number("z", Unit::none, Range::positive());
                      }),
            "scene.toml:2: x = 1: does not fit\nscene.toml:5: z = -1: must be above 0")
      << "of a part that was left nothing is unknown";
}

TEST(SceneErrors, AMisspeltKeyIsToldOnce) {
  const Scene scene = parse("raddius = 1.0\n");
  EXPECT_EQ(errors_of(scene, [](const SceneTable& root) { (void)root.number("radius", Unit::length); }),
            "scene.toml:1: missing key 'radius' at the top level; did 'raddius' at scene.toml:1 mean it?");
}

TEST(SceneErrors, AreTwentyAtMost) {
  std::string many = "a = [-1]\nb = [";
  for (int k = 0; k < 24; ++k) many += "-1,\n";
  const Scene scene = parse(many + "]\n");
  const std::string message = errors_of(scene, [](const SceneTable& root) {
    EXPECT_EQ(root.numbers("a", Unit::none, Range::positive()), std::vector<double>{1.0});
    EXPECT_EQ(root.numbers("b", Unit::none, Range::positive()).size(), 24U);
  });
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20) << message;
  EXPECT_TRUE(message.ends_with("\nscene.toml: 5 more")) << message;
}

TEST(SceneErrors, ASceneWithoutAnyIsReadAndTroubleStaysTrouble) {
  EXPECT_EQ(parse("a = 3\n").read([](const SceneTable& root) { return root.count("a", 0, 9); }), 3);
  const auto trouble = [](const SceneTable& root) -> int {
    (void)root.count("a", 0, 9);
    throw IoError("states.h5: no such file");
  };
  EXPECT_THROW((void)parse("a = 3\n").read(trouble), IoError);
  EXPECT_THROW((void)parse("a = 30\n").read(trouble), BadScene);
}

TEST(Scene, ChoiceNamesTheWordsAndTheNearest) {
  const Scene scene = parse("law = \"hertz-tsuij\"\n");
  EXPECT_EQ(
      message_of([&] {
        (void)scene.root().choice("law", {"hertz-tsuji", "linear-spring"});
      }),
      "scene.toml:1: law = \"hertz-tsuij\": must be \"hertz-tsuji\" or \"linear-spring\"; nearest is \"hertz-tsuji\"");
}

TEST(Scene, SyntaxErrorsCarryFileAndLine) {
  const std::string message = message_of([] { (void)parse("a = 1\nb = = 2\n"); });
  EXPECT_EQ(message.rfind("scene.toml:2: not valid TOML", 0), 0U) << message;
  EXPECT_NE(message_of([] { (void)parse("a = 1\na = 2\n"); }), "");
}

TEST(Scene, OverridesReplaceAndCreateKeys) {
  const Scene scene = parse(kText, {"packing.beta=1.5", "packing.radius=5 mm", "kind=grain-box", "macro.samples=3",
                                    "contact.1.mu=0.75", "packing.sizes=[1, 2.5]"});
  const SceneTable root = scene.root();
  EXPECT_EQ(root.text("kind"), "grain-box");
  EXPECT_EQ(root.table("packing").number("beta", Unit::none), 1.5);
  EXPECT_EQ(root.table("packing").number("radius", Unit::length), 0.005);
  EXPECT_EQ(root.table("packing").numbers("sizes", Unit::none), (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(root.table("macro").count("samples", 1, 10), 3);
  EXPECT_EQ(root.tables("contact")[0].number("mu", Unit::none), 0.5);
  EXPECT_EQ(root.tables("contact")[1].number("mu", Unit::none), 0.75);
}

TEST(Scene, OverridesAreNamedInMessages) {
  const Scene scene = parse("[packing]\nbeta = 3\n", {"packing.beta=0.5", "packing.raddius=1"});
  const SceneTable packing = scene.root().table("packing");
  EXPECT_EQ(message_of([&] { (void)packing.number("beta", Unit::none, Range::above(1.0)); }),
            "scene.toml (--set packing.beta): beta = 0.5: must be above 1");
  (void)packing.number("radius", Unit::length, Range::any(), 1.0);
  EXPECT_EQ(message_of([&] { scene.root().finish(); }),
            "scene.toml (--set packing.raddius): unknown key 'raddius' in [packing]; nearest known key is 'radius'");
}

/// What a message names is what --set takes: elements of arrays by their number.
TEST(Scene, OverridesOfElementsAreNamedWithTheirNumber) {
  const Scene scene = parse(kText, {"contact.1.mu=-1", "contact.1.muu=2"});
  const std::vector<SceneTable> contacts = scene.root().tables("contact");
  EXPECT_EQ(message_of([&] { (void)contacts[1].number("mu", Unit::none, Range::not_negative()); }),
            "scene.toml (--set contact.1.mu): mu = -1: must be at least 0");
  EXPECT_NE(message_of([&] { scene.root().finish(); }).find("scene.toml (--set contact.1.muu): unknown key 'muu'"),
            std::string::npos);
  const Scene replaced = parse(kText, {"contact.1={mu=1}"});
  const SceneTable element = replaced.root().tables("contact")[1];
  EXPECT_EQ(element.where("pair"), "scene.toml (--set contact.1)");
}

TEST(Scene, BadOverridesAreRefused) {
  for (const char* setting : {"packing.beta", "=3", "packing..beta=3", "packing.=3", "packing.beta.x=3",
                              "contact.7.mu=1", "contact.x.mu=1", "packing.sizes=[1, 2", "packing.beta={a=}"})
    EXPECT_NE(message_of([&] { (void)parse(kText, {setting}); }).find("--set"), std::string::npos) << setting;
}

TEST(Scene, TextWithOverridesReadsBackTheSame) {
  const Scene first = parse(kText, {"packing.beta=0.1", "packing.radius=5 mm"});
  const Scene second = parse(first.text());
  EXPECT_EQ(second.root().table("packing").number("beta", Unit::none), 0.1);
  EXPECT_EQ(second.root().table("packing").text("radius"), "5 mm");
  EXPECT_EQ(second.root().tables("contact").size(), 2U);
  EXPECT_EQ(parse(kText).text(), kText);
}

TEST(Scene, RejectAndWhereSpeakInTheStandardForm) {
  const Scene scene = parse("a = 1\nb = 2.5\n");
  EXPECT_EQ(scene.root().where("b"), "scene.toml:2");
  EXPECT_EQ(message_of([&] { scene.root().throw_error("b", "must be below a"); }),
            "scene.toml:2: b = 2.5: must be below a");
}

TEST(Scene, MissingFileIsFileTrouble) {
  try {
    (void)Scene::load("/nowhere/scene.toml");
    FAIL() << "no error";
  } catch (const IoError& e) {
    EXPECT_STREQ(e.what(), "/nowhere/scene.toml: no such file");
  }
  EXPECT_THROW((void)Scene::load("/tmp"), IoError);
}

TEST(Scene, PathsAreRelativeToTheScene) {
  const Scene scene = Scene::parse("", "some/folder/scene.toml");
  EXPECT_EQ(scene.resolve("A.xyzr"), "some/folder/A.xyzr");
  EXPECT_EQ(scene.resolve("../A.xyzr"), "some/A.xyzr");
  EXPECT_EQ(scene.resolve("/data/A.xyzr"), "/data/A.xyzr");
  EXPECT_EQ(Scene::parse("", "scene.toml").resolve("A"), "A");
}

constexpr const char* kVariants = R"(title = "all"
only = ["b"]
[disks]
count = 10
share = 0.3
[[variant]]
name = "a"
[[variant]]
name = "b"
title = "two"
disks = { share = -1 }
[variant.walls]
count = 4
)";

TEST(SceneVariant, LiesOverItsScene) {
  const Scene scene = parse(kVariants, {"disks.count=20", "variant.1.walls.count=-5"});
  const Scene b = scene.variant(1, {"only", "name"});
  EXPECT_EQ(b.root().keys(), (std::vector<std::string>{"disks", "title", "walls"}));
  EXPECT_EQ(b.root().text("title"), "two");
  EXPECT_EQ(b.root().table("disks").count("count", 0, 100), 20) << "what --set says of the scene holds";
  EXPECT_EQ(message_of([&] { (void)b.root().table("disks").number("share", Unit::none, Range::positive()); }),
            "scene.toml:11: share = -1: must be above 0");
  EXPECT_EQ(message_of([&] { (void)b.root().table("walls").count("count", 0, 9); }),
            "scene.toml (--set walls.count): count = -5: must be a whole number from 0 to 9");
  EXPECT_EQ(message_of([&] { b.root().finish(); }), "");
  EXPECT_EQ(Scene::parse(b.text(), "b.toml").root().table("disks").number("share", Unit::none), -1.0)
      << "its text is a scene of its own";
}

TEST(SceneVariant, LeavesTheOthersAndTheSceneAlone) {
  const Scene scene = parse(kVariants);
  const Scene a = scene.variant(0, {"only", "name"});
  EXPECT_EQ(a.root().text("title"), "all");
  EXPECT_EQ(a.root().table("disks").number("share", Unit::none), 0.3);
  EXPECT_FALSE(a.root().has("walls"));
  EXPECT_EQ(scene.root().tables("variant").size(), 2U);
  EXPECT_NE(message_of([&] { (void)scene.variant(2, {}); }), "");
}

TEST(OldNames, AreReadUnderTheirPresentOnes) {
  const Scene scene = parse("[crowd]\npoints = -3\n[calibrate.crowd]\nbest = \"bag\"\n", {"crowd.packings=5"});
  const SceneTable table = scene.root().table("multi_contact");
  EXPECT_EQ(message_of([&] { (void)table.count("points", 0, 9); }),
            "scene.toml:2: points = -3: must be a whole number from 0 to 9");
  EXPECT_EQ(table.count("packings", 0, 9), 5) << "--set too";
  EXPECT_EQ(scene.root().table("calibrate").table("multi_contact").choice("best", {"pair", "isotropic"}), "isotropic");
  EXPECT_EQ(message_of([&] { (void)parse("[crowd]\n[multi_contact]\n"); }),
            "scene.toml:1: crowd is an earlier name of multi_contact; leave one of them out");
  EXPECT_EQ(parse_enum<LawForm>("bag"), LawForm::isotropic);
  const Scene table_of_laws =
      parse("[[entry]]\nretreat = 1.5\n[[entry.law]]\nretreat = 2.0\n[material.retreat]\nE = 1\n");
  const SceneTable entry = table_of_laws.root().tables("entry").at(0);
  EXPECT_EQ(entry.number("unloading", Unit::none), 1.5);
  EXPECT_EQ(entry.tables("law").at(0).number("unloading", Unit::none), 2.0);
  EXPECT_TRUE(table_of_laws.root().table("material").has("retreat")) << "a name that a scene gives stays";
}

TEST(NearestWord, FindsTyposAndStaysSilentOtherwise) {
  const std::vector<std::string> known{"radius", "density", "friction", "mu"};
  EXPECT_EQ(nearest_word("raduis", known), "radius");
  EXPECT_EQ(nearest_word("Friction", known), "friction");
  EXPECT_EQ(nearest_word("m", known), "mu");
  EXPECT_EQ(nearest_word("temperature", known), "");
  EXPECT_EQ(nearest_word("x", {}), "");
}

}  // namespace
}  // namespace softgrain
