// Tests in stages against closed forms of one body between walls and of a periodic lattice: loads, unloads, lateral
// stress that is held, stresses that cannot be reached.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "common/core/error.h"
#include "common/data/measurements.h"
#include "macrosim/compression.h"
#include "macrosim/macro_packing.h"
#include "macrosim/staged_test.h"

namespace softgrain {
namespace {

constexpr double kRadius = 0.016;
constexpr int kPerEdge = 3;

/// What bodies a closed form is tested on.
enum class Bodies { solid_in_box, solid_in_cell, twin_in_box, twin_in_cell };

struct Scene {
  MacroSpec spec;
  MacroPacking packing;
  MacroSystem macro;
  double radius = kRadius;  ///< of the grains that bear
  double contact_radius = kRadius;
  double per_edge = 1.0;

  explicit Scene(Bodies bodies) {
    const bool cell = bodies == Bodies::solid_in_cell || bodies == Bodies::twin_in_cell;
    const bool twin = bodies == Bodies::twin_in_box || bodies == Bodies::twin_in_cell;
    spec.friction = 0.0;
    spec.boundary = cell ? Boundary::periodic : Boundary::walls;
    spec.test = MacroTest::stages;
    spec.force_floor = 1e-9;
    if (cell) spec.twin.relaxation = TwinRelaxation::damped;  // a lattice without friction buckles when it moves
    per_edge = cell ? kPerEdge : 1.0;
    const double spacing = 2.0 * kRadius * (1.0 - 1e-3);
    packing.high = {{per_edge * spacing, per_edge * spacing, per_edge * spacing}};
    for (int k = 0; k < (cell ? 27 : 1); ++k) {
      const Vec3 place{{static_cast<double>(k % 3), static_cast<double>(k / 3 % 3), static_cast<double>(k / 9)}};
      packing.bodies.push_back({(place + Vec3{{0.5, 0.5, 0.5}}) * spacing, kRadius, twin});
    }
    if (twin) {
      radius = 0.9999 * kRadius;
      macro = make_shelled_system(spec, packing, {ShellPacking{0, {Vec3{}}, {0.9999}}}, 1, 0);
    } else {
      macro = make_law_system(spec, packing, pair_soft_laws({}, {}, 0.0), 1.0);
    }
    contact_radius = cell ? 0.5 * radius : radius;
  }

  MacroStage& add(StageKind kind) {
    MacroStage stage;
    stage.record = {to_string(kind), kind, kind};
    stage.steps = 3;
    stage.increments_per_step = 1;
    stage.tolerance = 1e-5;
    spec.stages.push_back(stage);
    return spec.stages.back();
  }

  MacroCurve run() {
    CompressionState state;
    state.macro = std::move(macro);
    state.curve = begin_curve(spec, packing, state.macro, "law", 0);
    compress(state, spec);
    return state.curve;
  }

  /// Stress along an axis when all bodies stand in a row, from the edges of the box.
  [[nodiscard]] double stress_of(const Vec3& size, int axis) const {
    const double spacing = size[axis] / per_edge;
    const double overlap = contact_radius < radius ? 2.0 * radius - spacing : radius - 0.5 * spacing;
    const double modulus = spec.youngs_modulus / (2.0 * (1.0 - spec.poisson_ratio * spec.poisson_ratio));
    const double force = 4.0 / 3.0 * modulus * std::sqrt(contact_radius) * std::pow(std::max(overlap, 0.0), 1.5);
    return force * per_edge * per_edge / (size[(axis + 1) % 3] * size[(axis + 2) % 3]);
  }

