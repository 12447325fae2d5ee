// What goes to LAMMPS and comes back from it: data file, script, tables of points, dumps.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "macrosim/lammps_run/data_file.h"
#include "macrosim/lammps_run/dump_files.h"
#include "macrosim/lammps_run/input_script.h"
#include "macrosim/lammps_run/lammps_curve.h"
#include "macrosim/test_protocol.h"
#include "tests/support/lammps_files.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using test::overwrite;
using test::staged_spec;

/// Two octaves of solid grains, one of soft ones.
MacroPacking small_packing() {
  MacroPacking p{{}, {{1.0, 1.0, 1.0}}, {}};
  p.bodies.push_back({{{0.1 + 0.2, 0.3, 1.0 / 3.0}}, 0.016, false});
  p.bodies.push_back({{{0.7, 0.1, 0.2}}, 0.0081, false});
  p.bodies.push_back({{{0.2, 0.8, 0.9}}, 0.008, false});
  p.bodies.push_back({{{0.5, 0.5, 0.5}}, 0.012, true});
  return p;
}

TEST(LammpsFiles, TypesAreSizeClassesOfSolidAndSoftBodies) {
  const lammps::BodyTypes types = lammps::body_types(small_packing());
  EXPECT_EQ(types.of, (std::vector<std::int32_t>{1, 1, 2, 3}));
  EXPECT_EQ(types.solid_range(), "1*2");
  EXPECT_EQ(types.soft_range(), "3");
  EXPECT_EQ(types.largest, (std::vector<double>{0.016, 0.008, 0.012}));
  MacroPacking solid = small_packing();
  solid.bodies.pop_back();
  EXPECT_EQ(lammps::body_types(solid).soft_range(), "");
}

TEST(LammpsFiles, TheDataFileReadsBackToTheSameBits) {
  const test::TemporaryDirectory directory;
  const MacroPacking packing = small_packing();
  const lammps::BodyTypes types = lammps::body_types(packing);
  lammps::write_data_file(directory.file("bodies.data"), "a title", packing, types, 2500.0, 0.7);
  std::istringstream in(read_text(directory.file("bodies.data")));
  std::string line;
  while (std::getline(in, line) && line != "Atoms # sphere") {
  }
  std::getline(in, line);
  for (std::size_t k = 0; k < packing.bodies.size(); ++k) {
    const MacroBody& b = packing.bodies[k];
    std::size_t id = 0;
    std::int32_t type = 0;
    std::array<double, 5> x{};
    ASSERT_TRUE(in >> id >> type >> x[0] >> x[1] >> x[2] >> x[3] >> x[4]);
    EXPECT_EQ(id, k + 1);
    EXPECT_EQ(type, types.of[k]);
    EXPECT_EQ(0.5 * x[0], b.r);
    EXPECT_EQ(x[1], b.soft ? 2500.0 * 0.7 : 2500.0);
    EXPECT_EQ((Vec3{{x[2], x[3], x[4]}}), b.x);
  }
  EXPECT_FALSE(in >> line);
  EXPECT_FALSE(std::filesystem::exists(directory.file("bodies.data.tmp")));
}

std::string script_of(const MacroSpec& spec) {
  const MacroPacking packing = small_packing();
  return lammps::script_text({spec, packing, lammps::body_types(packing), "a title & $more", "0123456789abcdef", 4});
}

MacroSpec spec_of(MacroTest test, double preload = 0.0, Preparation preparation = Preparation::frictionless) {
  MacroSpec spec;
  spec.test = test;
  spec.preload = preload;
  spec.preparation = preparation;
  return spec;
}

TEST(LammpsFiles, ScriptsAreForPeople) {
  for (const MacroSpec& spec :
       {staged_spec(), spec_of(MacroTest::oedometric), spec_of(MacroTest::isotropic), spec_of(MacroTest::shear),
        spec_of(MacroTest::shear, 0.02), spec_of(MacroTest::undrained), spec_of(MacroTest::undrained, 0.02),
        spec_of(MacroTest::oedometric, 0.0, Preparation::lammps)}) {
    std::istringstream in(script_of(spec));
    for (std::string line; std::getline(in, line);) {
      EXPECT_LE(line.size(), 110U) << line;
      EXPECT_EQ(line.find(" /"), std::string::npos) << "a path: " << line;
    }
  }
}

