// Curves in stages beside each other: points meet where the same has been driven as far, and what a test imposes does
// not count.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "common/core/vec.h"
#include "common/data/macro_band.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/macro_scores.h"
#include "pipelines/compare/stage_match.h"

namespace softgrain {
namespace {

/// Of a test that consolidates to 300 Pa, compresses by `strain` with held sides and unloads a tenth of it; `stiff`
/// times as stiff as another one, the unloading `back` times.
MacroCurve stepped(const std::string& engine, int steps, double stiff, double back, double strain = 0.04) {
  MacroCurve c;
  c.engine = engine;
  c.test = MacroTest::stages;
  using K = StageKind;
  c.stages = {{"press", K::consolidation, K::consolidation, {}, std::array{true, true, true}},
              {"shear", K::triaxial, K::triaxial, {}, std::array{true, true, false}},
              {"back", K::unload, K::triaxial, {}, std::array{true, true, false}}};
  const auto add = [&](double stage, double side, double axial, const Vec3& strains) {
    c.stage.push_back(stage);
    c.stress_x.push_back(side);
    c.stress_y.push_back(side);
    c.stress_lateral.push_back(side);
    c.stress_axial.push_back(axial);
    c.stress_deviator.push_back(axial - side);
    c.strain_x.push_back(strains[0]);
    c.strain_y.push_back(strains[1]);
    c.strain_z.push_back(strains[2]);
    c.strain.push_back(strains[2]);
  };
  add(0, 5.0, 5.0, {});
  const double pressed = 0.03 / stiff;
  for (int k = 1; k <= steps; ++k) {
    const double way = static_cast<double>(k) / steps;
    const double stress = 5.0 + way * 295.0;
    add(0, stress, stress, {{way * pressed, way * pressed, way * pressed}});
  }
  const auto loaded = [&](double e) { return 300.0 + stiff * 1e4 * e; };
  const auto length = [&](double e) { return 1.0 - (1.0 - pressed) * (1.0 - e); };
  for (int k = 1; k <= steps; ++k) {
    const double e = strain * k / steps;
    add(1, 300.0, loaded(e), {{pressed - 0.3 * e, pressed - 0.3 * e, length(e)}});
  }
  for (int k = 1; k <= steps; ++k) {
    const double e = strain - 0.1 * strain * k / steps;
    add(2, 300.0, loaded(strain) - back * 3e4 * (strain - e), {{pressed - 0.3 * e, pressed - 0.3 * e, length(e)}});
  }
  return c;
}

/// One test in three and in six points is one test; points meet where the same has been driven as far.
TEST(StageResults, StepsPlayNoPartInAComparison) {
  const Comparison same = compare_curves({stepped("law", 3, 1.0, 1.0)}, {stepped("shelled", 6, 1.0, 1.0)});
  EXPECT_LT(same.axial_difference.mean, 1e-9);
  EXPECT_LT(same.deviator_difference.mean, 1e-9);
  EXPECT_LT(same.strain_difference.mean, 1e-9);
  EXPECT_LT(same.lateral_difference.n == 0 ? 0.0 : same.lateral_difference.mean, 1e-9);
  EXPECT_NEAR(same.axial_end_ratio.mean, 1.0, 1e-9);
  for (const int steps : {2, 5, 7}) {
    const Comparison c = compare_curves({stepped("law", steps, 1.1, 1.0)}, {stepped("shelled", 6, 1.0, 1.0)});
    const Comparison d = compare_curves({stepped("law", 6, 1.1, 1.0)}, {stepped("shelled", 6, 1.0, 1.0)});
    EXPECT_NEAR(c.deviator_difference.mean, d.deviator_difference.mean, 0.003) << steps;
    EXPECT_NEAR(c.strain_difference.mean, d.strain_difference.mean, 1e-6) << steps;
  }
  // Another extent of the same stage: where both have been.
  const MacroCurve longer = stepped("law", 4, 1.0, 1.0, 0.08);
  const MacroCurve shorter = stepped("shelled", 3, 1.0, 1.0, 0.04);
  const auto stages = match_stages(longer, shorter);
  ASSERT_EQ(stages.size(), 3U);
  EXPECT_NEAR(common_part(stages[1])[1], 1.0, 1e-9);
  StageSquares squares;
  squares.add(stages[1], longer.stress_axial, shorter.stress_axial);
  EXPECT_LT(squares.relative(), 1e-9);
}

/// What the test imposes is the same on both sides, and says nothing: it does not count, in norms or in bands.
TEST(StageResults, WhatTheTestImposesDoesNotCount) {
  const MacroCurve twin = stepped("shelled", 4, 1.0, 1.0);
  MacroCurve law = stepped("law", 4, 1.1, 0.72);
  const Comparison c = compare_curves({law}, {twin});
  EXPECT_NEAR(c.deviator_difference.mean, 0.15, 0.02);  // a tenth as it loads, a quarter where it has unloaded
  EXPECT_NEAR(c.unloading_ratio.mean, 0.72, 1e-6);
  EXPECT_GT(c.strain_difference.mean, 0.05);
  EXPECT_EQ(c.lateral_difference.n, 0U) << "the sides are held throughout";
  EXPECT_TRUE(c.samples[0].axial_imposed);
  const auto said = headline_of(c);
  ASSERT_EQ(said.size(), 4U);
  EXPECT_EQ(said[0].what, "deviator");
  EXPECT_EQ(said[2].value.mean, c.unloading_ratio.mean);
  EXPECT_EQ(said[3].what, "axial stress where it is not given");
  // A band that holds what was imposed and nothing else holds nothing.
  set_band(law, BandOf::axial, BandPart::all, {law.stress_axial, law.stress_axial});
  EXPECT_EQ(share_in_band(law, twin, false), 0.0);
  // All by stress: there is no axial stress to be off.
  MacroCurve pressed = law;
  for (StageRecord& s : pressed.stages) s.by_stress = {true, true, true};
  MacroCurve other = twin;
  other.stages = pressed.stages;
  const Comparison given = compare_curves({pressed}, {other});
  EXPECT_EQ(given.axial_difference.n, 0U);
  EXPECT_EQ(given.axial_end_ratio.n, 0U);
  EXPECT_TRUE(given.undefined.empty());
  EXPECT_EQ(headline_of(given).front().what, "strain along axes that go by stress");
  const auto scores = score_engines({pressed, other});
  EXPECT_EQ(scores[0].shelled.axial.n, 0U);
  EXPECT_EQ(scores[0].shelled.strains.n, 1U);
  EXPECT_TRUE(std::isnan(share_in_band(pressed, other, false)));
}

/// Files of earlier versions do not say what goes by stress; a stage of another drive is another stage.
TEST(StageResults, WhatAStageHoldsIsKnownOrFollowsFromItsKind) {
  StageRecord triaxial{"a", StageKind::triaxial, StageKind::triaxial};
  EXPECT_EQ(stress_axes(triaxial), (std::array{true, true, false}));
  EXPECT_EQ(stress_axes({"a", StageKind::unload, StageKind::triaxial}), (std::array{true, true, false}));
  EXPECT_EQ(stress_axes({"a", StageKind::consolidation, StageKind::consolidation}), (std::array{true, true, true}));
  EXPECT_EQ(stress_axes({"a", StageKind::oedometric, StageKind::oedometric}), (std::array{false, false, false}));
  StageRecord by_stress = triaxial;
  by_stress.by_stress = {true, true, true};
  EXPECT_EQ(triaxial, by_stress);
  StageRecord by_strain = triaxial;
  by_strain.by_stress = {true, true, false};
  EXPECT_NE(by_stress, by_strain);
}

/// Strain goes forth and back: curves that do not say their stages meet point by point, and differ in strain.
TEST(StageResults, StagesAreComparedPointByPoint) {
  MacroCurve twin;
  twin.engine = "shelled";
  twin.test = MacroTest::stages;
  twin.strain = {0.0, 0.02, 0.01, 0.02};
  twin.stress_axial = {0.0, 200.0, 100.0, 200.0};
  twin.stress_lateral = {0.0, 100.0, 100.0, 100.0};
  MacroCurve law = twin;
  law.engine = "law";
  for (double& s : law.stress_axial) s *= 1.1;
  for (double& e : law.strain) e *= 0.95;
  const Comparison c = compare_curves({law}, {twin});
  EXPECT_NEAR(c.axial_difference.mean, 0.1, 1e-12);
  EXPECT_NEAR(c.lateral_difference.mean, 0.0, 1e-12);
  EXPECT_NEAR(c.strain_difference.mean, 0.05, 1e-12);
}

}  // namespace
}  // namespace softgrain