  [[nodiscard]] Vec3 size_at(const MacroCurve& c, std::size_t point) const {
    return {{(1.0 - c.strain_x[point]) * c.start.size_x, (1.0 - c.strain_y[point]) * c.start.size_y,
             (1.0 - c.strain_z[point]) * c.start.size_z}};
  }
};

Vec3 stress_at_point(const MacroCurve& c, std::size_t point) {
  return {{c.stress_x[point], c.stress_y[point], c.stress_axial[point]}};
}

void by_stress(MacroStage& stage, const Vec3& stress) {
  for (int k = 0; k < 3; ++k) stage.axis[static_cast<std::size_t>(k)] = {true, stress[k], -1};
}

void hold_sides(MacroStage& stage, std::int64_t number) { stage.axis[0] = stage.axis[1] = {true, 0.0, number}; }

class EveryScene : public testing::TestWithParam<Bodies> {};

/// All ways of driving, forth and back; every recorded point is on the closed form, and what is asked is what is there.
TEST_P(EveryScene, StagesFollowHertz) {
  Scene scene(GetParam());
  by_stress(scene.add(StageKind::consolidation), {{200.0, 300.0, 400.0}});
  MacroStage& triaxial = scene.add(StageKind::triaxial);
  triaxial.axis[2].value = 0.02;
  hold_sides(triaxial, 1);
  MacroStage& unload = scene.add(StageKind::unload);
  unload.axis[2].value = -0.01;
  hold_sides(unload, 2);
  MacroStage& reload = scene.add(StageKind::reload);  // by stress, to where the unloading began
  reload.axis[2] = {true, 0.0, 2};
  hold_sides(reload, 3);
  MacroStage& oedometric = scene.add(StageKind::oedometric);
  oedometric.axis[2] = {true, 6000.0, -1};
  MacroStage& shear = scene.add(StageKind::shear);
  shear.axis[0].value = -0.004;
  shear.axis[2].value = 0.004;
  shear.logarithmic = true;
  const MacroCurve c = scene.run();
  ASSERT_TRUE(c.usable) << c.note;
  ASSERT_EQ(c.strain.size(), 19U);
  for (std::size_t k = 0; k < c.strain.size(); ++k) {
    const Vec3 size = scene.size_at(c, k);
    for (int axis = 0; axis < 3; ++axis) {
      const double expected = scene.stress_of(size, axis);
      EXPECT_NEAR(stress_at_point(c, k)[axis], expected, 1e-4 * expected + 1e-6) << "point " << k << ", " << axis;
    }
    EXPECT_NEAR(c.stress_axial_contacts[k], c.stress_axial[k], 1e-4 * c.stress_axial[k] + 1e-6);
  }
  const auto expect_stress = [&](std::size_t point, const Vec3& asked) {
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(stress_at_point(c, point)[axis], asked[axis], 1e-5 * 6000.0) << point << ", " << axis;
  };
  expect_stress(3, {{200.0, 300.0, 400.0}});
  for (std::size_t point = 4; point <= 12; ++point) {
    EXPECT_NEAR(c.stress_x[point], 200.0, 1e-5 * c.stress_axial[point]);
    EXPECT_NEAR(c.stress_y[point], 300.0, 1e-5 * c.stress_axial[point]);
  }
  EXPECT_NEAR(1.0 - c.strain_z[6], (1.0 - c.strain_z[3]) * 0.98, 1e-12);  // nominal, from the start of the stage
  EXPECT_NEAR(1.0 - c.strain_z[9], (1.0 - c.strain_z[6]) * 1.01, 1e-12);
  EXPECT_NEAR(c.stress_axial[12], c.stress_axial[6], 1e-5 * c.stress_axial[6]);
  EXPECT_NEAR(c.stress_axial[15], 6000.0, 1e-5 * 6000.0);
  EXPECT_EQ(c.strain_x[15], c.strain_x[12]);
  const auto volume = [&](std::size_t point) {
    const Vec3 size = scene.size_at(c, point);
    return size[0] * size[1] * size[2];
  };
  EXPECT_NEAR(volume(18) / volume(15), 1.0, 1e-12);
  EXPECT_NEAR(std::log((1.0 - c.strain_z[18]) / (1.0 - c.strain_z[15])), -0.004, 1e-12);
  const std::vector<double> stages{0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5};
  EXPECT_EQ(c.stage, stages);
}

/// The mean of the stresses goes to the target while all axes strain alike.
TEST_P(EveryScene, AlikeMeansTheSameStrain) {
  Scene scene(GetParam());
  MacroStage& stage = scene.add(StageKind::isotropic);
  by_stress(stage, {{900.0, 900.0, 900.0}});
  stage.isotropic = true;
  const MacroCurve c = scene.run();
  ASSERT_TRUE(c.usable) << c.note;
  for (std::size_t k = 0; k < c.strain.size(); ++k) {
    EXPECT_NEAR(c.strain_x[k], c.strain_z[k], 1e-14);
    EXPECT_NEAR(c.strain_y[k], c.strain_z[k], 1e-14);
  }
  EXPECT_NEAR(c.stress_axial.back(), 900.0, 1e-4 * 900.0);
}

INSTANTIATE_TEST_SUITE_P(MacroStages, EveryScene,
                         testing::Values(Bodies::solid_in_box, Bodies::solid_in_cell, Bodies::twin_in_box,
                                         Bodies::twin_in_cell));

MacroSpec packed_spec(Boundary boundary) {
  MacroSpec spec;
  spec.boundary = boundary;
  spec.bodies = 80;
  spec.soft_share = 0.0;
  spec.test = MacroTest::stages;
  return spec;
}

MacroStage plain_stage(StageKind kind) {
  MacroStage stage;
  stage.record = {to_string(kind), kind, kind};
  stage.steps = 3;
  return stage;
}

MacroCurve run_packed(const MacroSpec& spec) {
  const MacroPacking packing = make_macro_packing(spec, 1, 0);
  CompressionState state;
  state.macro = make_law_system(spec, packing, pair_soft_laws({}, {}, 0.0), 1.0);
  state.curve = begin_curve(spec, packing, state.macro, "law", 0);
  compress(state, spec);
  const std::size_t points = state.curve.strain.size();
  compress(state, spec);  // a test that has ended stays as it is
  EXPECT_EQ(state.curve.strain.size(), points);
  return state.curve;
}

/// A packing with friction carries some three times its lateral stress, not forty times: what was reached is said, and
/// the points before are there.
TEST(MacroStages, AStressThatCannotBeReachedEndsTheTest) {
  for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
    MacroSpec spec = packed_spec(boundary);
    MacroStage consolidation = plain_stage(StageKind::consolidation);
    by_stress(consolidation, {{300.0, 300.0, 300.0}});
    MacroStage triaxial = plain_stage(StageKind::triaxial);
    triaxial.axis[2] = {true, 12000.0, -1};
    hold_sides(triaxial, 1);
    spec.stages = {consolidation, triaxial, plain_stage(StageKind::hold)};
    const MacroCurve c = run_packed(spec);
    EXPECT_FALSE(c.usable);
    ASSERT_GE(c.strain.size(), 5U);
    EXPECT_LT(c.strain.size(), 8U);
    EXPECT_NEAR(c.stress_axial[3], 300.0, 3.0);
    EXPECT_NE(c.note.find("stage 'triaxial' ended at axial strain"), std::string::npos) << c.note;
    EXPECT_NE(c.note.find("Pa asked"), std::string::npos) << c.note;
  }
}

/// Unloading a packing with friction is stiffer than loading it, and gives back less than was put in.
TEST(MacroStages, AFrictionalPackingUnloadsStiffer) {
  for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
    MacroSpec spec = packed_spec(boundary);
    MacroStage load = plain_stage(StageKind::oedometric);
    load.axis[2].value = 0.06;
    load.steps = 6;
    MacroStage unload = plain_stage(StageKind::unload);
    unload.axis[2].value = -0.005;
    spec.stages = {load, unload};
    const MacroCurve c = run_packed(spec);
    ASSERT_TRUE(c.usable) << c.note;
    const auto slope = [&](std::size_t a, std::size_t b) {
      return (c.stress_axial[b] - c.stress_axial[a]) / (c.strain_z[b] - c.strain_z[a]);
    };
    EXPECT_GT(slope(6, 7), 1.1 * slope(5, 6)) << to_string(boundary);
  }
}

