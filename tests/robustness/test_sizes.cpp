// Distributions of sizes in scenes of every kind that draws radii: what is wrong is said with status 2, by `check` in
// the same words as by the run; what was asked for stands beside what came out.
#include <gtest/gtest.h>

#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_law.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const std::string kTable = std::string(SOFTGRAIN_SOURCE_DIR) + "/results/law_table/law_table.toml";

/// A scene of a kind in seconds, with "SIZES" where its distribution stands.
struct SizedScene {
  std::string command;
  std::string text;
};

std::vector<SizedScene> sized_scenes() {
  return {{"microsim",
           "kind = \"soft-particle\"\n[packing]\ntrials = 100\ncount = 2\nbeta = 2.0\nsizes = SIZES\n[measure]\n"
           "relaxation = \"damped\"\n[measure.soft_solid]\ndeltas = [0.1]\n"},
          {"microsim",
           "kind = \"grain-box\"\n[material]\nsizes = SIZES\n[box]\ngrains = 60\n[generation]\npressure = \"10 MPa\"\n"
           "increment = 5e-4\nwindow = 4\nsaturation = 0.1\n[loading]\nincrement = 1e-3\nend_strain = 0.005\n"},
          {"microsim",
           "kind = \"cohesive-powder\"\n[disks]\ncount = 60\nsizes = SIZES\n[contact]\ncohesive = false\nkappa = 1e3\n"
           "[analysis]\nrigidity = false\nscattering = false\nholes = false\n"},
          {"macrosim", "kind = \"macro\"\nlaw = \"" + kTable +
                           "\"\n[macro]\nbodies = 30\nsolid_sizes = SIZES\nsteps = 1\nstrain = 0.02\nresolved = "
                           "false\n"},
          {"microsim",
           "kind = \"particles\"\n[material.sand]\ndensity = 2650.0\nE = \"70 MPa\"\nnu = 0.2\n[[contact]]\npair = "
           "[\"sand\", \"sand\"]\nlaw = \"hertz-tsuji\"\nrestitution = 0.5\nmu = 0.5\n[particles]\nmaterial = "
           "\"sand\"\ncount = 50\nsizes = SIZES\n[cell]\nsize = [0.06, 0.06, 0.06]\nperiodic = [true, true, "
           "false]\n[time]\nend = 1e-5\n"}};
}

class Sizes : public ::testing::Test {
 protected:
  ProgramOutcome run(const SizedScene& scene, const std::string& sizes, const std::string& command) {
    std::string text = scene.text;
    text.replace(text.find("SIZES"), 5, sizes);
    write_text_atomic(directory_.file("scene.toml"), text);
    return run_the_program(command + " '" + directory_.file("scene.toml") + "' --quiet" +
                           (command == "check" ? "" : " --threads 1 --out '" + directory_.file("out") + "'"));
  }
  void expect_refused(const std::string& sizes, const std::string& words) {
    for (const SizedScene& scene : sized_scenes()) {
      const ProgramOutcome ran = run(scene, sizes, scene.command);
      const ProgramOutcome checked = run(scene, sizes, "check");
      EXPECT_EQ(ran.status, 2) << ran.output;
      EXPECT_EQ(checked.status, 2) << checked.output;
      EXPECT_NE(ran.output.find(words), std::string::npos) << words << " not in: " << ran.output;
      EXPECT_NE(checked.output.find(words), std::string::npos) << words << " not in: " << checked.output;
      EXPECT_FALSE(std::filesystem::exists(directory_.file("out/summary.json")));
    }
  }
  void expect_sieves_refused(const std::string& text, const std::string& words) {
    write_text_atomic(directory_.file("sieves.csv"), text);
    expect_refused("{ form = \"sieve-curve\", file = \"sieves.csv\" }", words);
  }
  TemporaryDirectory directory_;
};

TEST_F(Sizes, SieveCurvesThatAreNone) {
  const std::string head = "opening [mm],passing [%]\n";
  expect_sieves_refused(head + "1,0\n2,60\n3,50\n4,100\n", "sieves.csv:4: passing falls to 50 % on a wider sieve");
  expect_sieves_refused(head + "1,0\n4,95\n", "sieves.csv:3: the curve goes from 0 % to 95 %");
  expect_sieves_refused(head + "1,0\n2,40\n2,50\n4,100\n", "the sieve of 2 mm is there twice");
  expect_sieves_refused(head + "1,100\n2,40\n4,0\n", "looks like what is retained in all");
  expect_sieves_refused("opening [mm],passing [%]\n1,5\n4,100\n", "or give smallest = \"... mm\"");
  expect_sieves_refused("opening,passing [%]\n1,0\n4,100\n", "opening [mm]");
}

TEST_F(Sizes, TablesThatAreNone) {
  expect_refused("{ form = \"fuler\", exponent = 0.5, radius_min = \"1 mm\", radius_max = \"2 mm\" }", "fuller");
  expect_refused("{ form = \"fuller\", exponent = 0.5, radius_min = \"2 mm\", radius_max = \"1 mm\" }",
                 "must be above radius_min");
  expect_refused("{ form = \"fuller\", exponent = 0.5, radius_min = \"1 mm\", radius_mux = \"2 mm\" }", "radius_max");
  expect_refused("{ form = \"classes\", class = [{ radius = \"1 mm\", volume_share = 0.4 }] }", "add up to 0.4");
  expect_refused("{ form = \"list\", radii = [] }", "at least one radius");
  expect_refused("{ form = \"list\", radii = [-1e-3] }", "above 0");
}

