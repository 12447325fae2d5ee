// Materials in LAMMPS: the curve that our own engine has, on any number of ranks, with the springs of the preparation
// and who bears what. Runs are skipped where softgrain-lammps was not built.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "macrosim/body_contacts.h"
#include "macrosim/lammps_run/points_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

/// Pressed so far that it bears firmly: where a loose packing comes apart, what is left of its stress is chance.
constexpr const char* kMaterial = R"(kind = "material"
[grains]
count = 300
ratio = 4
[packing]
preparation = "fast"
start_pressure = 1e-3
[test]
steps = 2
strain = 0.01
tolerance = 1e-3
[[loading]]
name = "pressed"
[[loading]]
name = "sheared"
test = "shear"
preload = 0.02
preload_steps = 2
)";

class MaterialLammps : public ::testing::Test {
 protected:
  MaterialLammps() { write_text_atomic(file("scene.toml"), kMaterial); }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  [[nodiscard]] ProgramOutcome run(const std::string& name, const std::string& more) const {
    return run_the_program("run '" + file("scene.toml") + "' --quiet --threads 1 --out '" + file(name) + "' " + more);
  }
  [[nodiscard]] MacroCurve curve(const std::string& name, const std::string& loading) const {
    return load_macro(file(name) + "/material_" + loading + ".h5").at(0);
  }
  static void need_lammps() {
    const std::string program = fs::path(SOFTGRAIN_PROGRAM).parent_path().string() + "/softgrain-lammps";
    if (!fs::exists(program)) GTEST_SKIP() << "softgrain-lammps was not built: " << program;
  }

  void expect_same(const std::string& a, const std::string& b, const std::string& loading) const {
    const MacroCurve one = curve(a, loading);
    const MacroCurve two = curve(b, loading);
    ASSERT_EQ(one.strain.size(), two.strain.size());
    for (std::size_t k = 0; k < one.strain.size(); ++k) {
      EXPECT_NEAR(one.strain_x[k], two.strain_x[k], 1e-12) << loading << ", " << k;
      EXPECT_NEAR(one.strain_z[k], two.strain_z[k], 1e-12) << loading << ", " << k;
      EXPECT_NEAR(one.stress_x[k] / two.stress_x[k], 1.0, 2e-3) << loading << ", " << k;
      EXPECT_NEAR(one.stress_axial[k] / two.stress_axial[k], 1.0, 2e-3) << loading << ", " << k;
      EXPECT_NEAR(one.coordination[k] / two.coordination[k], 1.0, 5e-3) << loading << ", " << k;
    }
    ASSERT_EQ(one.more.size(), 8U);
    for (const auto& [name, values] : one.more) {
      ASSERT_EQ(values.size(), one.strain.size()) << name;
      for (std::size_t k = 0; k < values.size(); ++k)
        EXPECT_NEAR(values[k], two.more.at(name).at(k), name == kSolidFraction ? 1e-12 : 2e-3)
            << loading << ", " << name << ", " << k;
    }
  }

  TemporaryDirectory directory_;
};

TEST_F(MaterialLammps, AgreesWithOurOwnEngineOnOneAndTwoRanks) {
  need_lammps();
  if (IsSkipped()) return;
  ASSERT_EQ(run("own", "").status, 0);
  EXPECT_NEAR(curve("own", "pressed").more.at(kRattlers).at(0), 0.4, 0.3);
  for (const std::string ranks : {"1", "2"}) {
    ASSERT_EQ(run("other", "--engine lammps --ranks " + ranks).status, 0);
    for (const char* loading : {"pressed", "sheared"}) expect_same("own", "other", loading);
  }
  EXPECT_NE(read_text(file("other/summary.json")).find("\"ranks\": 2"), std::string::npos);
}

/// Without friction four contacts hold, and nothing is handed over but places.
TEST_F(MaterialLammps, SmoothGrainsAgreeToo) {
  need_lammps();
  if (IsSkipped()) return;
  const std::string smooth = "--set material.mu=0 --set test.tolerance=1e-4 ";
  ASSERT_EQ(run("own", smooth).status, 0);
  ASSERT_EQ(run("other", smooth + "--engine lammps --ranks 2").status, 0);
  EXPECT_FALSE(fs::exists(file("other/lammps-pressed-0/springs.txt")));
  expect_same("own", "other", "pressed");
}