/// Nothing touches, and stages that hold what they begin with hold none: they are told apart from an oedometer by what
/// drives them. Sides that are pushed give way, and stay where they are when nothing pushes them.
TEST(MacroStages, SidesThatBeginWithoutStressAreFree) {
  for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
    MacroSpec spec = packed_spec(boundary);
    MacroStage triaxial = plain_stage(StageKind::triaxial);
    triaxial.axis[2].value = 0.1;
    triaxial.increments_per_step = 5;
    hold_sides(triaxial, 0);
    MacroStage hold = plain_stage(StageKind::hold);
    hold.steps = 1;
    for (AxisDrive& drive : hold.axis) drive = {true, 0.0, 1};
    spec.stages = {triaxial, hold};
    MacroPacking packing = make_macro_packing(spec, 1, 0);
    const auto apart = [&](const MacroSpec& of) {
      MacroPacking wide = packing;
      for (MacroBody& b : wide.bodies) b.x = wide.low + (b.x - wide.low) * 1.01;
      wide.high = wide.low + (wide.high - wide.low) * 1.01;
      CompressionState state;
      state.macro = make_law_system(of, wide, pair_soft_laws({}, {}, 0.0), 1.0);
      state.curve = begin_curve(of, wide, state.macro, "law", 0);
      compress(state, of);
      return state.curve;
    };
    const MacroCurve c = apart(spec);
    ASSERT_TRUE(c.usable) << c.note;
    ASSERT_EQ(c.strain.size(), 5U);
    EXPECT_EQ(c.stress_x[0], 0.0);
    const double off = 1.001 * triaxial.tolerance / 3.0 * least_stress(spec);
    for (std::size_t k = 0; k < c.strain.size(); ++k) {
      EXPECT_LE(std::abs(c.stress_x[k]), off) << to_string(boundary) << " " << k;
      EXPECT_LE(std::abs(c.stress_y[k]), off) << to_string(boundary) << " " << k;
    }
    EXPECT_LT(c.strain_x[3], -0.005);
    EXPECT_GT(c.strain_x[3], -0.2) << "the sides flew off";
    EXPECT_NE(c.note.find("stage 'triaxial' began without stress along x, y, which it holds: its sides are free"),
              std::string::npos)
        << c.note;
    MacroSpec oedometric = spec;
    oedometric.stages.resize(1);
    oedometric.stages[0].axis[0] = oedometric.stages[0].axis[1] = {};
    EXPECT_GT(apart(oedometric).stress_x[3], 100.0 * off) << "what it was taken for";
  }
}

