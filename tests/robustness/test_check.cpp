// softgrain check: what follows from scenes, laws, results and run directories, with the warnings that a colleague
// would give, in a moment and without a trace.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "common/data/macro_result.h"
#include "tests/support/check_facts.h"
#include "tests/support/every_kind.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_files.h"
#include "tests/support/unwrapped.h"

namespace softgrain {
namespace {

using nlohmann::json;
using test::Check;
using test::run_the_program;
namespace fs = std::filesystem;

const std::string kRoot = SOFTGRAIN_SOURCE_DIR;
const std::string kCard = kRoot + "/results/published/law.toml";
const std::string kTable = kRoot + "/results/law_table/law_table.toml";

TEST_F(Check, TheErrorOfALawFromTheLibraryIsThatOfTheLibrary) {
  const test::ProgramOutcome outcome = run_the_program("check '" + kRoot + "/pipelines/press_test_library.toml'");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  const std::string said = test::unwrapped(outcome.output);
  EXPECT_NE(said.find("% by the library (laws of its materials"), std::string::npos) << said;
  EXPECT_EQ(said.find("nothing to leave out"), std::string::npos) << said;
}

TEST_F(Check, AMacroSceneThatLammpsPreparesSaysWhatItNeeds) {
  const std::string scene = macro(kCard, "bodies = 1000000\npreparation = \"lammps\"\nstrain = 0.1\n");
  ::setenv("SOFTGRAIN_LAMMPS", "/nowhere/softgrain-lammps", 1);
  const json found = scene_facts(scene);
  ::unsetenv("SOFTGRAIN_LAMMPS");
  EXPECT_EQ(found["engine"], "lammps");
  EXPECT_NEAR(found["lammps_file_bytes"].get<double>(), 91e6, 1e6);
  EXPECT_TRUE(warned(found, "no program there")) << found["warnings"];
  EXPECT_FALSE(scene_facts(macro(kCard, "")).contains("engine"));
}

TEST_F(Check, AMacroSceneOpensItsLaw) {
  EXPECT_TRUE(warned(scene_facts(macro("", "")), "no law named"));
  const json sound = scene_facts(macro(kCard, "strain = 0.1\nsoft_share = 0.0\nbodies = 200\nsamples = 3\n"));
  EXPECT_EQ(sound["law soft-solid"]["delta_max"], 0.3);
  EXPECT_EQ(sound["warnings"], json::array()) << sound["warnings"];
  EXPECT_GT(sound["core_seconds_parts"]["law runs"].get<double>(), 0.0);
  EXPECT_FALSE(sound["core_seconds_parts"].contains("twins"));
  const json deep = scene_facts(macro(kCard, "strain = 0.2\n"));
  EXPECT_TRUE(warned(deep, "soft-solid Delta along the load: about 0.4")) << deep["warnings"];
  EXPECT_TRUE(warned(deep, "take a law table"));
  EXPECT_NEAR(deep["affine_overlap"]["largest"].get<double>(), 0.4, 1e-12);
}

TEST_F(Check, TheLawOfTheCommandLineReplacesThatOfTheScene) {
  const json table = scene_facts(macro("absent.toml", "strain = 0.1\n"), "--law '" + kTable + "'");
  EXPECT_EQ(table["law"]["form"], "isotropic");
  EXPECT_FALSE(warned(table, "take a law table"));
  EXPECT_GT(table["law_volume"]["measured"].get<double>(), 0.1);
  write_text_atomic(directory_.file("scene.toml"), macro("absent.toml", ""));
  EXPECT_EQ(run_the_program("check '" + directory_.file("scene.toml") + "'").status, 4);
  EXPECT_EQ(run_the_program("check '" + kCard + "' --law '" + kTable + "'").status, 2) << "a card is no scene";
}

TEST_F(Check, ATableIsHeldAgainstTheSizesOfTheScene) {
  const json far = scene_facts(
      macro(kTable, "strain = 0.3\ntest = \"isotropic\"\nsolid_radius_max = 0.002\nsoft_polydispersity = 5\n"));
  EXPECT_TRUE(warned(far, "solid neighbours of ratio 0.0625")) << far["warnings"];
  EXPECT_TRUE(warned(far, "soft neighbours of ratio 1 to 5"));
  EXPECT_TRUE(warned(far, "lost volume of soft particles"));
  EXPECT_TRUE(warned(far, "overlaps of single soft contacts"));
}

/// What holds for a law is said once, what a scene asks of it for every scene.
TEST_F(Check, AComparisonSaysEveryLawOnce) {
  const std::string scene = kRoot + "/pipelines/macro_vs_resolved.toml";
  const std::string said = run_the_program("check '" + scene + "'").output;
  const auto times = [&](const std::string& words) {
    int n = 0;
    for (auto at = said.find(words); at != std::string::npos; at = said.find(words, at + 1)) ++n;
    return n;
  };
  for (const char* law : {"law soft-solid: good", "law soft-soft: good", "law: isotropic", "law: directional"})
    EXPECT_EQ(times(law), 1) << law;
  for (const char* asked : {"overlaps at the end", "  isotropic: lost volume", "  directional: lost volume"})
    EXPECT_EQ(times(asked), 7) << asked;
  const json scenes = facts(scene)["scenes"];
  ASSERT_EQ(scenes.size(), 7U);
  EXPECT_EQ(scenes[1]["name"], "isotropic-35");
  EXPECT_NEAR(scenes[1]["affine_overlap"]["largest"].get<double>(), 0.16, 1e-12);
  EXPECT_EQ(scenes[4]["law soft-solid"]["delta_max"], 0.3);
}

TEST_F(Check, FewPackingsAndFewOverlapsAreSaid) {
  const json poor = scene_facts(R"(kind = "soft-particle"
[packing]
trials = 50
polydispersity = 4
count = 3
[measure]
relaxation = "damped"
[measure.soft_solid]
deltas = [0.05, 0.1, 0.2]
)");
  EXPECT_TRUE(warned(poor, "only 3 packings; laws differ")) << poor["warnings"];
  EXPECT_TRUE(warned(poor, "only 1 overlap above Delta = 0.1"));
  EXPECT_TRUE(warned(poor, "nothing is rotated"));
  EXPECT_TRUE(warned(poor, "loose"));
  EXPECT_GT(poor["bytes"].get<double>(), 0.0);
  EXPECT_NEAR(poor["overlap soft-solid"].get<double>(), 0.54, 1e-12);
}

TEST_F(Check, ALongStepAndOverlapsOfParticlesAreSaid) {
  const std::string text = R"(kind = "particles"
[material.glass]
density = 2500
E = "1 MPa"
nu = 0.3
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.9
mu = 0.3
[[particle]]
material = "glass"
radius = 0.01
position = [0, 0, 0]
[[particle]]
material = "glass"
radius = 0.01
position = [0.015, 0, 0]
[time]
step_fraction = 0.5
steps = 1000
)";
  const json found = scene_facts(text);
  EXPECT_TRUE(warned(found, "overlap by 0.5 of the smaller radius")) << found["warnings"];
  EXPECT_NEAR(found["overlap"].get<double>(), 0.5, 1e-9);
  // A contact as deep is too stiff for such a step, which is shortened; grains that do not touch yet keep it.
  EXPECT_FALSE(warned(found, "the step is 0.50 sqrt(m/k)"));
  std::string apart = text;
  apart.replace(apart.find("0.015"), 5, "0.025");
  EXPECT_TRUE(warned(scene_facts(apart), "the step is 0.50 sqrt(m/k)"));
  EXPECT_NE(found["limited_by"].get<std::string>().find("set by the contacts at the start"), std::string::npos);
  // Of the state as it is given, not of where some steps bring it.
  EXPECT_EQ(found["contacts"], 1);
}

/// What the step comes from, and what comes out of times that are no whole numbers of steps.
TEST_F(Check, WhatTheStepIsAndWhatItMakesOfTimesIsSaid) {
  const auto pair = [](const std::string& velocity, const std::string& time) {
    return "kind = \"particles\"\n[material.glass]\ndensity = 2500\n[[contact]]\npair = [\"glass\", \"glass\"]\nlaw = "
           "\"linear-spring\"\nnormal_stiffness = 1000\nrestitution = 0.9\nmu = 0\n[[particle]]\nmaterial = "
           "\"glass\"\nradius = 0.001\nposition = [0, 0, 0]\n" +
           velocity + "[[particle]]\nmaterial = \"glass\"\nradius = 0.001\nposition = [0.003, 0, 0]\n[time]\n" + time;
  };
  const auto limited_by = [&](const std::string& text) { return scene_facts(text)["limited_by"].get<std::string>(); };
  const std::string moves = "velocity = [1, 0, 0]\n";
  EXPECT_NE(limited_by(pair("", "end = 1e-3\n")).find("set by particle"), std::string::npos);
  EXPECT_NE(limited_by(pair(moves, "end = 1e-3\n")).find("set by the shortest impact: 1/200"), std::string::npos);
  EXPECT_NE(limited_by(pair("", "end = 1e-9\n")).find("set by the end"), std::string::npos);
  EXPECT_EQ(limited_by(pair(moves, "end = 1e-3\nstep = 1e-6\n")), "given by the scene");
  const json uneven = scene_facts(pair("", "end = 1e-5\nstep = 3e-6\n[output]\nevery = 4.6e-6\n"));
  EXPECT_TRUE(warned(uneven, "end = 1e-05 s comes out as 1.2e-05 s")) << uneven["warnings"];
  EXPECT_TRUE(warned(uneven, "every = 4.6e-06 s comes out as 6e-06 s")) << uneven["warnings"];
  EXPECT_EQ(scene_facts(pair("", "end = 1.2e-5\nstep = 3e-6\n[output]\nevery = 6e-6\n"))["warnings"], json::array());
  EXPECT_TRUE(warned(scene_facts(pair("", "end = 1e-3\n[output]\nevery = 1e-9\n")), "every = 1e-09 s comes out as"));
  const json lost = scene_facts(pair("velocity = [1000, 0, 0]\n", "end = 1e-3\nstep = 2e-6\n"));
  EXPECT_TRUE(warned(lost, "particle 0 moves 2 of its radius in one step")) << lost["warnings"];
}

TEST_F(Check, OptionsOfTheCommandLineAreThoseOfTheRunOrRefused) {
  const std::string text =
      "kind = \"particles\"\n[material.m]\ndensity = 1\n[[contact]]\npair = [\"m\", \"m\"]\nlaw = \"linear-spring\"\n"
      "normal_stiffness = 1\nrestitution = 1\nmu = 0\n[[particle]]\nmaterial = \"m\"\nradius = 1e-3\nposition = [0, 0, "
      "0]\n[time]\nsteps = 1\n";
  (void)scene_facts(text);
  const auto said = [&](const std::string& more) {
    return run_the_program("check '" + directory_.file("scene.toml") + "' " + more);
  };
  EXPECT_NE(said("--threads 1").output.find("with 1 thread"), std::string::npos) << said("--threads 1").output;
  EXPECT_EQ(said("--threads 1").output.find("with 1 threads"), std::string::npos);
  for (const char* option : {"--law law.toml", "--bands 50"}) {
    const test::ProgramOutcome refused = said(option);
    EXPECT_EQ(refused.status, 2) << refused.output;
    EXPECT_NE(refused.output.find("not for scenes of kind \"particles\"; goes with \"macro\""), std::string::npos)
        << refused.output;
  }
}

/// With the contacts that some frames keep.
TEST_F(Check, TheFileOfARunIsAsLargeAsSaid) {
  std::string text =
      "kind = \"particles\"\n[material.glass]\ndensity = 2500\n[[contact]]\npair = [\"glass\", \"glass\"]\nlaw = "
      "\"linear-spring\"\nnormal_stiffness = 1000\nrestitution = 0.9\nmu = 0\n[cell]\nsize = [7.9e-3, 7.9e-3, "
      "7.9e-3]\nperiodic = [true, true, true]\n[time]\nstep = 1e-6\nsteps = 500\n[output]\nevery = 5e-6\n";
  for (int n = 0; n < 64; ++n)
    text += "[[particle]]\nmaterial = \"glass\"\nradius = 1e-3\nposition = [" + std::to_string(1.975e-3 * (n % 4)) +
            ", " + std::to_string(1.975e-3 * (n / 4 % 4)) + ", " + std::to_string(1.975e-3 * (n / 16)) + "]\n";
  const json found = scene_facts(text);
  const test::ProgramOutcome ran = run_the_program("microsim '" + directory_.file("scene.toml") + "' --quiet --out '" +
                                                   directory_.file("out") + "'");
  ASSERT_EQ(ran.status, 0) << ran.output;
  const auto real = static_cast<double>(fs::file_size(directory_.file("out/run.h5")));
  EXPECT_NEAR(found["disk_bytes"].get<double>(), real, 0.3 * real);
}

TEST_F(Check, ParticlesThatNoWallOrCellHoldsAreSaid) {
  const std::string head = R"(kind = "particles"
[material.glass]
density = 2500
E = "1 MPa"
nu = 0.3
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.9
mu = 0.3
[[contact]]
pair = ["glass", "rigid"]
law = "hertz-tsuji"
restitution = 0.9
mu = 0.3
[time]
steps = 10
[[particle]]
material = "glass"
radius = 0.01
position = [0, 0, 0]
[[particle]]
material = "glass"
radius = 0.01
position = [0.05, 0, 0]
)";
  const std::string sphere =
      "[[wall]]\nshape = \"sphere-inside\"\ncenter = [0, 0, 0]\nradius = 0.02\nmaterial = \"rigid\"\n";
  const json outside = scene_facts(head + sphere);
  EXPECT_TRUE(warned(outside, "the centre of particle 1 is outside every wall")) << outside["warnings"];
  EXPECT_TRUE(warned(outside, "scene.toml:25")) << outside["warnings"];
  EXPECT_FALSE(warned(scene_facts(head + "inside = \"none\"\n" + sphere), "outside every wall"));
  const std::string cell = "[cell]\nsize = [0.1, 0.1, 0.1]\nperiodic = [";
  const json beyond = scene_facts(head + "[[particle]]\nmaterial = \"glass\"\nradius = 0.01\nposition = [0, 0, 0.2]\n" +
                                  cell + "true, true, false]\n");
  EXPECT_TRUE(warned(beyond, "the centre of particle 2 is outside the cell: z = 0.2 m")) << beyond["warnings"];
  EXPECT_FALSE(warned(scene_facts(head + cell + "true, true, false]\n"), "outside the cell"));
  const std::string plane =
      "[[wall]]\nshape = \"plane\"\npoint = [0.02, 0, 0]\nnormal = [1, 0, 0]\nmaterial = \"rigid\"\n";
  const json counted = scene_facts(head + plane + "[guards.escape]\naction = \"count\"\n");
  EXPECT_TRUE(warned(counted, "the centre of particle 0 is 0.02 m behind the wall 'wall-1'")) << counted["warnings"];
}

