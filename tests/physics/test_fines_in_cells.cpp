// Cells of fines alone: a fluid without friction, and curves from which the friction of their faces comes back.
#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/face_friction_fit.h"
#include "macrosim/cell_matter/cell_packing.h"
#include "macrosim/cell_matter/face_springs.h"
#include "pipelines/kinds/material_law/fines_in_cells.h"

namespace softgrain {
namespace {

constexpr std::int64_t kCells = 40;
const FinesState kState{StateForm::porosity, 0.057, 2.0, 0.74, 1e-4};

/// As a recorded curve: four steps of one percent, oedometric; or isotropic first, then sheared.
MacroCurve recorded(bool sheared) {
  MacroCurve c;
  const auto add = [&](double x, double y, double z, double stage) {
    c.strain.push_back(z);
    c.strain_x.push_back(1.0 - x);
    c.strain_y.push_back(1.0 - y);
    c.strain_z.push_back(1.0 - z);
    c.stage.push_back(stage);
  };
  add(1.0, 1.0, 1.0, 0.0);
  if (sheared) add(0.98, 0.98, 0.98, 0.0);
  for (int k = 1; k <= 4; ++k) {
    const double e = std::exp(0.01 * k);
    if (sheared)
      add(0.98 * e, 0.98, 0.98 / e, 1.0);
    else
      add(1.0, 1.0, 1.0 - 0.01 * k, 0.0);
  }
  return c;
}

std::vector<FinesPath> both_paths() {
  return {path_of(recorded(false), FinesMeasure::lateral_ratio), path_of(recorded(true), FinesMeasure::stress_ratio)};
}

TEST(FinesInCells, PathsAreThoseOfTheCurve) {
  const std::vector<FinesPath> paths = both_paths();
  EXPECT_EQ(paths[0].compared, 4U);
  EXPECT_EQ(paths[1].compared, 4U);
  EXPECT_EQ(paths[0].length.size(), 5U);
  EXPECT_EQ(paths[1].length.size(), 6U);
  EXPECT_NEAR(paths[1].length[5][0], 0.98 * std::exp(0.04), 1e-12);
  MacroCurve longer = recorded(false);
  for (int k = 5; k <= 32; ++k) {
    longer.strain.push_back(0.01 * k);
    longer.strain_x.push_back(0.0);
    longer.strain_y.push_back(0.0);
    longer.strain_z.push_back(0.01 * k);
    longer.stage.push_back(0.0);
  }
  const FinesPath thinned = path_of(longer, FinesMeasure::lateral_ratio);
  EXPECT_EQ(thinned.compared, 8U);
  EXPECT_EQ(thinned.points.front(), 0U);
  EXPECT_EQ(thinned.points.back(), 32U);
}

TEST(FinesInCells, WithoutFrictionTheyAreAFluid) {
  const MacroPacking sites = pack_sites(kCells, 1);
  for (const StateForm form : {StateForm::porosity, StateForm::pores}) {
    FinesState state = kState;
    state.form = form;
    const std::vector<double> lateral = strain_fines(sites, state, FaceFriction{0.0, 1.0}, both_paths()[0]);
    ASSERT_EQ(lateral.size(), 4U);
    for (const double ratio : lateral) EXPECT_NEAR(ratio, 1.0, 2e-3);
    const std::vector<double> sheared = strain_fines(sites, state, FaceFriction{0.0, 1.0}, both_paths()[1]);
    for (const double ratio : sheared) EXPECT_LT(ratio, 2e-3);
  }
}

TEST(FinesInCells, BeyondTheirPoresTheyGiveNoCurve) {
  FinesPath crushed = both_paths()[0];
  crushed.length.back() = {{1.0, 1.0, 0.3}};
  EXPECT_TRUE(strain_fines(pack_sites(kCells, 1), kState, FaceFriction{0.5, 1.0}, crushed).empty());
}

constexpr FaceFrictionTrial kTruth{0.45, 1.1};

/// Friction that is fitted on sites of seed 1 to curves of the law itself on those of `seed`.
FaceFrictionFit fitted_to_sites_of(std::uint64_t seed) {
  const std::vector<FinesPath> paths = both_paths();
  const FaceFrictionData data{strain_fines(pack_sites(kCells, seed), kState, {kTruth}, paths),
                              std::vector<double>(8, 0.25)};
  const MacroPacking sites = pack_sites(kCells, 1);
  return fit_face_friction(
      [&](const std::vector<FaceFrictionTrial>& trials) { return strain_fines(sites, kState, trials, paths); }, data);
}

TEST(FinesInCells, FrictionComesBackFromTheLawsOwnCurves) {
  const FaceFrictionFit fit = fitted_to_sites_of(1);
  ASSERT_TRUE(fit.usable) << fit.message;
  EXPECT_NEAR(fit.friction.value / kTruth.friction, 1.0, 0.01);
  EXPECT_NEAR(fit.stiffness.value / kTruth.stiffness, 1.0, 0.01);
  EXPECT_LT(fit.deviation, 0.002);
}

/// As well as so few cells agree.
TEST(SlowFinesInCells, FrictionComesBackFromOtherSites) {
  const FaceFrictionFit fit = fitted_to_sites_of(2);
  ASSERT_TRUE(fit.usable) << fit.message;
  EXPECT_NEAR(fit.friction.value / kTruth.friction, 1.0, 0.08);
  EXPECT_NEAR(fit.stiffness.value / kTruth.stiffness, 1.0, 0.15);
  EXPECT_GT(std::abs(fit.friction.value / kTruth.friction - 1.0), 1e-4);
}

}  // namespace
}  // namespace softgrain