TEST(LammpsFiles, UndrainedBoxesKeepTheirVolume) {
  for (const double preload : {0.0, 0.02}) {
    const std::string script = script_of(spec_of(MacroTest::undrained, preload));
    const std::string half = "exp(0.5*v_strain_end/(v_steps*v_increments))";
    const auto first = script.find(half);
    ASSERT_NE(first, std::string::npos);
    EXPECT_NE(script.find(half, first + 1), std::string::npos) << "along x and y";
    EXPECT_NE(script.find("exp(-v_strain_end/(v_steps*v_increments))"), std::string::npos);
  }
}

TEST(LammpsFiles, ScriptsSayWhatTheSceneAsksFor) {
  MacroSpec spec = spec_of(MacroTest::oedometric);
  spec.strain_end = 0.123;
  spec.steps = 17;
  spec.max_passes = 4321;
  const std::string text = script_of(spec);
  for (const char* words :
       {"variable strain_end    index 0.123", "variable steps         index 17", "variable max_passes    index 4321",
        "pair_coeff   3 1*2 laws.toml soft-solid", "pair_style   softgrain soft 3",
        "law 1*2 laws.toml solid-wall law 3 laws.toml soft-wall", "0123456789abcdef"})
    EXPECT_NE(text.find(words), std::string::npos) << words << " not in\n" << text;
  EXPECT_EQ(text.find("compaction"), std::string::npos);
  EXPECT_NE(script_of(spec_of(MacroTest::oedometric, 0.0, Preparation::lammps)).find("laws.toml hard"),
            std::string::npos);
}

/// Every label that is jumped to is there, once.
TEST(LammpsFiles, JumpsOfScriptsHaveTheirLabels) {
  for (const MacroSpec& spec : {spec_of(MacroTest::shear, 0.02, Preparation::lammps), staged_spec()}) {
    const std::string text = script_of(spec);
    std::size_t jumps = 0;
    for (std::size_t at = text.find("jump SELF "); at != std::string::npos; at = text.find("jump SELF ", at + 1)) {
      const std::string name = text.substr(at + 10, text.find_first_of("\"\n", at) - at - 10);
      const std::string label = "label " + name + "\n";
      EXPECT_NE(text.find(label), std::string::npos) << name;
      EXPECT_EQ(text.find(label), text.rfind(label)) << name;
      ++jumps;
    }
    EXPECT_GT(jumps, 8U);
  }
}

TEST(LammpsFiles, StagesOfScriptsSayTheirStrainsAndStresses) {
  const std::string text = script_of(staged_spec());
  for (const char* words :
       {"boundary     p p p", "points 1 to 30: consolidation (consolidation)",
        "(1-v_n/v_total)*v_begin1x+v_n/v_total*300", "(1-v_n/v_total)*v_begin2y+v_n/v_total*v_begin2y",
        "(1-0.05*v_n/v_total)/(1-0.05*(v_n-1)/v_total)", "exp(0.01/v_total)", "exp(-0.01/v_total)", "least_stress 5"})
    EXPECT_NE(text.find(words), std::string::npos) << words << " not in\n" << text;
  EXPECT_EQ(text.find("softgrain/wall"), std::string::npos);
  EXPECT_EQ(text.find("f_walls"), std::string::npos);
}