TEST_F(Check, CardsAndTablesSayWhatToMind) {
  EXPECT_TRUE(warned(facts(kCard), "grains overlap by up to 0.81"));
  EXPECT_TRUE(warned(facts(kRoot + "/tests/reference/law/two_fractions.toml"),
                     "soft neighbours of ratio 1 are given back only to"));
}

TEST_F(Check, SummariesAndRunDirectories) {
  const std::string run = directory_.file("run");
  fs::create_directory(run);
  EXPECT_EQ(run_the_program("check '" + run + "'").status, 2);
  test::tiny_macro(run + "/macro.h5");
  fs::copy_file(kCard, run + "/law.toml");
  json half = facts(run);
  EXPECT_TRUE(warned(half, "no summary.json")) << half["warnings"];
  write_text_atomic(
      run + "/summary.json",
      R"({"status": "not usable", "command": "macrosim", "version": "0.1.0", "remarks": ["a point is off"]})");
  const json whole = facts(run);
  EXPECT_EQ(whole["kind"], "run directory");
  EXPECT_EQ(whole["files"]["macro.h5"]["kind"], "macro curves");
  EXPECT_EQ(whole["files"]["law.toml"]["kind"], "law card");
  EXPECT_TRUE(warned(whole, "summary.json: the run says of itself: not usable"));
  EXPECT_TRUE(warned(whole, "a point is off"));
  EXPECT_EQ(facts(run + "/summary.json")["run_status"], "not usable");
  write_text_atomic(run + "/summary.json",
                    R"({"status": "good", "command": "macrosim", "version": "0.1.0", "warnings": ["mind this"],
                        "remarks": ["as an aside"]})");
  EXPECT_TRUE(warned(facts(run), "summary.json: mind this"));
  EXPECT_FALSE(warned(facts(run), "as an aside"));
  const auto said = run_the_program("check '" + run + "/summary.json'");
  EXPECT_NE(said.output.find("note: as an aside"), std::string::npos) << said.output;
  EXPECT_EQ(run_the_program("check '" + run + "' --set macro.bodies=3").status, 2);
  EXPECT_EQ(run_the_program("check '" + run + "' --seed 3").status, 2);
  write_text_atomic(run + "/summary.json", "[1]");
  EXPECT_EQ(run_the_program("check '" + run + "/summary.json'").status, 2);
  write_text_atomic(run + "/summary.json", "{");
  EXPECT_EQ(run_the_program("check '" + run + "'").status, 2);
}

