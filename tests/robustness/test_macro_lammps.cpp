// macrosim --engine lammps from outside: refusals before any work, files that are written, runs that agree with our own
// engine, are stopped, fail and go on. Runs are skipped where softgrain-lammps was not built.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/snapshot_io.h"
#include "common/io/text_file.h"
#include "macrosim/lammps_run/points_file.h"
#include "macrosim/macro_packing.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_law.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_pipeline.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;
namespace fs = std::filesystem;

/// Contacts bear from the start, so that both engines relax the same state.
constexpr const char* kScene = R"(kind = "macro"
title = "tiny"
law = "law.toml"
[macro]
bodies = 30
steps = 3
strain = 0.02
start_pressure = 3e-3
tolerance = 1e-4
resolved = false
)";

std::string beside_the_program() { return fs::path(SOFTGRAIN_PROGRAM).parent_path().string() + "/softgrain-lammps"; }

class MacroLammps : public ::testing::Test {
 protected:
  MacroLammps() {
    save_card(synthetic::card(), file("law.toml"));
    write_text_atomic(file("scene.toml"), kScene);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  [[nodiscard]] ProgramOutcome macro(const std::string& name, const std::string& more) const {
    return run_the_program("macrosim '" + file("scene.toml") + "' --quiet --threads 1 --out '" + file(name) + "' " +
                           more);
  }
  [[nodiscard]] json summary(const std::string& name) const {
    return json::parse(read_text(file(name) + "/summary.json"));
  }
  [[nodiscard]] MacroCurve curve(const std::string& name) const { return load_macro(file(name) + "/macro.h5").at(0); }

  static void expect(const ProgramOutcome& outcome, int status, const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.status, status) << outcome.output;
    const std::string said = unwrapped(outcome.output);
    for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << word << " not in " << said;
  }

  /// A program in the place of softgrain-lammps.
  [[nodiscard]] std::string fake_lammps(const std::string& commands) const {
    std::ofstream(file("substitute")) << "#!/bin/sh\n" << commands << "\n";
    fs::permissions(file("substitute"), fs::perms::owner_all);
    ::setenv("SOFTGRAIN_LAMMPS", file("substitute").c_str(), 1);
    return file("substitute");
  }
  ~MacroLammps() override { ::unsetenv("SOFTGRAIN_LAMMPS"); }

  TemporaryDirectory directory_;
};

TEST_F(MacroLammps, OptionsThatMeanNothingAreRefusedBeforeAnyWork) {
  expect(macro("run", "--engine lamps"), 2, {"nearest is 'lammps'"});
  expect(macro("run", "--ranks 2"), 2, {"--ranks goes with --engine lammps"});
  expect(macro("run", "--engine softgrain --write-only"), 2, {"--write-only goes with --engine lammps"});
  expect(macro("run", "--engine lammps --write-only --ranks 2"), 2, {"--ranks"});
  (void)fake_lammps("exit 1");
  expect(macro("run", "--engine lammps --ranks 1000"), 2, {"--ranks 1000", "bodies", "allowed: 1 to"});
  ::unsetenv("SOFTGRAIN_LAMMPS");
  expect(macro("run", "--engine lammps --ranks 0"), 2, {"--ranks 0: must be a whole number"});
  expect(macro("run", "--set macro.preparation=lammps"), 2, {"macro.preparation", "--engine lammps"});
  expect(macro("run", "--engine lammps --write-only --set macro.preparation=lammps --set macro.construction=voids"), 2,
         {"preparation", "mixed"});
  expect(macro("run", "--engine lammps --write-only --set macro.noise_samples=1"), 2,
         {"noise_samples", "LAMMPS runs each sample once"});
  expect(macro("run", "--set macro.preparation=lamps"), 2, {"lammps"});
  expect(run_the_program("microsim '" + file("scene.toml") + "'"), 2, {"softgrain run or macrosim, not with microsim"});
  write_text_atomic(file("pipeline.toml"), kTinyPipeline);
  expect(run_the_program("run '" + file("pipeline.toml") + "' --engine lammps --out '" + file("run") + "'"), 2,
         {"--engine: not for scenes of kind \"pipeline\"", "\"macro\", \"material\""});
  ::setenv("SOFTGRAIN_LAMMPS", "/nowhere/softgrain-lammps", 1);
  expect(macro("run", "--engine lammps"), 2, {"SOFTGRAIN_LAMMPS", "no program there"});
  EXPECT_FALSE(fs::exists(file("run") + "/log.txt"));
}

