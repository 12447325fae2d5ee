// [[stage]] of macro scenes: what every kind of stage makes of its keys, and what is refused.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "common/core/error.h"
#include "common/io/scene.h"
#include "macrosim/curve_notes.h"
#include "macrosim/test_protocol.h"
#include "pipelines/kinds/macro/stages.h"

namespace {

using namespace softgrain;

MacroSpec read(const std::string& stages, const std::string& macro = "", Boundary boundary = Boundary::periodic) {
  const Scene scene = Scene::parse("[macro]\n" + macro + "\n" + stages, "scene.toml");
  return scene.read([boundary](const SceneTable& root) {
    const SceneTable table = root.table("macro");
    MacroSpec spec;
    spec.steps = 7;
    spec.boundary = boundary;
    for (const char* key : {"test", "strain", "preload", "preload_steps"}) (void)table.has(key);
    read_stages(root, table, spec, true);
    return spec;
  });
}

MacroStage one(const std::string& keys) { return read("[[stage]]\n" + keys).stages.at(0); }

void expect_axis(const AxisDrive& axis, bool by_stress, double value, std::int64_t as_at = -1) {
  EXPECT_EQ(axis.by_stress, by_stress);
  EXPECT_DOUBLE_EQ(axis.value, value);
  EXPECT_EQ(axis.as_at, as_at);
}

TEST(Stages, EveryKindDrivesItsAxes) {
  const MacroStage oedometric = one("kind = \"oedometric\"\nstrain = 0.1");
  expect_axis(oedometric.axis[0], false, 0.0);
  expect_axis(oedometric.axis[2], false, 0.1);
  EXPECT_EQ(oedometric.steps, 7);
  EXPECT_EQ(oedometric.record.name, "oedometric");
  expect_axis(one("kind = \"oedometric\"\nstress = \"2 kPa\"").axis[2], true, 2000.0);
  const MacroStage isotropic = one("kind = \"isotropic\"\nstress = 500");
  for (const AxisDrive& axis : isotropic.axis) expect_axis(axis, true, 500.0);
  EXPECT_TRUE(isotropic.isotropic);
  const MacroStage shear = one("kind = \"shear\"\nstrain = 0.02\nsteps = 3");
  expect_axis(shear.axis[0], false, -0.02);
  expect_axis(shear.axis[1], false, 0.0);
  expect_axis(shear.axis[2], false, 0.02);
  EXPECT_TRUE(shear.logarithmic);
  EXPECT_EQ(shear.steps, 3);
  const MacroStage triaxial = one("kind = \"triaxial\"\nstrain = 0.05");
  expect_axis(triaxial.axis[0], true, 0.0, 0);
  expect_axis(triaxial.axis[2], false, 0.05);
  expect_axis(one("kind = \"triaxial\"\nstrain = 0.05\nlateral_stress = 300").axis[1], true, 300.0);
  const MacroStage consolidation = one("kind = \"consolidation\"\nstress = [100, 200, 300]");
  for (int k = 0; k < 3; ++k) expect_axis(consolidation.axis[static_cast<std::size_t>(k)], true, 100.0 * (k + 1));
  EXPECT_FALSE(consolidation.isotropic);
  const MacroStage axes = one("kind = \"axes\"\nstrain_x = -0.01\nstress_z = \"1 kPa\"");
  expect_axis(axes.axis[0], false, -0.01);
  expect_axis(axes.axis[1], false, 0.0);
  expect_axis(axes.axis[2], true, 1000.0);
}

TEST(Stages, NamedPathsOfShear) {
  const MacroStage undrained = one("kind = \"undrained\"\nstrain = 0.04");
  expect_axis(undrained.axis[0], false, -0.02);
  expect_axis(undrained.axis[1], false, -0.02);
  expect_axis(undrained.axis[2], false, 0.04);
  EXPECT_TRUE(undrained.logarithmic);
  const MacroStage simple = one("kind = \"simple-shear\"\nstrain = 0.04");
  for (const AxisDrive& axis : simple.axis) expect_axis(axis, false, 0.0);
  EXPECT_EQ(simple.shear, 0.04);
  EXPECT_DOUBLE_EQ(shear_increment(simple), 0.04 / 14.0);
  const MacroStage direct = one("kind = \"direct-shear\"\nstrain = 0.04");
  expect_axis(direct.axis[0], false, 0.0);
  expect_axis(direct.axis[2], true, 0.0, 0);
  EXPECT_EQ(direct.shear, 0.04);
  expect_axis(one("kind = \"direct-shear\"\nstrain = 0.04\nnormal_stress = \"1 kPa\"").axis[2], true, 1000.0);
}

TEST(Stages, SlidingGoesBackAndForth) {
  const auto s = read(
                     "[[stage]]\nkind = \"direct-shear\"\nstrain = -0.04\n[[stage]]\nkind = \"unload\"\nstrain = 0.01\n"
                     "[[stage]]\nkind = \"reload\"\n[[stage]]\nkind = \"cycles\"\ncount = 1\nstrain = 0.02")
                     .stages;
  ASSERT_EQ(s.size(), 5U);
  EXPECT_EQ(s[1].shear, 0.01);
  EXPECT_EQ(s[2].shear, -0.01);
  EXPECT_EQ(s[3].shear, 0.02);
  EXPECT_EQ(s[4].shear, -0.02);
  for (std::size_t k = 0; k < 5; ++k) expect_axis(s[k].axis[2], true, 0.0, static_cast<std::int64_t>(k));
}

TEST(Stages, SlidingIsRefusedWhereItCannotBe) {
  const auto message = [](const std::string& keys, Boundary boundary = Boundary::periodic) {
    try {
      (void)read("[[stage]]\n" + keys, "", boundary);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect(message("kind = \"direct-shear\"\nstrain = 0.04", Boundary::walls), "needs boundary = \"periodic\"");
  expect(message("kind = \"simple-shear\"\nstrain = 0.04", Boundary::walls), "needs boundary = \"periodic\"");
  expect(message("kind = \"direct-shear\"\nstress = 100"), "normal_stress is the stress along z");
  expect(message("kind = \"undrained\"\nstress = 100"), "goes by strain");
  expect(message("kind = \"simple-shear\"\nstrain = 0.1\nnormal_stress = 5"), "goes with kind = \"direct-shear\"");
  EXPECT_EQ(message("kind = \"undrained\"\nstrain = 0.04", Boundary::walls), "");
}

TEST(Stages, UnloadingGoesTheWayBackAndReloadingForth) {
  const MacroSpec spec = read(
      "[[stage]]\nkind = \"triaxial\"\nstrain = 0.05\n[[stage]]\nkind = \"unload\"\nstrain = 0.01\n"
      "[[stage]]\nkind = \"hold\"\n[[stage]]\nkind = \"reload\"\n"
      "[[stage]]\nkind = \"unload\"\nstress = 50\n[[stage]]\nkind = \"reload\"");
  ASSERT_EQ(spec.stages.size(), 6U);
  EXPECT_EQ(spec.test, MacroTest::stages);
  const auto& s = spec.stages;
  expect_axis(s[1].axis[2], false, -0.01);
  expect_axis(s[1].axis[0], true, 0.0, 1);
  EXPECT_EQ(s[1].record.way, StageKind::triaxial);
  expect_axis(s[2].axis[2], false, 0.0);
  EXPECT_EQ(s[2].steps, 1);
  EXPECT_DOUBLE_EQ(s[2].tolerance, 0.1 * spec.tolerance);
  EXPECT_NEAR((1.0 - s[1].axis[2].value) * (1.0 - s[3].axis[2].value), 1.0, 1e-15) << "back to the same length";
  expect_axis(s[3].axis[0], true, 0.0, 3);
  expect_axis(s[4].axis[2], true, 50.0);
  expect_axis(s[5].axis[2], true, 50.0, 4);  // as it was when the unloading began
  expect_axis(s[5].axis[0], true, 0.0, 5);
  EXPECT_EQ(s[4].record.name, "unload 2");
  EXPECT_EQ(recorded_points(spec), 1 + 7 + 7 + 1 + 7 + 7 + 7);
}

/// After a stage that lengthens the box, back is to shorten it.
TEST(Stages, BackIsTheOtherWayThanTheStageBefore) {
  for (const std::string kind : {"oedometric", "triaxial", "isotropic", "shear"}) {
    const std::string load = "[[stage]]\nkind = \"" + kind + "\"\nstrain = -0.02\n";
    const auto s = read(load + "[[stage]]\nkind = \"unload\"\nstrain = 0.01\n[[stage]]\nkind = \"reload\"\n" +
                        "[[stage]]\nkind = \"reload\"\nstrain = 0.005\n")
                       .stages;
    EXPECT_DOUBLE_EQ(s.at(1).axis[2].value, 0.01) << kind;
    EXPECT_LT(s.at(2).axis[2].value, 0.0) << kind;
    EXPECT_DOUBLE_EQ(s.at(3).axis[2].value, -0.005) << kind;
    const auto c = read(load + "[[stage]]\nkind = \"cycles\"\ncount = 2\nstrain = 0.01\n").stages;
    for (std::size_t k = 1; k < 5; ++k) EXPECT_EQ(c.at(k).axis[2].value > 0.0, k % 2 == 1) << kind << k;
  }
}

/// By stress too.
TEST(Stages, BackByStressIsUpAfterAStageThatLengthens) {
  const auto curve_of = [](double target) {
    const MacroSpec spec = read(
        "[[stage]]\nkind = \"oedometric\"\nstrain = -0.1\nsteps = 1\n[[stage]]\nsteps = 1\nkind = \"unload\"\n"
        "stress = " +
        std::to_string(target));
    MacroCurve c;
    c.strain = {0.0, -0.1, -0.09};
    c.stress_x = c.stress_y = {50.0, 10.0, 10.0};
    c.stress_axial = {50.0, 20.0, target};
    note_stages(c, spec);
    return c;
  };
  EXPECT_TRUE(curve_of(30.0).usable);
  EXPECT_FALSE(curve_of(5.0).usable);
}

/// A stage that holds hardly more than what stresses are met to.
TEST(Stages, SidesThatBeginWithNextToNoStressAreSaid) {
  const auto note_at = [](double sides) {
    const MacroSpec spec = read("[[stage]]\nkind = \"triaxial\"\nstrain = 0.1\nsteps = 1\n");
    EXPECT_NEAR(stress_tolerance(spec.stages[0]) * least_stress(spec), 1e-2 / 3.0 * 5.0, 1e-12);
    MacroCurve c;
    c.strain = {0.0, 0.1};
    c.stress_x = c.stress_y = {sides, sides};
    c.stress_axial = {1.0, 20.0};
    note_stages(c, spec);
    return c.note;
  };
  EXPECT_NE(note_at(0.0).find("its sides are free"), std::string::npos) << note_at(0.0);
  EXPECT_NE(note_at(0.08).find("began with 0.08 Pa along x, 0.08 Pa along y, which it holds to 0.0167 Pa at best"),
            std::string::npos)
      << note_at(0.08);
  EXPECT_EQ(note_at(1.0), "");
}

/// A test that goes by stress alone is changed as one by strain is.
TEST(Stages, ASlightChangeReachesStresses) {
  const MacroSpec spec = read(
      "[[stage]]\nkind = \"consolidation\"\nstress = [100, 200, 300]\n[[stage]]\nkind = \"triaxial\"\nstrain = 0.05\n");
  const MacroSpec changed = slightly_changed(spec);
  for (std::size_t k = 0; k < 3; ++k) {
    const double value = spec.stages[0].axis[k].value;
    EXPECT_NE(changed.stages[0].axis[k].value, value);
    EXPECT_NEAR(changed.stages[0].axis[k].value, value, 1e-11 * value);
  }
  EXPECT_NE(changed.stages[1].axis[2].value, spec.stages[1].axis[2].value);
  expect_axis(changed.stages[1].axis[0], true, 0.0, 1);
}

TEST(Stages, CyclesAreUnloadingsAndReloadings) {
  const MacroSpec spec = read(
      "[[stage]]\nkind = \"shear\"\nstrain = 0.05\n[[stage]]\nkind = \"cycles\"\ncount = 3\nstrain = 0.01\nsteps = 2");
  ASSERT_EQ(spec.stages.size(), 7U);
  for (std::size_t k = 1; k < 7; ++k) {
    const double sign = k % 2 == 1 ? -1.0 : 1.0;
    expect_axis(spec.stages[k].axis[2], false, sign * 0.01);
    expect_axis(spec.stages[k].axis[0], false, -sign * 0.01);
    EXPECT_EQ(spec.stages[k].record.kind, k % 2 == 1 ? StageKind::unload : StageKind::reload);
    EXPECT_EQ(spec.stages[k].record.way, StageKind::shear);
  }
  EXPECT_EQ(spec.stages[3].record.name, "cycle 2 unload");
}

/// Results of stages are known by their names: no two are alike.
TEST(Stages, NamesAreUnlike) {
  const auto names = [](const std::string& stages) {
    std::vector<std::string> out;
    for (const MacroStage& s : read(stages).stages) out.push_back(s.record.name);
    return out;
  };
  const std::string load = "[[stage]]\nkind = \"oedometric\"\nstrain = 0.1\n";
  const std::string cycles = "[[stage]]\nkind = \"cycles\"\ncount = 1\nstrain = 0.01\n";
  const std::vector<std::string> counted{"oedometric",     "cycle 1 unload", "cycle 1 reload", "cycle 2 unload",
                                         "cycle 2 reload", "small 1 unload", "small 1 reload"};
  EXPECT_EQ(names(load + cycles + cycles + cycles + "name = \"small\"\n"), counted);
  const std::vector<std::string> apart{"cycle 1 reload", "cycle 2 unload", "cycle 2 reload"};
  EXPECT_EQ(names(load + "name = \"cycle 1 reload\"\n" + cycles), apart);
  const std::vector<std::string> numbered{"oedometric 3", "oedometric 2", "oedometric 4"};
  EXPECT_EQ(names(load + "name = \"oedometric 3\"\n" + load + load), numbered);
}

/// "5 MPa" on grains with E = "70", whose GPa is missing.
TEST(Stages, StressesAboveEAreRefused) {
  const auto refusal = [](const std::string& keys) -> std::string {
    try {
      (void)one(keys);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const double modulus = MacroSpec{}.youngs_modulus;
  const auto in_moduli = [&](double factor) { return std::to_string(factor * modulus); };
  EXPECT_EQ(refusal("kind = \"oedometric\"\nstress = " + in_moduli(1.0)), "");
  const std::string high = refusal("kind = \"oedometric\"\nstress = " + in_moduli(3.0));
  EXPECT_NE(high.find("is 3 times E = "), std::string::npos) << high;
  EXPECT_NE(high.find("is a unit missing"), std::string::npos) << high;
  const std::string sides = "kind = \"triaxial\"\nstrain = 0.1\nlateral_stress = ";
  EXPECT_EQ(refusal(sides + in_moduli(0.5)), "");
  EXPECT_NE(refusal(sides + in_moduli(2.0)).find("lateral_stress"), std::string::npos);
  EXPECT_NE(refusal("kind = \"axes\"\nstress_y = " + in_moduli(2.0)).find("stress_y"), std::string::npos);
  // Of a cycle it is the unloading that goes to a stress.
  const std::string cycles = "kind = \"oedometric\"\nstrain = 0.05\n[[stage]]\nkind = \"cycles\"\ncount = 2\nstress = ";
  EXPECT_EQ(refusal(cycles + in_moduli(0.5)), "");
  EXPECT_NE(refusal(cycles + in_moduli(2.0)).find("is 2 times E"), std::string::npos);
}

/// Where a stage begins is known only in the run if the one before it goes by strain.
TEST(Stages, AnUnloadingThatLoadsIsNotUsable) {
  const auto curve_of = [](const std::string& back, double ends) {
    const MacroSpec spec =
        read("[[stage]]\nkind = \"oedometric\"\nstrain = 0.1\nsteps = 1\n[[stage]]\nsteps = 1\n" + back);
    MacroCurve c;
    c.strain = {0.0, 0.1, 0.11};
    c.stress_x = c.stress_y = {0.0, 10.0, 10.0};
    c.stress_axial = {0.0, 20.0, ends};
    note_stages(c, spec);
    return c;
  };
  EXPECT_TRUE(curve_of("kind = \"unload\"\nstress = 5", 5.0).usable);
  EXPECT_TRUE(curve_of("kind = \"unload\"\nstrain = 0.01", 5.0).usable);
  EXPECT_TRUE(curve_of("kind = \"oedometric\"\nstress = 5", 5.0).usable);
  EXPECT_TRUE(curve_of("kind = \"reload\"\nstress = 60", 60.0).usable);
  EXPECT_FALSE(curve_of("kind = \"reload\"\nstress = 5", 5.0).usable);
  const MacroCurve loaded = curve_of("kind = \"unload\"\nstress = 60", 60.0);
  EXPECT_FALSE(loaded.usable);
  EXPECT_NE(loaded.note.find("stage 'unload' goes from 20 Pa to 60 Pa: it loads"), std::string::npos) << loaded.note;
}

TEST(Stages, WithoutAnyTheTestIsThatOfTheTable) { EXPECT_EQ(read("", "strain = 0.1").test, MacroTest::oedometric); }

TEST(Stages, WhatContradictsIsNamed) {
  const std::string load = "[[stage]]\nkind = \"oedometric\"\nstrain = 0.1\n";
  const std::string axes = "[[stage]]\nkind = \"axes\"\nstrain_x = 0.01\n";
  const std::string stress = "[[stage]]\nkind = \"oedometric\"\nstress = 20\n";
  const auto stage = [](const std::string& keys) { return "[[stage]]\n" + keys; };
  const std::vector<std::pair<std::string, std::string>> cases{
      {stage("kind = \"oedometric\""), "give strain or stress"},
      {stage("kind = \"oedometric\"\nstrain = 0.1\nstress = 5"), "contradicts strain"},
      {stage("kind = \"oedometric\"\nstrain = 0.7"), "0.5"},
      {stage("kind = \"oedometric\"\nstrain = 0"), "must not be 0"},
      {stage("kind = \"oedometric\"\nstress = -5"), "above 0"},
      {stage("kind = \"oedometric\"\nstrain = 0.1\nlateral_stress = 5"), "goes with kind = \"triaxial\""},
      {stage("kind = \"oedometrik\"\nstrain = 0.1"), "oedometric"},
      {stage("kind = \"shear\"\nstress = 5"), "goes by strain"},
      {stage("kind = \"consolidation\"\nstrain = 0.1\nstress = 5"), "goes to a stress"},
      {stage("kind = \"consolidation\"\nstress = [1, 2, 0]"), "cannot be pulled"},
      {stage("kind = \"unload\"\nstrain = 0.1"), "no stage before it"},
      {stage("kind = \"axes\""), "no axis is driven"},
      {stage("kind = \"axes\"\nstrain_x = 0.1\nstress_x = 5"), "contradicts strain_x"},
      {load + stage("kind = \"reload\""), "nothing was unloaded before"},
      {stage("kind = \"consolidation\"\nstress = 100\n") + stage("kind = \"reload\"\nstress = 200\nstrain = 0.1"),
       "goes to a stress"},
      {load + stage("kind = \"unload\"\nstrain = -0.01"), "must be from 1e-09"},
      {load + stage("kind = \"hold\"\nstrain = 0.1"), "nothing is driven"},
      {load + stage("kind = \"hold\"\nby = \"weight\""), "stress"},
      {load + stage("kind = \"cycles\"\nstrain = 0.1"), "count"},
      {axes + stage("kind = \"unload\"\nstrain = 0.01"), "another stage of that kind"},
      {load + stage("kind = \"unload\"\nstrain = 0.01\ncount = 3"), "goes with kind = \"cycles\""},
      {load + stage("kind = \"unload\"\nstrain = 0.01\nstepps = 3"), "steps"},
      {load + "name = \"a\"\n" + load + "name = \"a\"\n", "a stage before it is called 'a' too"},
      {load + stage("kind = \"cycles\"\ncount = 1\nstrain = 0.01\nname = \"a\\nb\""), "one line of text"},
      {stress + stage("kind = \"unload\"\nstress = 60"), "must be below the 20 Pa of stage 'oedometric'"},
      {stage("kind = \"oedometric\"\nstress = \"1 MPa\"\n") + stage("kind = \"unload\"\nstress = \"2 MPa\""),
       "must be below the 1 MPa of stage 'oedometric'"},
      {stress + stage("kind = \"hold\"\n") + stage("kind = \"reload\"\nstress = 10"), "must be above the 20 Pa"},
  };
  for (const auto& [text, expected] : cases) {
    try {
      (void)read(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << text << "\n" << e.what();
      EXPECT_NE(std::string(e.what()).find("scene.toml:"), std::string::npos) << e.what();
    }
  }
  EXPECT_THROW((void)read(load, "test = \"shear\""), InputError);
  EXPECT_THROW((void)read(load, "strain = 0.1"), InputError);
}

/// Increments of a stage take the box to its nominal strain, and stresses go a straight way.
TEST(Stages, IncrementsComeToTheEnd) {
  MacroStage stage = one("kind = \"oedometric\"\nstrain = 0.2\nsteps = 4\nincrements_per_step = 3");
  double length = 1.0;
  for (std::int64_t n = 1; n <= 12; ++n) length *= 1.0 - strain_increment(stage, n)[2];
  EXPECT_NEAR(length, 0.8, 1e-15);
  stage = one("kind = \"consolidation\"\nstress = [100, 200, 300]\nsteps = 5\nincrements_per_step = 2");
  const std::vector<Vec3> starts{{{0.0, 50.0, 500.0}}};
  EXPECT_EQ(stress_at(stage, 5, starts), (Vec3{{50.0, 125.0, 400.0}}));
  EXPECT_EQ(stress_at(stage, 10, starts), (Vec3{{100.0, 200.0, 300.0}}));
}

TEST(Stages, SayBetweenWhichStressesTheirModulusIs) {
  const std::string two = "modulus_stress = [\"1 kPa\", \"2 kPa\"]";
  const std::array<double, 2> expected{1000.0, 2000.0};
  EXPECT_EQ(one("kind = \"oedometric\"\nstrain = 0.1\n" + two).record.modulus_stress, expected);
  EXPECT_EQ(one("kind = \"oedometric\"\nstrain = 0.1").record.modulus_stress, (std::array<double, 2>{}));
  const MacroSpec cycles = read(
      "[[stage]]\nkind = \"oedometric\"\nstrain = 0.1\n[[stage]]\nkind = \"cycles\"\ncount "
      "= 1\nstrain = 0.01\n" +
      two);
  for (const std::size_t k : {1U, 2U}) EXPECT_EQ(cycles.stages.at(k).record.modulus_stress, expected) << k;
  for (const char* wrong : {"modulus_stress = [2e3, 1e3]", "modulus_stress = [1e3]", "modulus_stress = [-1.0, 1e3]"})
    EXPECT_THROW((void)one(std::string("kind = \"oedometric\"\nstrain = 0.1\n") + wrong), InputError) << wrong;
  EXPECT_THROW((void)read("[[stage]]\nkind = \"oedometric\"\nstrain = 0.1\n[[stage]]\nkind = \"hold\"\n" + two),
               InputError);
}

}  // namespace