/// What people bring is told apart from scenes, and its units are looked at.
TEST_F(Check, TablesOfDataSayWhatTheyAre) {
  const json press = facts(kRoot + "/pipelines/press_test.csv");
  EXPECT_EQ(press["kind"], "force curves");
  EXPECT_EQ(press["samples"], 3);
  EXPECT_EQ(press["points"], 45);
  EXPECT_EQ(press["youngs_modulus"], 5e5);
  EXPECT_TRUE(press["warnings"].empty()) << press["warnings"];
  const std::string data = directory_.file("data.csv");
  const auto written = [&](const std::string& text) {
    write_text_atomic(data, text);
    return facts(data);
  };
  const std::string head = "# kind = soft-solid\n# Rs = 16 mm\n# E = 0.5 MPa\nhn [mm], Fn [N]\n";
  EXPECT_TRUE(warned(written(head + "1, 10\n2, 100\n3, 500\n4, 1000\n5, 2600\n"), "check the units"));
  EXPECT_TRUE(warned(written(head + "1, -.01\n2, -.1\n3, -.5\n4, -1\n5, -2\n"), "compression counts positive"));
  const json bare = written("hn [mm], Fn [N]\n1, 1\n2, 2\n3, 3\n4, 4\n5, 5\n");
  EXPECT_TRUE(warned(bare, "the file has no comment `# Rs = ...`: softgrain calibrate needs --radius"));
  EXPECT_FALSE(bare.contains("youngs_modulus")) << "the one that was assumed is none of the file";
  EXPECT_EQ(written("opening [mm], passing [%]\n1, 0\n2, 40\n4, 100\n")["kind"], "a sieve curve");
  EXPECT_EQ(written("radius [mm]\n1\n2\n")["kind"], "radii of grains");
  EXPECT_EQ(written("opening [mm], percent passing\n1, 0\n2, 40\n4, 100\n")["kind"], "a sieve curve");
  EXPECT_EQ(written("r [mm], count\n1, 10\n2, 3\n")["kind"], "radii of grains");
  const std::string bodies =
      "x [mm], y [mm], z [mm], r [mm], kind\n10, 10, 10, 10, solid\n30, 10, 10, 10, soft\n10, 10, 30, 10, soft\n";
  const json packing = written("# box [mm] = 0 0 0 80 20 40\n" + bodies);
  EXPECT_EQ(packing["kind"], "packing");
  EXPECT_EQ(packing["bodies"], 3);
  EXPECT_EQ(packing["soft"], 2);
  EXPECT_NEAR(packing["box"][0].get<double>(), 0.08, 1e-15);
  EXPECT_NEAR(written(bodies)["box"][0].get<double>(), 0.04, 1e-15);
  EXPECT_TRUE(warned(written("# box [cm] = -1 -3 -3 9 5 7\n" + bodies + "-10, 10, 30, 10, solid\n"), "periodic"));
  const auto refused = [&](const std::string& text, const std::string& words) {
    write_text_atomic(data, text);
    const test::ProgramOutcome told = run_the_program("check '" + data + "'");
    EXPECT_EQ(told.status, 2) << told.output;
    EXPECT_NE(told.output.find(words), std::string::npos) << told.output;
  };
  EXPECT_EQ(written("opening [mm], retained [%]\n1, 100\n2, 60\n4, 0\n")["kind"], "a sieve curve");
  refused("opening [mm], retained [%]\n1, 0\n4, 100\n", "or give largest = \"... mm\"");
  refused("# box = 0 0 0 80 20 40\n" + bodies, "write \"box [mm] = ...\"");
  refused("# boxx [mm] = 0 0 0 80 20 40\n" + bodies, "nearest is \"box\"");
  refused("# box [mm] = 0 0 0 80 20 40\n# box [mm] = 0 0 0 80 20 41\n" + bodies, "contradicts line 1");
  write_text_atomic(data, "colour, taste\n1, 2\n");
  const test::ProgramOutcome other = run_the_program("check '" + data + "'");
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.output.find("a table of data, no scene"), std::string::npos) << other.output;
}

