// Starting states of macro scenes that are kept between runs, given as files, or cannot be had.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "common/core/limits.h"
#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

class MacroPackings : public ::testing::Test {
 protected:
  MacroPackings() {
    save_card(synthetic::card(), file("law.toml"));
    scene("bodies = 20\n");
  }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  void scene(const std::string& keys) const {
    write_text_atomic(file("scene.toml"),
                      "kind = \"macro\"\nlaw = \"law.toml\"\n[macro]\nsteps = 2\nresolved = false\n" + keys);
  }
  [[nodiscard]] ProgramOutcome macro(const std::string& name, const std::string& more = "") const {
    const std::string threads = more.find("--threads") == std::string::npos ? "--threads 1 " : "";
    ProgramOutcome outcome =
        run_the_program("macrosim '" + file("scene.toml") + "' --quiet --out '" + file(name) + "' " + threads + more);
    outcome.output = unwrapped(outcome.output);
    return outcome;
  }
  [[nodiscard]] MacroCurve curve(const std::string& name) const { return load_macro(file(name) + "/macro.h5").at(0); }
  [[nodiscard]] nlohmann::json summary(const std::string& name) const {
    return nlohmann::json::parse(read_text(file(name) + "/summary.json"));
  }
  static void expect(const ProgramOutcome& outcome, int status, const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.status, status) << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in " << outcome.output;
  }
  [[nodiscard]] std::int64_t kept() const {
    return std::distance(fs::directory_iterator(file("cache")), fs::directory_iterator());
  }

  TemporaryDirectory directory_;
};

TEST_F(MacroPackings, WhatIsRefusedInTheRunNamesItsFile) {
  scene("bodies = 20\nconstruction = \"voids\"\nsolid_fill = 0.73\n");
  expect(macro("run"), 2, {"scene.toml: macro: the solid grains jam", "before solid_fill = 0.73"});
  LawCard card = synthetic::card();
  card.pairs.pop_back();
  save_card(card, file("law.toml"));
  scene("bodies = 20\n");
  expect(macro("other"), 2, {"law.toml: law card: no usable soft-soft law"});
}

TEST_F(MacroPackings, WhatWasPreparedOnceIsTakenFromTheCache) {
  const std::string cache = "--packing-cache '" + file("cache") + "' ";
  expect(macro("first", cache), 0, {});
  EXPECT_EQ(kept(), 1);
  expect(macro("second", cache + "--set macro.strain=0.1"), 0, {});
  EXPECT_EQ(kept(), 1) << "the test is no part of the packing";
  EXPECT_EQ(curve("first").start.bodies, curve("second").start.bodies);
  EXPECT_EQ(curve("first").preparation.seconds, curve("second").preparation.seconds) << "prepared again";
  for (const char* change : {"--seed 2", "--set macro.bodies=21", "--set macro.start_pressure=2e-5",
                             "--set macro.preparation=fast", "--set macro.start_fraction=0.2",
                             "--set macro.solid_radius_max=0.02", "--set macro.preparation_tolerance=1e-3"}) {
    const std::int64_t before = kept();
    expect(macro("other", cache + change), 0, {});
    EXPECT_EQ(kept(), before + 1) << change;
  }
}

TEST_F(MacroPackings, ADamagedFileOfTheCacheIsMadeAgain) {
  const std::string cache = "--packing-cache '" + file("cache") + "' ";
  expect(macro("first", cache), 0, {});
  const fs::path kept_file = fs::directory_iterator(file("cache"))->path();
  fs::resize_file(kept_file, fs::file_size(kept_file) / 2);
  expect(macro("second", cache), 0, {});
  EXPECT_NE(log_of(file("second")).find("prepared again"), std::string::npos);
  EXPECT_EQ(curve("first").stress_axial, curve("second").stress_axial);
  EXPECT_EQ(macro("third", "--packing-cache /proc/softgrain").status, 4);
}