/// What the scene of a material asks for beside: springs of the preparation, columns of grains.
TEST(LammpsFiles, ScriptsOfMaterialsBeginWithSpringsAndRecordGrains) {
  MacroSpec spec = staged_spec();
  spec.splits = {0.5, 0.25};
  MacroPacking packing = small_packing();
  // Between solid grains, of a soft particle, and of either with the third wall; bodies are numbers 0 to 3.
  packing.springs = {{0, 1, {{1e-6, 1.0 / 3.0, -2e-7}}},
                     {1, 3, {{1.0, 1.0, 1.0}}},
                     {2, 6, {{0.5, 0.25, 0.0}}},
                     {3, 6, {{1.0, 1.0, 1.0}}}};
  const auto script = [&] { return lammps::script_text({spec, packing, lammps::body_types(packing), "", "key", 0}); };
  for (const char* words : {"contacts all softgrain/contacts grains 2 0.008 0.004\n",
                            "if \"${from} < 0\" then &\n  \"pair_style   softgrain soft 3 springs springs.txt\"",
                            "$(c_contacts[18]:%.17g)", "$(c_contacts[24]:%.17g)", "rattlers", "fine-fine_0.25"})
    EXPECT_NE(script().find(words), std::string::npos) << words << " not in\n" << script();
  EXPECT_EQ(script().find("c_contacts[25]"), std::string::npos);
  const test::TemporaryDirectory directory;
  const auto springs = [&] {
    lammps::write_springs_file(directory.file("springs.txt"), spec, packing);
    return read_text(directory.file("springs.txt"));
  };
  EXPECT_EQ(springs(), "1 springs\n1 2 1e-06 0.3333333333333333 -2e-07\n") << "those of soft bodies are forgotten";
  spec.wall_friction = 0.2;
  EXPECT_EQ(springs(), "2 springs\n1 2 1e-06 0.3333333333333333 -2e-07\n3 -3 0.5 0.25 0\n");
  packing.springs.front().roll = {{1e-3, 0.0, -2.5}};
  EXPECT_EQ(springs(), "2 springs rolls\n1 2 1e-06 0.3333333333333333 -2e-07 0.001 0 -2.5\n3 -3 0.5 0.25 0 0 0 0\n");
  packing.springs.front().roll = {};
  spec.wall_friction = 0.0;
  spec.friction = 0.0;
  EXPECT_EQ(script().find("springs.txt"), std::string::npos);
  EXPECT_NE(script().find("softgrain/contacts grains 4 "), std::string::npos);
  spec.splits.clear();
  EXPECT_NE(script().find("softgrain/contacts\n"), std::string::npos);
}

TEST(LammpsFiles, PeriodicCellsArePressedWithoutWalls) {
  MacroSpec spec = spec_of(MacroTest::oedometric, 0.0, Preparation::lammps);
  spec.boundary = Boundary::periodic;
  const std::string text = script_of(spec);
  EXPECT_NE(text.find("softgrain/relax stress ${bear} ${bear} ${bear} isotropic yes"), std::string::npos);
  EXPECT_EQ(text.find("walls all"), std::string::npos);
  EXPECT_EQ(text.find("f_walls"), std::string::npos);
}

class Dumps : public ::testing::Test {
 protected:
  [[nodiscard]] std::string write(const std::string& text) const {
    overwrite(directory_.file("dump.txt"), text);
    return directory_.file("dump.txt");
  }
  test::TemporaryDirectory directory_;
};

TEST_F(Dumps, BodiesAreReadAndMistakesRefused) {
  MacroPacking packing = small_packing();
  packing.bodies.resize(2);
  const std::vector<std::string> rows{"1 1 0.016 0.1 0.2 0.3", "2 1 0.0081 0.4 0.5 0.6"};
  const auto bodies = lammps::read_bodies(write(test::dump_text("ATOMS", rows)), packing);
  EXPECT_EQ(bodies.x[1], (Vec3{{0.4, 0.5, 0.6}}));
  EXPECT_EQ(bodies.high, (Vec3{{1.0, 1.0, 1.0}}));
  const auto refused = [&](const std::vector<std::string>& bad) {
    EXPECT_THROW((void)lammps::read_bodies(write(test::dump_text("ATOMS", bad)), packing), IoError);
  };
  refused({rows[0]});
  refused({rows[0], rows[0]});
  refused({rows[0], "2 1 0.0081 0.4 0.5"});
  refused({rows[0], "2 1 0.0082 0.4 0.5 0.6"});
  refused({rows[0], "2 1 0.0081 0.4 nan 0.6"});
  const std::string whole = test::dump_text("ATOMS", rows);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW((void)lammps::read_bodies(write(whole.substr(0, size)), packing), IoError) << size;
}