TEST_F(Check, ARadiusOfMetresIsMinded) {
  const std::string scene =
      "kind = \"soft-particle\"\n[packing]\nshell_radius = 16\ntrials = 100\npolydispersity = 4.0\n"
      "count = 2\nbeta = 8.0\n[measure]\nrelaxation = \"damped\"\n[measure.soft_solid]\ndeltas = [0.2]\n";
  EXPECT_TRUE(warned(scene_facts(scene), "shell_radius is 16 m"));
  EXPECT_FALSE(warned(scene_facts(scene, "--set 'packing.shell_radius=16 mm'"), "shell_radius is"));
}

/// Bodies, soft particles and grains inside them, sample by sample, are those that the run then has.
void expect_counts_of_the_run(const std::string& text) {
  const test::KindRuns runs({"counts", kind_of(Scene::parse(text, "s")).command, text, 0});
  const std::vector<std::string> words = runs.arguments("run");
  const test::ProgramOutcome checked = run_the_program("check '" + words[1] + "' --json");
  ASSERT_EQ(checked.status, 0) << checked.output;
  const json samples = json::parse(checked.output)["macro_samples"];
  std::string line;
  for (const std::string& word : words) line += "'" + word + "' ";
  const test::ProgramOutcome outcome = run_the_program(line);
  ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.output;
  std::size_t twins = 0;
  for (const MacroCurve& c : load_macro(runs.out("run") + "/macro.h5")) {
    const json& expected = samples.at(static_cast<std::size_t>(c.sample));
    EXPECT_EQ(expected["bodies"].get<double>(), static_cast<double>(c.bodies)) << text;
    EXPECT_EQ(expected["soft"].get<double>(), static_cast<double>(c.soft)) << text;
    if (!c.twin()) continue;
    ++twins;
    EXPECT_EQ(expected["grains_inside"].get<double>(), static_cast<double>(c.grains)) << text;
  }
  EXPECT_GT(twins, 0U);
}