TEST_F(MacroPackings, SummaryAndReportSayWhatThePreparationTook) {
  expect(macro("run"), 0, {});
  const auto preparation = summary("run")["macro"]["preparation"];
  EXPECT_GT(preparation["loop_passes"].get<int>(), 10);
  EXPECT_GT(preparation["contact_evaluations"].get<int>(), preparation["loop_passes"].get<int>());
  EXPECT_GT(preparation["seconds"].get<double>(), 0.0);
  EXPECT_NE(read_text(file("run") + "/report.html").find("preparation, sample 0"), std::string::npos);
}

TEST_F(MacroPackings, WhatCannotBePreparedIsNotUsableAndSaysWhatWasReached) {
  expect(macro("run", "--set macro.preparation_passes=10"), 3, {"did not reach a pressure of 1e-05 E", "walls at"});
  EXPECT_EQ(summary("run")["status"], "not usable");
  EXPECT_EQ(summary("run")["kind"], "macro") << "what broke off says what it was";
  EXPECT_NE(summary("run")["provenance"]["scene"].get<std::string>().find("kind"), std::string::npos);
}

/// Four bodies in a square tube: two layers of a solid grain and a soft particle.
constexpr const char* kBodies = R"(# box [m] = 0 0 0 0.04 0.02 0.04
x [m], y [m], z [m], r [m], kind
0.01, 0.01, 0.01, 0.01, solid
0.03, 0.01, 0.01, 0.01, soft
0.01, 0.01, 0.03, 0.01, soft
0.03, 0.01, 0.03, 0.01, solid
)";

TEST_F(MacroPackings, AGivenPackingIsTakenAsItIs) {
  write_text_atomic(file("bodies.csv"), kBodies);
  scene("packing = \"bodies.csv\"\nstrain = 0.2\n");
  expect(macro("run"), 0, {});
  const MacroCurve c = curve("run");
  EXPECT_EQ(c.bodies, 4);
  EXPECT_EQ(c.soft, 2);
  EXPECT_NEAR(c.solid_fraction, 4.0 * 4.0 / 3.0 * M_PI * 1e-6 / (0.04 * 0.02 * 0.04), 1e-12);
  EXPECT_GT(c.stress_axial.back(), 0.0);
  EXPECT_EQ(c.preparation.loop_passes, 0);
  // Another content is another run; millimetres are the same lengths, and without a box the tightest one is taken.
  write_text_atomic(file("bodies.csv"),
                    "x [mm], y [mm], z [mm], r [mm], kind\n10, 10, 10, 10, solid\n30, 10, 10, 10, soft\n10, 10, 30, "
                    "10, soft\n30, 10, 30, 10, solid\n");
  EXPECT_EQ(macro("run", "--resume").status, 2);
  expect(macro("again"), 0, {});
  EXPECT_EQ(curve("again").bodies, 4);
  EXPECT_NEAR(curve("again").stress_axial.back(), c.stress_axial.back(), 1e-6 * c.stress_axial.back());
}