TEST_F(MacroLammps, ACommandThatRunsNoLammpsRefusesItsPreparation) {
  write_text_atomic(file("pipeline.toml"), std::string(kTinyPipeline) + "preparation = \"lammps\"\n");
  expect(run_the_program("run '" + file("pipeline.toml") + "' --out '" + file("run") + "'"), 2,
         {"preparation", "kind \"macro\" and \"material\"", "--engine lammps"});
}

TEST_F(MacroLammps, WriteOnlyNeedsNoLammpsAndWritesTheSameTwice) {
  ::setenv("PATH", "/usr/bin:/bin", 1);
  expect(macro("a", "--engine lammps --write-only"), 0, {"mpirun -np 4 softgrain-lammps", "--with-lammps"});
  expect(macro("b", "--engine lammps --write-only"), 0, {});
  EXPECT_EQ(summary("a")["status"], "written");
  for (const char* name : {"scene.in", "bodies.data", "laws.toml"})
    EXPECT_EQ(read_text(file("a/lammps-0/") + name), read_text(file("b/lammps-0/") + name));
  EXPECT_TRUE(fs::exists(file("a/macro_initial.h5")));
  EXPECT_FALSE(fs::exists(file("a/macro.h5")));
  const std::string script = read_text(file("a/lammps-0/scene.in"));
  EXPECT_NE(script.find("variable increments    index 2 "), std::string::npos) << script;
  expect(macro("finer", "--engine lammps --write-only --set macro.law_increments=8"), 0, {});
  const std::string finer = read_text(file("finer/lammps-0/scene.in"));
  EXPECT_NE(finer.find("variable increments    index 16 "), std::string::npos) << finer;
  expect(macro("c", "--engine lammps --write-only --set macro.preparation=lammps --set macro.samples=2"), 0, {});
  EXPECT_TRUE(fs::exists(file("c/lammps-1/scene.in")));
  EXPECT_FALSE(fs::exists(file("c/macro_initial.h5"))) << "bodies that do not touch are no starting state";
}

/// Its complaint, where the rest of it is, and how to go on; nothing that looks like a result.
TEST_F(MacroLammps, AChildThatFailsIsTrouble) {
  (void)fake_lammps("echo 'ERROR: something broke (file.cpp:1)'\nexit 7");
  expect(macro("run", "--engine lammps"), 4, {"ended with status 7", "something broke", "lammps.log", "--resume"});
  (void)fake_lammps("echo last words\nkill -9 $$");
  expect(macro("run", "--engine lammps"), 4, {"signal 9", "last words"});
  (void)fake_lammps("exit 0");
  expect(macro("run", "--engine lammps"), 4, {"0 of 4 points"});
  (void)fake_lammps("echo 'ERROR: Lost atoms: original 30 current 29 (thermo.cpp:438)'\nexit 1");
  expect(macro("run", "--engine lammps"), 3, {"behind a wall"});
  EXPECT_FALSE(fs::exists(file("run") + "/macro.h5"));
}

TEST_F(MacroLammps, ADivergedRelaxationIsNotUsable) {
  (void)fake_lammps("echo '0 0' >diverged.txt");
  expect(macro("run", "--engine lammps"), 3, {"relaxation diverged at strain 0.0"});
  EXPECT_EQ(summary("run")["status"], "not usable");
  EXPECT_FALSE(fs::exists(file("run") + "/macro.h5"));
}

TEST_F(MacroLammps, AChildThatCannotBeStartedIsTrouble) {
  (void)fake_lammps("");
  std::ofstream(file("substitute")) << "#!/nowhere/interpreter\n";
  expect(macro("run", "--engine lammps"), 4, {"cannot be started"});
}

/// The rest needs the program itself.
class WithLammps : public MacroLammps {
 protected:
  void SetUp() override {
    if (!fs::exists(beside_the_program()))
      GTEST_SKIP() << "softgrain-lammps was not built (./softgrain setup --with-lammps): " << beside_the_program();
  }