/// What was run elsewhere is read; a run that broke off goes on after its last point.
TEST_F(MaterialLammps, WritesItsInputAndGoesOn) {
  need_lammps();
  if (IsSkipped()) return;
  ASSERT_EQ(run("whole", "--engine lammps").status, 0);
  ASSERT_EQ(run("parts", "--engine lammps --write-only").status, 0);
  EXPECT_TRUE(fs::exists(file("parts/material_initial.h5")));
  EXPECT_FALSE(fs::exists(file("parts/material_pressed.h5")));
  const std::string line = "cd '" + file("parts/lammps-sheared-0") +
                           "' && sed -e 's/^next point$/if \"${point} == 2\" then quit\\nnext point/' scene.in > "
                           "short.in && '" +
                           fs::path(SOFTGRAIN_PROGRAM).parent_path().string() +
                           "/softgrain-lammps' -in short.in > short.log 2>&1";
  ASSERT_EQ(std::system(line.c_str()), 0) << line;
  ASSERT_EQ(lammps::count_points(file("parts/lammps-sheared-0")), 3);
  const ProgramOutcome anew = run("parts", "--engine lammps");
  EXPECT_EQ(anew.status, 2);
  EXPECT_NE(anew.output.find("3 recorded points"), std::string::npos) << anew.output;
  ASSERT_EQ(run("parts", "--engine lammps --resume").status, 0);
  for (const char* loading : {"pressed", "sheared"}) expect_same("whole", "parts", loading);
}

TEST_F(MaterialLammps, PreparesPackingsItself) {
  const std::string more = "--set packing.preparation=lammps ";
  const ProgramOutcome refused = run("prep", more);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.output.find("needs --engine lammps"), std::string::npos) << refused.output;
  need_lammps();
  if (IsSkipped()) return;
  ASSERT_EQ(run("prep", more + "--engine lammps").status, 0);
  ASSERT_EQ(run("own", "--set packing.preparation=frictionless").status, 0);
  const MacroCurve prepared = curve("prep", "pressed");
  EXPECT_NEAR(prepared.more.at(kSolidFraction).at(0), curve("own", "pressed").more.at(kSolidFraction).at(0), 0.03);
  const double pressure = (prepared.stress_x[0] + prepared.stress_y[0] + prepared.stress_axial[0]) / 3.0;
  EXPECT_GT(pressure / prepared.start.youngs_modulus, 0.9e-3);
  EXPECT_LT(pressure / prepared.start.youngs_modulus, 1.6e-3);
}

/// Materials of one run are told apart by their names.
TEST_F(MaterialLammps, CurvesOfTwoRunsAreCompared) {
  ASSERT_EQ(run("one", "").status, 0);
  ASSERT_EQ(run("two", "--set test.tolerance=2e-3").status, 0);
  const ProgramOutcome both = run_the_program("compare '" + file("one") + "' '" + file("two") + "'");
  EXPECT_EQ(both.status, 0) << both.output;
  for (const char* words : {"macro: pressed against pressed", "macro: sheared against sheared", "axial stress"})
    EXPECT_NE(both.output.find(words), std::string::npos) << words << " not in " << both.output;
  EXPECT_EQ(run_the_program("compare '" + file("one/material_pressed.h5") + "' '" + file("two") + "'").status, 0);
}

TEST_F(MaterialLammps, WriteOnlyPlacesManyGrainsAtOnce) {
  const ProgramOutcome written =
      run("many",
          "--engine lammps --write-only --set packing.preparation=lammps --set grains.count=20000 --set "
          "grains.ratio=30");
  ASSERT_EQ(written.status, 0) << written.output;
  EXPECT_TRUE(fs::exists(file("many/lammps-sheared-0/scene.in")));
  EXPECT_FALSE(fs::exists(file("many/material_initial.h5"))) << "bodies that do not touch are no starting state";
}

}  // namespace