/// Soft particles were packed before, by the run too, and `check` did not name the file.
TEST_F(Check, ACardWithoutAUsableLawIsRefusedFirst) {
  write_text_atomic(directory_.file("scene.toml"), test::kTinyMacro);
  LawCard card = synthetic::card();
  card.pairs.resize(1);
  save_card(card, directory_.file("law.toml"));
  for (const std::string command : {"check", "run"}) {
    const test::ProgramOutcome said =
        run_the_program(command + " '" + directory_.file("scene.toml") + "'" +
                        (command == "run" ? " --quiet --out '" + directory_.file("out") + "'" : ""));
    EXPECT_EQ(said.status, 2) << said.output;
    EXPECT_NE(
        said.output.find("law.toml: law card: no usable soft-soft law: the card has none; softgrain calibrate --set "
                         "mirror=true derives it"),
        std::string::npos)
        << said.output;
  }
  EXPECT_FALSE(fs::exists(directory_.file("out")));
}

TEST_F(Check, CountsAreThoseOfTheRun) {
  // Two contents: of more, a check makes those that take two seconds, and says "about".
  const std::string macro =
      "kind = \"macro\"\nseed = 3\ncontents = 2\nlaw = \"law.toml\"\n[macro]\nbodies = 14\nsteps = 1\nstrain = "
      "0.05\nresolved = true\n";
  expect_counts_of_the_run(macro + "soft_share = 0.8\nsamples = 2\nsoft_radius_max = \"24 mm\"\n");
  expect_counts_of_the_run(macro + "soft_share = 0.3\nconstruction = \"voids\"\nsoft_radius_max = \"9 mm\"\n");
  expect_counts_of_the_run(test::kTinyPipeline);
}