  void expect_close(const std::string& a, const std::string& b, double relative) const {
    const MacroCurve one = curve(a);
    const MacroCurve two = curve(b);
    ASSERT_EQ(one.strain, two.strain);
    for (std::size_t k = 0; k < one.strain.size(); ++k) {
      EXPECT_NEAR(one.stress_axial[k] / two.stress_axial[k], 1.0, relative) << k;
      EXPECT_NEAR(one.stress_lateral[k] / two.stress_lateral[k], 1.0, relative) << k;
      EXPECT_NEAR(one.stress_axial_contacts[k] / two.stress_axial_contacts[k], 1.0, relative) << k;
      EXPECT_NEAR(one.fabric[k], two.fabric[k], relative) << k;
      EXPECT_EQ(one.coordination[k], two.coordination[k]) << k;
      EXPECT_EQ(one.coordination_bodies[k], two.coordination_bodies[k]) << k;
      // Contacts below their threshold count when a list holds them, and lists differ.
      EXPECT_NEAR(one.law_evaluations[k], two.law_evaluations[k], 5.0) << k;
      EXPECT_NEAR(one.law_largest[k], two.law_largest[k], relative) << k;
    }
    ASSERT_EQ(one.body_forces.size(), two.body_forces.size());
    for (std::size_t k = 0; k < one.body_forces.size(); ++k)
      EXPECT_NEAR(one.body_forces[k], two.body_forces[k], relative * one.stress_axial.back() * 1e-3) << k;
  }
};

TEST_F(WithLammps, AgreesWithOurOwnEngineOnOneAndTwoRanks) {
  for (const char* test : {"oedometric", "isotropic", "shear"}) {
    const bool shear = std::string(test) == "shear";
    const std::string settings = fmt::format("--set macro.test={}", test) +
                                 (shear ? " --set macro.preload=0.01 --set macro.preload_steps=2" : "");
    expect(macro("own", settings), 0, {});
    expect(macro("one", settings + " --engine lammps"), 0, {});
    expect(macro("two", settings + " --engine lammps --ranks 2"), 0, {});
    expect_close("own", "one", 1e-6);
    expect_close("own", "two", 1e-6);
    EXPECT_EQ(summary("two")["engine"]["name"], "lammps");
    EXPECT_EQ(summary("two")["engine"]["ranks"], 2);
    EXPECT_NE(summary("two")["engine"]["lammps"], "");
    EXPECT_GT(curve("two").cost.contact_evaluations, 0);
  }
}

/// The first points agree to rounding: that the affine move carries springs along shows here first.
TEST_F(WithLammps, FirstPointsAgreeToRounding) {
  const std::string settings =
      "--set macro.steps=20 --set macro.strain=0.002 --set macro.mu=0.5 --set macro.wall_mu=0.5 ";
  expect(macro("own", settings), 0, {});
  expect(macro("one", settings + "--engine lammps"), 0, {});
  const MacroCurve own = curve("own");
  const MacroCurve one = curve("one");
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(one.stress_x[k] / own.stress_x[k], 1.0, 1e-10) << k;
    EXPECT_NEAR(one.stress_axial[k] / own.stress_axial[k], 1.0, 1e-10) << k;
    EXPECT_NEAR(one.residual[k] / own.residual[k], 1.0, 1e-4) << k;
  }
}

TEST_F(WithLammps, StatesForTheReportAreThere) {
  expect(macro("own", ""), 0, {});
  expect(macro("one", "--engine lammps"), 0, {});
  const auto states = [&](const std::string& name) {
    return read_snapshot_list(open_snapshots(file(name) + "/states_macro.h5"));
  };
  const auto own = states("own");
  const auto one = states("one");
  ASSERT_EQ(own.size(), one.size());
  for (std::size_t k = 0; k < own.size(); ++k) {
    EXPECT_EQ(own[k].frame, one[k].frame);
    EXPECT_EQ(own[k].label, one[k].label);
    ASSERT_EQ(own[k].contacts.size(), one[k].contacts.size());
    for (std::size_t c = 0; c < own[k].contacts.size(); ++c) {
      EXPECT_EQ(own[k].contacts[c].j, one[k].contacts[c].j);
      EXPECT_LT(norm(own[k].contacts[c].force - one[k].contacts[c].force), 1e-5 * norm(own[k].contacts[c].force));
      EXPECT_LT(norm(own[k].contacts[c].to - one[k].contacts[c].to), 1e-3 * own[k].particles[0].radius);
    }
  }
  EXPECT_NE(read_text(file("one") + "/report.html").find("LAMMPS"), std::string::npos);
  EXPECT_EQ(read_text(file("own") + "/report.html").find("LAMMPS"), std::string::npos);
}