TEST_F(MacroPackings, AGivenPackingThatIsNoneIsRefusedWithLineAndColumn) {
  scene("packing = \"bodies.csv\"\n");
  const std::string head = "# box [m] = 0 0 0 0.04 0.02 0.04\nx [m], y [m], z [m], r [m], kind\n";
  const struct {
    std::string text;
    std::vector<std::string> words;
  } cases[] = {
      {"x [m], y [m], z [m], radius [m], kind\n0, 0, 0, 1, solid\n",
       {"bodies.csv:1", "needs a column \"r [m]\"", "radius [m]"}},
      {"x, y [m], z [m], r [m], kind\n0, 0, 0, 1, solid\n", {"bodies.csv:1", "x"}},
      {head, {"bodies.csv:2", "no body"}},
      {head + "0.01, 0.01, 0.01, 0, solid\n", {"bodies.csv:3", "r [m]", "above 0"}},
      {head + "0.01, 0.01, 0.01, 0.01, sold\n", {"bodies.csv:3", "kind", "solid or soft"}},
      {head + "0.01, , 0.01, 0.01, solid\n", {"bodies.csv:3", "y [m]", "missing"}},
      {head + "0.01, 0.01, 0.035, 0.01, solid\n", {"bodies.csv:3", "z [m]", "outside the box by 0.5"}},
      {head + "0.01, 0.01, 0.01, 0.01, solid\n0.02, 0.01, 0.01, 0.01, soft\n",
       {"bodies.csv:4", "overlaps the body of line 3 by 1"}},
      {"# box = 0 0 0 1\nx [m], y [m], z [m], r [m], kind\n0, 0, 0, 1, solid\n", {"bodies.csv:1", "must be 6 numbers"}},
      {"# box = 0 0 0 1 -1 1\nx [m], y [m], z [m], r [m], kind\n0, 0, 0, 1, solid\n",
       {"bodies.csv:1", "above the low"}},
      {"# box = 0 0 0 1 a 1\nx [m], y [m], z [m], r [m], kind\n0, 0, 0, 1, solid\n", {"bodies.csv:1", "box"}},
  };
  for (const auto& c : cases) {
    write_text_atomic(file("bodies.csv"), c.text);
    expect(macro("run"), 2, c.words);
    EXPECT_FALSE(fs::exists(file("run") + "/summary.json"));
  }
  fs::remove(file("bodies.csv"));
  expect(macro("run"), 4, {"bodies.csv"});
  write_text_atomic(file("bodies.csv"), kBodies);
  scene("packing = \"bodies.csv\"\nbodies = 4\npreparation = \"fast\"\nsamples = 2\n");
  expect(macro("run"), 2, {"bodies", "preparation", "samples", "goes without packing"});
}

TEST_F(MacroPackings, PartsOfAPreparationThatHaveNoEffectAreRefused) {
  expect(macro("run", "--set macro.compaction_restitution=0.5"), 2, {"compaction_restitution", "inertial_number"});
  expect(macro("run", "--set macro.preparation=fats"), 2, {"nearest is \"fast\""});
  expect(macro("run", "--set macro.preparation=dense --set macro.construction=voids"), 2, {"mixed"});
  expect(macro("run", "--set macro.start_fraction=0.2 --set macro.construction=voids"), 2, {"solid_fill"});
  expect(macro("run", "--engine lammps --write-only --set macro.preparation=lammps --set macro.inertial_number=0.1"), 2,
         {"inertial_number", "LAMMPS has a protocol of its own"});
}

TEST_F(MacroPackings, CheckSaysHowBodiesArePrepared) {
  const ProgramOutcome said = run_the_program("check '" + file("scene.toml") + "' --set macro.preparation=fast");
  expect(said, 0, {"preparation fast", "inertial number 0.1", "mu = "});
  EXPECT_EQ(said.output.find("of what a body bears"), std::string::npos) << said.output;
  const std::string own = test::unwrapped(
      run_the_program("check '" + file("scene.toml") + "' --set macro.preparation=fast --set macro.balance=own-load")
          .output);
  EXPECT_NE(own.find("of what a body bears itself"), std::string::npos) << own;
}

/// The solid fractions that a message says are reached.
std::array<double, 2> reach_of(const std::string& output) {
  std::smatch found;
  const std::regex words("solid fractions\\s+from\\s+([0-9.]+)\\s+with[^)]*?to\\s+([0-9.]+)\\s+without");
  if (!std::regex_search(output, found, words)) return {kNaN, kNaN};
  return {std::stod(found[1]), std::stod(found[2])};
}