/// Nothing is soft in a material, and nothing is said of it; its time is told, in cells of a few grains too.
/// The second packing fails.
constexpr const char* kHastyMaterial = R"(kind = "material"
[grains]
count = 120
ratio = 1.5
[packing]
preparation = "fast"
[test]
strain = 0.02
steps = 2
[[variant]]
name = "sound"
[[variant]]
name = "hasty"
preparation_passes = 10
)";

/// What makes the law of a recipe poor is said with the key that makes it better.
TEST_F(Check, WarningsOfARecipeNameTheKeysToChange) {
  const json found = scene_facts(R"(kind = "recipe"
samples = 1
[material]
E = 70e9
nu = 0.2
mu = 0.5
[grains]
count = 2000
radius_max = 2e-3
ratio = 8
[check]
grains = 0
[levels]
ratio = 3
)");
  EXPECT_TRUE(warned(found, "its onset will scatter; take more grains ([grains] count)")) << found["warnings"];
  EXPECT_TRUE(warned(found, "[check] grains = 0 is too few")) << found["warnings"];
}

/// One packing of a material fails: it is named, with what to do, and the others are there.
TEST_F(Check, AFailedPackingCostsNoOther) {
  write_text_atomic(directory_.file("scene.toml"), kHastyMaterial);
  const test::ProgramOutcome outcome =
      run_the_program("run '" + directory_.file("scene.toml") + "' --out '" + directory_.file("run") + "'");
  EXPECT_EQ(outcome.status, 3) << outcome.output;
  EXPECT_NE(test::unwrapped(outcome.output).find("packing hasty: "), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("preparation_passes"), std::string::npos) << outcome.output;
  const json summary = test::summary_of(directory_.file("run"));
  ASSERT_EQ(summary["variants"].size(), 1U);
  EXPECT_EQ(summary["variants"][0]["name"], "sound");
  EXPECT_TRUE(fs::exists(directory_.file("run") + "/material_sound.h5"));
  EXPECT_NE(read_text(directory_.file("run") + "/material.csv").find("sound,0"), std::string::npos);
}