TEST_F(WithLammps, PreparesScenesItself) {
  expect(macro("own", ""), 0, {});
  expect(macro("prep", "--engine lammps --set macro.preparation=lammps"), 0, {});
  const MacroCurve own = curve("own");
  const MacroCurve prep = curve("prep");
  EXPECT_NEAR(prep.solid_fraction, own.solid_fraction, 0.03);
  // The same way from the same places, in sums of another order: thirty bodies end in other packings.
  EXPECT_NEAR(prep.stress_axial.back() / own.stress_axial.back(), 1.0, 0.2);
  EXPECT_TRUE(fs::exists(file("prep/macro_initial.h5")));
}

constexpr const char* kStages = R"([[stage]]
kind = "consolidation"
stress = "4 kPa"
steps = 2
[[stage]]
kind = "triaxial"
strain = 0.01
[[stage]]
kind = "unload"
strain = 0.002
steps = 2
[[stage]]
kind = "reload"
steps = 2
[[stage]]
kind = "isotropic"
stress = "6 kPa"
steps = 1
[[stage]]
kind = "hold"
[[stage]]
kind = "oedometric"
stress = "9 kPa"
steps = 2
)";

/// Strain and stress per axis, in walls and in a periodic cell, on one rank and two.
class Staged : public WithLammps {
 protected:
  void scene(const std::string& boundary, const std::string& stages, const std::string& keys = "") const {
    const std::string head =
        "kind = \"macro\"\nlaw = \"law.toml\"\n[macro]\nbodies = 100\nsteps = 3\n"
        "start_pressure = 3e-3\ntolerance = 1e-4\nresolved = false\nboundary = \"";
    write_text_atomic(file("scene.toml"), head + boundary + "\"\n" + keys + stages);
  }
};

TEST_F(Staged, AgreesWithOurOwnEngineOnOneAndTwoRanks) {
  for (const std::string boundary : {"walls", "periodic"}) {
    scene(boundary, kStages, boundary == "walls" ? "mu = 0.0\n" : "");
    expect(macro("own", ""), 0, {});
    const MacroCurve own = curve("own");
    for (const char* ranks : {"1", "2"}) {
      expect(macro("other", std::string("--engine lammps --ranks ") + ranks), 0, {});
      const MacroCurve other = curve("other");
      EXPECT_EQ(own.stages, other.stages);
      EXPECT_EQ(own.stage, other.stage);
      EXPECT_EQ(own.boundary, other.boundary);
      ASSERT_EQ(own.strain.size(), other.strain.size());
      for (std::size_t k = 0; k < own.strain.size(); ++k) {
        EXPECT_NEAR(own.strain_x[k], other.strain_x[k], 2e-5) << boundary << ", " << k;
        EXPECT_NEAR(own.strain_z[k], other.strain_z[k], 2e-5) << boundary << ", " << k;
        EXPECT_NEAR(own.stress_x[k] / other.stress_x[k], 1.0, 2e-3) << boundary << ", " << k;
        EXPECT_NEAR(own.stress_axial[k] / other.stress_axial[k], 1.0, 2e-3) << boundary << ", " << k;
        EXPECT_NEAR(own.stress_axial_contacts[k] / other.stress_axial_contacts[k], 1.0, 2e-3) << k;
      }
    }
  }
}