TEST_F(Dumps, ContactsAreReadAndMustFitTheRowOfTheirPoint) {
  const std::vector<std::string> rows{"2 -6 3 0 0 -3 0 0 -1", "2 1 2 1 0 0 1 0 0"};
  const auto contacts = lammps::read_contacts(write(test::dump_text("ENTRIES", rows)), 2, 2.0, 5.0);
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_EQ(contacts[0].i, 0);
  EXPECT_EQ(contacts[0].j, 1);
  EXPECT_EQ(contacts[0].force, (Vec3{{-1.0, 0.0, 0.0}})) << "on the body of smaller number";
  EXPECT_EQ(contacts[1].j, 7) << "walls follow after the bodies: z high is the sixth";
  EXPECT_EQ(lammps::normal_forces(contacts), (std::vector<double>{2.0, 3.0}));
  const std::string path = write(test::dump_text("ENTRIES", rows));
  EXPECT_THROW((void)lammps::read_contacts(path, 2, 3.0, 5.0), IoError);
  EXPECT_THROW((void)lammps::read_contacts(path, 2, 2.0, 5.1), IoError);
  EXPECT_THROW((void)lammps::read_contacts(path, 1, 2.0, 5.0), IoError);
}

TEST(LammpsFiles, ScriptsWatchEveryIncrement) {
  for (const MacroSpec& spec : {spec_of(MacroTest::oedometric), staged_spec()}) {
    const std::string text = script_of(spec);
    const std::size_t reset = text.find("variable unrest equal 0\n");
    const std::size_t watch = text.find("\"variable unrest equal $(v_residual:%.17g)\"");
    const std::size_t next = text.find("next k\n");
    ASSERT_NE(reset, std::string::npos);
    ASSERT_NE(watch, std::string::npos);
    EXPECT_LT(reset, text.find("label increment\n"));
    EXPECT_LT(text.find("label increment\n"), watch);
    EXPECT_LT(watch, next);
    EXPECT_NE(text.find("$(v_unrest_end:%.17g)"), std::string::npos);
  }
}

/// A script that goes on within stages asks for the stresses at which they began, those that stages to come ask for
/// too. A hold by strain asks for none.
TEST(LammpsFiles, ScriptsGoOnWithinStagesOnlyWithTheirBegins) {
  const std::string text = script_of(staged_spec());
  for (const char* words : {"if \"${from} >= 0 && ${from} < 30 && &\n    $(is_defined(variable,begin1x)*",
                            "if \"${from} >= 30 && ${from} < 60 && &\n    $(is_defined(variable,begin2x)*",
                            "give -var begin2x SX -var begin2y SY -var begin2z SZ, &\n"})
    EXPECT_NE(text.find(words), std::string::npos) << words << " not in\n" << text;
  EXPECT_EQ(text.find("is_defined(variable,begin3x)"), std::string::npos);
  EXPECT_EQ(text.find("variable begin1x       index"), std::string::npos) << "no value stands in for it";
  EXPECT_LT(text.find("is_defined(variable,begin1x)"), text.find("variable point loop"));
  EXPECT_EQ(script_of(spec_of(MacroTest::oedometric)).find("is_defined"), std::string::npos);
}

/// The tolerance of a test in stages is set by stages; -var changes it there alone.
TEST(LammpsFiles, EveryStageHasATolerance) {
  MacroSpec spec = staged_spec();
  spec.stages[1].tolerance = 2e-3;
  const std::string text = script_of(spec);
  EXPECT_NE(text.find("variable tolerance2    index 0.002 "), std::string::npos) << text;
  EXPECT_NE(text.find("variable rest equal v_tolerance2\n"), std::string::npos);
  EXPECT_EQ(text.find("${tolerance}"), std::string::npos);
}

TEST(LammpsLog, NamesTheErrorOrTheLastLines) {
  const test::TemporaryDirectory directory;
  overwrite(directory.file("log"), "before ERROR: old\n");
  const auto begin = std::filesystem::file_size(directory.file("log"));
  EXPECT_EQ(lammps::read_log(directory.file("log"), begin).complaint(), "its log is empty");
  overwrite(directory.file("log"), "before ERROR: old\none\n---\ntwo\n");
  EXPECT_EQ(lammps::read_log(directory.file("log"), begin).complaint(), "its log ends with: one | two");
  overwrite(directory.file("log"), "before ERROR: old\none\nERROR: Lost atoms (thermo.cpp:1)\nmore\n");
  const auto log = lammps::read_log(directory.file("log"), begin);
  EXPECT_EQ(log.complaint(), "ERROR: Lost atoms (thermo.cpp:1)");
  EXPECT_TRUE(log.says("Lost atoms"));
}

}  // namespace
}  // namespace softgrain