/// A packing that fails is named once, with the tests that fall with it.
TEST_F(Check, AFailedPackingNamesTheTestsThatFallWithIt) {
  write_text_atomic(directory_.file("scene.toml"),
                    std::string(kHastyMaterial) +
                        "[[loading]]\nname = \"press\"\n[[loading]]\nname = \"squeeze\"\ntest = \"isotropic\"\n");
  const test::ProgramOutcome outcome =
      run_the_program("run '" + directory_.file("scene.toml") + "' --quiet --out '" + directory_.file("run") + "'");
  EXPECT_EQ(outcome.status, 3) << outcome.output;
  EXPECT_NE(test::unwrapped(outcome.output).find("packing hasty: "), std::string::npos) << outcome.output;
  EXPECT_NE(test::unwrapped(outcome.output).find("not tested: hasty-press, hasty-squeeze"), std::string::npos)
      << outcome.output;
  EXPECT_EQ(test::summary_of(directory_.file("run"))["variants"].size(), 2U);
}

/// A trial that loses a grain ended the command with status 3 and no file.
TEST_F(Check, SaysThatTheFirstStepsEndTheRun) {
  const std::string scene = test::with_part(test::tiny_particles(), "[0.0, 0.0, -9.81]", "[0.0, 0.0, 1e30]");
  const json found = scene_facts(scene, "--threads 1");
  EXPECT_TRUE(warned(found, "the run will end in its first")) << found["warnings"];
  EXPECT_FALSE(found.contains("seconds"));
}

/// Contacts that take all energy needed shorter steps than those of the trial, which broke off.
TEST_F(Check, TakesSoftParticlesThatDoNotBounce) {
  const std::string scene =
      test::with_part(test::kTinySoftParticle, "[packing]\n", "[material]\nrestitution = 0.0\n[packing]\n");
  EXPECT_GT(scene_facts(scene, "--threads 1").value("core_seconds", 0.0), 0.0);
}

}  // namespace
}  // namespace softgrain
