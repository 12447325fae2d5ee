// Oblique impacts at thirteen angles: Chung and Ooi test 4.
#include <numbers>

#include "tests/verification/cases/oblique_cases.h"
#include "tests/verification/cases/scene_text.h"
#include "tests/verification/the_program.h"

namespace {

using namespace softgrain;
using namespace softgrain::verification;

TEST(VerifiedOblique, ThirteenAnglesFromFiveDegrees) {
  ASSERT_EQ(digitised_restitution().size(), 13U);
  ASSERT_EQ(digitised_rebound_angle().size(), 13U);
  EXPECT_LT(digitised_restitution().front()[0], 5.5);
  EXPECT_GT(digitised_restitution().back()[0], 84.5);
}

TEST(VerifiedOblique, WholeCurveWithinWhatOthersAccept) {
  // Of the two Mindlin forms; a linear spring is another law below 30 degrees.
  for (const auto option : {TangentialOption::mindlin, TangentialOption::rescaled}) {
    const ObliqueErrors e = oblique_errors(option, 0.0);
    EXPECT_LT(e.restitution, kAcceptedByOthers.restitution) << name_of(option);
    EXPECT_LT(e.rebound_angle, kAcceptedByOthers.rebound_angle) << name_of(option);
  }
}

TEST(VerifiedOblique, EveryTangentialLawBeyondThirtyDegrees) {
  for (const auto option : kTangentialOptions) {
    const ObliqueErrors e = oblique_errors(option, 30.0);
    EXPECT_LT(e.restitution, 0.004) << name_of(option);
    EXPECT_LT(e.rebound_angle, 0.005) << name_of(option);
    for (const auto& row : digitised_restitution())
      if (row[0] > 30.0) {
        EXPECT_NEAR(run_oblique(row[0], option).tangential_restitution / row[1], 1.0, 0.005) << row[0];
      }
    for (const auto& row : digitised_rebound_angle())
      if (row[0] > 29.0) {
        EXPECT_NEAR(run_oblique(row[0], option).rebound_angle, row[1], 0.4) << row[0];
      }
  }
}

TEST(VerifiedOblique, SlidingAllTheTimeFollowsTheImpulse) {
  for (const auto option : kTangentialOptions)
    for (double angle = 35.0; angle < 90.0; angle += 5.0) {
      const ObliqueOutcome here = run_oblique(angle, option);
      const ObliqueOutcome exact = sliding_all_the_time(angle);
      EXPECT_NEAR(here.tangential_restitution / exact.tangential_restitution, 1.0, 3e-5) << angle << name_of(option);
      // The force acts half an overlap below the surface: the spin is smaller by that share of the radius.
      EXPECT_NEAR(here.spin / exact.spin, 1.0, 2e-3) << angle << name_of(option);
      EXPECT_LT(here.spin, exact.spin) << angle << name_of(option);
    }
}

TEST(VerifiedOblique, NoAngleGainsEnergy) {
  for (const auto option : kTangentialOptions)
    for (double angle = 2.5; angle < 90.0; angle += 2.5)
      EXPECT_LT(run_oblique(angle, option).energy_ratio, 1.0) << angle << name_of(option);
}

TEST(VerifiedOblique, TheProgram) {
  const std::string text = oblique_scene(20.0, TangentialOption::rescaled);
  expect_same_end(run_by_program(text), run_text(text));
  // The file of the published case, with its own step.
  const double angle = 45.0 * std::numbers::pi / 180.0;
  const double vx = 3.9 * std::sin(angle);
  const auto summary = run_file_by_program(
      "oblique_impact",
      "--set 'particle.0.velocity=" + digits(Vec3{{vx, 0.0, -3.9 * std::cos(angle)}}) + "' --set time.end='60 us'");
  ASSERT_EQ(summary["contacts"].size(), 1U);
  EXPECT_NEAR(summary["particles"][0]["velocity"][0].get<double>() / vx,
              sliding_all_the_time(45.0).tangential_restitution, 3e-5);
}

}  // namespace