/// In the middle of any stage: what a stage began at is known again.
TEST_F(Staged, GoesOnAfterAStop) {
  scene("periodic", kStages);
  const std::string more = "--engine lammps ";
  expect(macro("whole", more), 0, {});
  const MacroCurve whole = curve("whole");
  for (const int points : {2, 5, 9, 12}) {
    fs::remove_all(file("stopped"));
    // As a run leaves it that ends after so many points.
    expect(macro("stopped", more + "--write-only"), 0, {});
    fs::remove(file("stopped/summary.json"));
    const std::string run = fmt::format(
        "cd '{}' && sed -e 's/^next point$/if \"${{point}} == {}\" then quit\\nnext point/' "
        "scene.in > short.in && '{}' -in short.in > short.log 2>&1",
        file("stopped/lammps-0"), points, beside_the_program());
    ASSERT_EQ(std::system(run.c_str()), 0) << run;
    ASSERT_EQ(lammps::count_points(file("stopped/lammps-0")), points + 1);
    const std::string by_hand = fmt::format("cd '{}' && '{}' -in scene.in -var from {} > hand.log 2>&1",
                                            file("stopped/lammps-0"), beside_the_program(), points);
    EXPECT_NE(std::system(by_hand.c_str()), 0) << points;
    EXPECT_NE(read_text(file("stopped/lammps-0/hand.log")).find("give -var begin"), std::string::npos) << points;
    expect(macro("stopped", more + "--resume"), 0, {});
    const MacroCurve resumed = curve("stopped");
    ASSERT_EQ(whole.strain.size(), resumed.strain.size());
    for (std::size_t k = 0; k < whole.strain.size(); ++k) {
      EXPECT_NEAR(resumed.stress_axial[k] / whole.stress_axial[k], 1.0, 1e-4) << points << ", " << k;
      EXPECT_NEAR(resumed.strain_x[k], whole.strain_x[k], 1e-6) << points << ", " << k;
    }
  }
}

TEST_F(Staged, AStressThatCannotBeReachedEndsTheTest) {
  for (const std::string boundary : {"walls", "periodic"}) {
    scene(boundary,
          "[[stage]]\nkind = \"consolidation\"\nstress = 2000\nsteps = 1\n[[stage]]\nkind = \"triaxial\"\nstress = "
          "\"20 kPa\"\n[[stage]]\nkind = \"hold\"\n",
          "max_passes = 3000\n");
    for (const char* engine : {"softgrain", "lammps"}) {
      const std::string bodies = boundary == "periodic" ? " --set macro.bodies=250" : "";
      expect(macro(engine, std::string("--engine ") + engine + bodies), 3,
             {"stage 'triaxial' ended at axial strain", "Pa asked"});
      EXPECT_FALSE(curve(engine).usable);
      EXPECT_LT(curve(engine).strain.size(), 7U) << boundary;
      EXPECT_GE(curve(engine).strain.size(), 3U) << boundary;
    }
  }
}

TEST_F(Staged, LammpsCompactsPeriodicCells) {
  scene("periodic", "");
  expect(macro("own", ""), 0, {});
  expect(macro("prep", "--engine lammps --set macro.preparation=lammps"), 0, {});
  EXPECT_NEAR(curve("prep").solid_fraction, curve("own").solid_fraction, 0.03);
  EXPECT_NEAR(curve("prep").stress_axial.back() / curve("own").stress_axial.back(), 1.0, 0.2);
}