TEST_F(Sizes, OneWayToSayThemIsEnough) {
  const std::string list = "{ form = \"list\", radii = [\"1 mm\", \"2 mm\"] }";
  const char* const beside[] = {"polydispersity = 4.0", "radius_min = \"1 mm\"", "diameter_min = 0.5",
                                "solid_radius_max = \"2 mm\"", "file = \"particles.xyzr\""};
  const auto scenes = sized_scenes();
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    const ProgramOutcome ran = run(scenes[k], list + "\n" + beside[k], scenes[k].command);
    EXPECT_EQ(ran.status, 2) << ran.output;
    EXPECT_NE(ran.output.find("which says all sizes"), std::string::npos) << ran.output;
  }
}

TEST_F(Sizes, AFileThatIsNotThereIsTrouble) {
  const auto scenes = sized_scenes();
  const ProgramOutcome ran = run(scenes[1], "{ form = \"sieve-curve\", file = \"absent.csv\" }", "microsim");
  EXPECT_EQ(ran.status, 4) << ran.output;
  EXPECT_NE(ran.output.find("absent.csv"), std::string::npos) << ran.output;
}

TEST_F(Sizes, WhatCameOutStandsBesideWhatWasAsked) {
  for (const SizedScene& scene : sized_scenes()) {
    const ProgramOutcome ran = run(
        scene, "{ form = \"fuller\", exponent = 0.5, radius_min = \"3 mm\", radius_max = \"6 mm\" }", scene.command);
    ASSERT_TRUE(ran.status == 0 || ran.status == 3) << ran.output;
    const auto summary = summary_of(directory_.file("out"));
    ASSERT_EQ(summary["sizes"].size(), 1U) << scene.text;
    const auto& one = summary["sizes"][0];
    EXPECT_EQ(one["form"], "fuller");
    // Grains in shells are dropped where they find no place, and grow: they are further off.
    const bool shell = scene.text.find("soft-particle") != std::string::npos;
    EXPECT_LT(one["largest_difference"].get<double>(), shell ? 0.6 : 1.1 * one["largest_grain"].get<double>());
    EXPECT_GT(one["largest_difference"].get<double>(), 0.0);
    EXPECT_EQ(one["asked"].size(), one["obtained"].size());
    EXPECT_EQ(one["asked"].front(), 0.0);
    EXPECT_NEAR(one["asked"].back().get<double>(), 1.0, 1e-12);
    EXPECT_NEAR(one["obtained"].back().get<double>(), 1.0, 1e-12);
    EXPECT_EQ(run_the_program("report '" + directory_.file("out") + "'").status, 0);
    EXPECT_NE(read_text(directory_.file("out/report.html")).find("Sizes: requested and drawn"), std::string::npos);
    std::filesystem::remove_all(directory_.file("out"));
  }
}

TEST_F(Sizes, KeptTasksOfAnotherCurveServeNone) {
  write_text_atomic(directory_.file("sieves.csv"), "opening [mm],passing [%]\n2,0\n4,100\n");
  const auto scene = sized_scenes()[1];
  const std::string sizes = "{ form = \"sieve-curve\", file = \"sieves.csv\" }";
  ASSERT_EQ(run(scene, sizes, scene.command).status, 0);
  write_text_atomic(directory_.file("sieves.csv"), "opening [mm],passing [%]\n2,0\n3,10\n4,100\n");
  const ProgramOutcome again = run(scene, sizes, scene.command + " --resume");
  EXPECT_EQ(again.status, 2) << again.output;
  EXPECT_NE(again.output.find("belongs to another scene"), std::string::npos) << again.output;
}

TEST_F(Sizes, ParticlesThatFindNoPlace) {
  const SizedScene scene = sized_scenes()[4];
  const ProgramOutcome many = run(scene, "{ form = \"list\", radii = [\"12 mm\"] }", "check");
  EXPECT_EQ(many.status, 2);
  EXPECT_NE(many.output.find("the particles would fill"), std::string::npos) << many.output;
  const ProgramOutcome tight = run(scene, "{ form = \"list\", radii = [\"8 mm\"] }", "check");
  EXPECT_EQ(tight.status, 2);
  EXPECT_NE(tight.output.find("of 50 finds no place"), std::string::npos) << tight.output;
  const ProgramOutcome wide =
      run(scene, "{ form = \"list\", radii = [\"31 mm\"] }\nlow = [0, 0, 0]\nhigh = [1, 1, 0.05]", "check");
  EXPECT_EQ(wide.status, 2);
  EXPECT_NE(wide.output.find("wider than the box"), std::string::npos) << wide.output;
}

TEST_F(Sizes, SoftParticlesInVoidsAreAsLargeAsTheHoles) {
  SizedScene scene = sized_scenes()[3];
  scene.text.replace(scene.text.find("solid_sizes"), 11, "construction = \"voids\"\nsoft_sizes");
  const ProgramOutcome ran = run(scene, "{ form = \"list\", radii = [\"1 mm\"] }", "check");
  EXPECT_EQ(ran.status, 2) << ran.output;
  EXPECT_NE(ran.output.find("as large as the holes"), std::string::npos) << ran.output;
}

}  // namespace