TEST_F(MacroPackings, ATargetDensityIsMetOrItsReachIsSaid) {
  scene("bodies = 80\npreparation = \"fast\"\nmu = 0.5\nwall_mu = 0.5\nsamples = 2\n");
  const ProgramOutcome none = macro("none", "--set macro.solid_fraction=0.9");
  expect(none, 3, {"solid_fraction = 0.9", "cannot be reached", "sample"});
  const auto [loose, dense] = reach_of(none.output);
  ASSERT_LT(loose, dense - 0.02) << none.output;
  const double target = 0.5 * (loose + dense);
  const std::string wanted =
      fmt::format("--set macro.solid_fraction={} --set macro.solid_fraction_tolerance=0.004 ", target);
  const std::string cache = "--packing-cache '" + file("cache") + "' ";
  expect(macro("run", wanted + cache), 0, {"target solid fraction", "compaction_mu", "preparations"});
  const nlohmann::json density = summary("run")["macro"]["target_density"];
  ASSERT_EQ(density["samples"].size(), 2U);
  std::int64_t tries = 0;
  for (const nlohmann::json& s : density["samples"]) {
    EXPECT_NEAR(s["solid_fraction"].get<double>(), target, 0.004);
    EXPECT_NEAR(s["difference"].get<double>(), s["solid_fraction"].get<double>() - target, 1e-12);
    EXPECT_GE(s["compaction_mu"].get<double>(), 0.0);
    EXPECT_LE(s["compaction_mu"].get<double>(), 0.5);
    tries += s["tries"].get<std::int64_t>();
  }
  EXPECT_NEAR(curve("run").solid_fraction, target, 0.004);
  EXPECT_EQ(kept(), tries + 2) << "every try, and what met the target";
  // From the cache, and the same as a void ratio.
  expect(macro("again", wanted + cache), 0, {});
  EXPECT_EQ(kept(), tries + 2);
  EXPECT_EQ(curve("again").stress_axial, curve("run").stress_axial);
  EXPECT_EQ(curve("again").density, curve("run").density);
  // Another target takes the ends of the search from there, and the bits do not depend on the cache or on threads.
  const std::string other =
      fmt::format("--set macro.void_ratio={} --set macro.solid_fraction_tolerance=0.004 --threads 2 ",
                  1.0 / (target + 0.004) - 1.0);
  expect(macro("cached", other + cache), 0, {"target solid fraction"});
  expect(macro("fresh", other), 0, {});
  EXPECT_EQ(curve("cached").stress_axial, curve("fresh").stress_axial);
  EXPECT_EQ(curve("cached").density, curve("fresh").density);
  EXPECT_NE(curve("cached").density, curve("run").density);
}

TEST_F(MacroPackings, ATargetDensityNeedsFrictionAndOneMeasure) {
  scene("bodies = 80\n");
  expect(macro("run", "--set macro.solid_fraction=0.6"), 2,
         {"solid_fraction", "preparation = \"fast\"", "compaction_mu"});
  const std::string fast = "--set macro.preparation=fast ";
  expect(macro("run", fast + "--set macro.solid_fraction=1.2"), 2, {"solid_fraction", "below 1"});
  expect(macro("run", fast + "--set macro.solid_fraction=0.6 --set macro.void_ratio=0.6"), 2, {"give one of the two"});
  expect(macro("run", fast + "--set macro.dry_density=5000"), 2, {"dry_density", "below the density of the grains"});
  expect(macro("run", fast + "--set macro.solid_fraction_tolerance=0.01"), 2, {"goes with a target"});
  expect(macro("run", fast + "--set macro.solid_fracton=0.6"), 2, {"nearest known key is 'solid_fraction'"});
  expect(macro("run", "--set macro.preparation=lammps --engine lammps --write-only --set macro.solid_fraction=0.6"), 2,
         {"solid_fraction", "by this program"});
  write_text_atomic(file("bodies.csv"), kBodies);
  scene("packing = \"bodies.csv\"\nsolid_fraction = 0.6\n");
  expect(macro("run"), 2, {"solid_fraction", "goes without packing"});
}

TEST_F(MacroPackings, CheckSaysWhatATargetDensityCosts) {
  scene("bodies = 80\npreparation = \"fast\"\nsolid_fraction = 0.9\n");
  const ProgramOutcome said = run_the_program("check '" + file("scene.toml") + "'");
  expect(said, 0,
         {"target solid_fraction = 0.9 +- 0.002", "preparations of each sample", "bodies reach", "out of reach"});
}

}  // namespace
