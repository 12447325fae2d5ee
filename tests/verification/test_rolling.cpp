// Balls that start to roll, from a push, a spin, or down an incline.
#include "tests/verification/cases/rolling_cases.h"
#include "tests/verification/the_program.h"

namespace {

using namespace softgrain;
using namespace softgrain::verification;

TEST(VerifiedRolling, PushedBallAtEveryFrictionThatWasPublished) {
  const auto published = published_sliding();
  ASSERT_EQ(published.size(), 9U);
  for (const PublishedSliding& p : published)
    for (const RollingLaw law : {RollingLaw::linear, RollingLaw::hertz}) {
      const EndOfSliding end = run_pushed_ball(p.closed_form.mu, law);
      EXPECT_NEAR(end.time / p.closed_form.time, 1.0, 1e-4) << "mu " << end.mu;
      EXPECT_NEAR(end.speed / p.closed_form.speed, 1.0, 1e-5) << "mu " << end.mu;
      EXPECT_NEAR(end.spin / p.closed_form.spin, 1.0, 1e-5) << "mu " << end.mu;
    }
}

TEST(VerifiedRolling, SpunBall) {
  for (const double mu : {0.2, 0.4, 0.6, 0.8, 1.0}) {
    const EndOfSliding end = run_spun_ball(mu);
    EXPECT_NEAR(end.time * 3.5, 1.0, 1e-4) << "mu " << mu;
    EXPECT_NEAR(end.speed * 3.5, 1.0, 1e-5) << "mu " << mu;
    EXPECT_NEAR(end.spin * 3.5, 1.0, 1e-5) << "mu " << mu;
  }
}

TEST(VerifiedRolling, InclineRollsUpToTwoSeventhsOfTheSlope) {
  for (const double angle : {5.0, 20.0, steepest_rolling_angle() - 0.5, steepest_rolling_angle() + 0.5, 50.0, 70.0}) {
    const InclineOutcome here = run_incline(angle);
    const InclineOutcome exact = incline_closed_form(angle);
    EXPECT_NEAR(here.acceleration, exact.acceleration, 5e-6) << angle;
    EXPECT_NEAR(here.surface, exact.surface, 5e-6) << angle;
  }
}

TEST(VerifiedRolling, TheProgram) {
  const auto summary = run_by_program(spun_ball_scene(0.5));
  expect_same_end(summary, run_text(spun_ball_scene(0.5)));
  // Long after sliding has ended the dashpot has stopped what was left on the spring: pure rolling.
  const auto& spun = summary["particles"][0];
  EXPECT_NEAR(spun["velocity"][0].get<double>(), 2.0 / 7.0 * kSpunSpeed, 1e-5 * kSpunSpeed);
  EXPECT_NEAR(spun["spin"][1].get<double>() * kBallRadius, 2.0 / 7.0 * kSpunSpeed, 1e-5 * kSpunSpeed);
  const auto pushed = run_file_by_program("sliding_ball", "--set contact.0.mu=0.5")["particles"][0];
  EXPECT_NEAR(pushed["velocity"][0].get<double>(), 5.0 / 7.0 * 0.1, 1e-6);
  EXPECT_NEAR(pushed["spin"][1].get<double>() * kBallRadius, 5.0 / 7.0 * 0.1, 1e-6);
}

}  // namespace