/// An engine whose relaxations end as they are told to.
struct ToldEngine {
  std::vector<RelaxationResult>& ends;
  std::vector<bool>& held;  ///< which increments had an axis that goes by stress

  RelaxationResult step(CompressionState&, const MacroStage&, const Vec3&, const std::optional<Vec3>& stress) const {
    const RelaxationResult end = ends.front();
    ends.erase(ends.begin());
    held.push_back(stress.has_value());
    return end;
  }
  static void record(CompressionState& state, const MacroStage& stage, std::int64_t, const RelaxationResult& rest) {
    MacroCurve& c = state.curve;
    c.strain.push_back(0.1 * static_cast<double>(c.strain.size()));
    for (auto* column : {&c.stress_x, &c.stress_y, &c.stress_axial}) column->push_back(0.0);
    c.residual.push_back(rest.residual);
    note_unrest(c, state.worst, stage);
  }
  static LawUse watch(CompressionState&) { return {}; }
  static void note_use(CompressionState&, const LawUse&) {}
  static bool ended(CompressionState&) { return false; }
};

/// All increments count, also those that are not recorded; the worst of the test is the one that is said.
TEST(MacroStages, IncrementsThatDoNotComeToRestAreSaid) {
  constexpr RelaxationEnd kRest = RelaxationEnd::converged;
  constexpr RelaxationEnd kCapped = RelaxationEnd::capped;
  MacroSpec spec;
  spec.steps = 2;
  spec.increments_per_step = 3;
  const auto run = [&](std::vector<RelaxationResult> ends) {
    CompressionState state;
    std::vector<bool> held;
    run_stages(state, spec, ToldEngine{ends, held}, RunControl<CompressionState>{});
    EXPECT_EQ(held, std::vector<bool>(7, false));
    return state.curve;
  };
  const RelaxationResult good{kRest, 10, 0.009};
  const MacroCurve rests = run({good, good, {kRest, 10, 0.0095}, good, good, good, good});
  EXPECT_TRUE(rests.usable);
  EXPECT_EQ(rests.residual_largest, (std::vector<double>{0.009, 0.0095, 0.009}));
  const MacroCurve capped = run({good, good, {kCapped, 10, 0.5}, good, {kCapped, 10, 0.02}, good, good});
  EXPECT_FALSE(capped.usable);
  EXPECT_EQ(capped.residual, (std::vector<double>{0.009, 0.009, 0.009}));
  EXPECT_EQ(capped.residual_largest, (std::vector<double>{0.009, 0.5, 0.02}));
  EXPECT_NE(capped.note.find("capped at strain 0.100000, increment 2 of the 3 before it (residual 0.5"),
            std::string::npos)
      << capped.note;
  EXPECT_THROW((void)run({good, good, {RelaxationEnd::diverged, 10, HUGE_VAL}}), UnusableResult);
}

/// The short forms are stages too: the same bits.
TEST(MacroStages, ShortFormsAreStages) {
  MacroSpec spec = packed_spec(Boundary::walls);
  spec.bodies = 20;
  spec.steps = 3;
  for (const MacroTest test : {MacroTest::oedometric, MacroTest::isotropic, MacroTest::shear}) {
    spec.test = test;
    spec.strain_end = 0.03;
    spec.preload = test == MacroTest::shear ? 0.02 : 0.0;
    const MacroCurve a = run_packed(spec);
    MacroSpec staged = spec;
    staged.stages = stages_of(spec);
    staged.test = MacroTest::stages;
    const MacroCurve b = run_packed(staged);
    EXPECT_EQ(a.stress_axial, b.stress_axial);
    EXPECT_EQ(a.stress_x, b.stress_x);
    EXPECT_EQ(a.stages, b.stages);
  }
}

}  // namespace
}  // namespace softgrain