/// What stands in a run that was stopped is what a run without stop has.
TEST_F(WithLammps, GoesOnAfterAStop) {
  const std::string settings = "--set macro.bodies=300 --set macro.steps=12 ";
  const std::string more = settings + "--engine lammps";
  expect(macro("whole", more), 0, {});
  for (const int signal : {SIGINT, SIGKILL}) {
    const pid_t child =
        start_program({"macrosim", file("scene.toml"), "--quiet", "--threads", "1", "--out", file("stopped"), "--set",
                       "macro.bodies=300", "--set", "macro.steps=12", "--engine", "lammps"});
    const int status = signal_when(
        child, [&] { return lammps::count_points(file("stopped/lammps-0")) >= 4; }, signal);
    if (signal == SIGINT) {
      EXPECT_TRUE(ended_with(status, 130));
    }
    ::usleep(300'000);  // the end of a killed program reaches its child a little later
    EXPECT_FALSE(fs::exists(file("stopped/macro.h5")));
    EXPECT_LT(lammps::count_points(file("stopped/lammps-0")), 13);
    expect(macro("stopped", more + " --resume"), 0, {});
    const MacroCurve whole = curve("whole");
    const MacroCurve resumed = curve("stopped");
    ASSERT_EQ(whole.strain, resumed.strain);
    for (std::size_t k = 0; k < whole.strain.size(); ++k)
      EXPECT_NEAR(resumed.stress_axial[k] / whole.stress_axial[k], 1.0, 1e-5) << k;
    fs::remove_all(file("stopped"));
  }
}

TEST_F(WithLammps, WhatWasRunElsewhereIsReadWithResume) {
  expect(macro("run", "--engine lammps --write-only"), 0, {});
  const std::string line =
      "cd '" + file("run/lammps-0") + "' && '" + beside_the_program() + "' -in scene.in -log none >lammps.log";
  ASSERT_EQ(std::system(line.c_str()), 0);
  const std::string rows = read_text(file("run/lammps-0/points.txt"));
  expect(macro("run", "--engine lammps"), 2, {"4 recorded points", "--resume"});
  (void)fake_lammps("exit 1");  // nothing is run again
  expect(macro("run", "--engine lammps --resume"), 0, {});
  EXPECT_EQ(read_text(file("run/lammps-0/points.txt")), rows);
  EXPECT_EQ(curve("run").strain.size(), 4U);
  // Another seed: these are not its points.
  expect(macro("run", "--engine lammps --resume --seed 99"), 2, {"another scene"});
}

/// Bodies are followed relative to the box there; LAMMPS by itself makes a list whenever one has moved at all.
TEST_F(WithLammps, ACompactionMissesNoPair) {
  const auto first_row = [&](const std::string& run) {
    std::istringstream in(read_text(file(run) + "/lammps-0/compaction.txt"));
    std::string head;
    std::getline(in, head);
    std::vector<double> row(7);
    for (double& x : row) in >> x;
    return row;
  };
  for (const std::string run : {"relative", "absolute"}) {
    expect(macro(run,
                 "--engine lammps --write-only --set macro.preparation=lammps --set macro.bodies=200 --set "
                 "macro.start_pressure=1e-4"),
           0, {});
    const std::string script = file(run) + "/lammps-0/scene.in";
    std::string text = read_text(script);
    const auto replace = [&](const std::string& one, const std::string& other) {
      const std::size_t at = text.find(one);
      ASSERT_NE(at, std::string::npos) << one;
      text.replace(at, one.size(), other);
    };
    if (run == "absolute") {
      replace(" log_lists yes", "");
      replace("every 1000000 check no", "every 1 check yes");
    }
    replace("next round", "quit 0\nnext round");
    write_text_atomic(script, text);
    const std::string line =
        "cd '" + file(run) + "/lammps-0' && '" + beside_the_program() + "' -in scene.in -log none >lammps.log";
    ASSERT_EQ(std::system(line.c_str()), 0);
  }
  const std::vector<double> relative = first_row("relative");
  const std::vector<double> absolute = first_row("absolute");
  EXPECT_EQ(relative[5], absolute[5]);
  EXPECT_GT(relative[5], 100.0);
  EXPECT_NEAR(relative[3] / absolute[3], 1.0, 1e-9);
  EXPECT_NEAR(relative[4] / absolute[4], 1.0, 1e-7);
}

TEST_F(WithLammps, DamagedTablesAreRefused) {
  expect(macro("run", "--engine lammps"), 0, {});
  const std::string path = file("run/lammps-0/points.txt");
  std::string text = read_text(path);
  const std::size_t digit = text.rfind("\n2 ") + 30;
  text[digit] = text[digit] == '1' ? '2' : '1';
  write_text_atomic(path, text);
  expect(macro("run", "--engine lammps --resume"), 4, {"differs from its copy"});
}

TEST_F(WithLammps, RunsThatAreNotUsableSaySoAsWithOurOwnEngine) {
  const std::string capped = "--set macro.max_passes=10 ";
  expect(macro("own", capped), 3, {"relaxation capped"});
  expect(macro("one", capped + "--engine lammps"), 3, {"relaxation capped"});
  EXPECT_EQ(curve("own").strain.size(), curve("one").strain.size());
  std::string text = kScene;
  text.insert(text.find("[macro]"), "beyond = \"error\"\n");
  write_text_atomic(file("scene.toml"), text);
  const std::string far = "--set macro.strain=0.45 --set macro.steps=9 ";
  expect(macro("own", far), 3, {"which the law does not allow"});
  expect(macro("one", far + "--engine lammps"), 3, {"which the law does not allow"});
  EXPECT_EQ(curve("own").strain, curve("one").strain);
  EXPECT_EQ(curve("own").note, curve("one").note);
}

}  // namespace
