// A bouncing ball, and the energy of two elastic balls between planes.
#include "tests/verification/cases/energy_cases.h"
#include "tests/verification/the_program.h"

namespace {

using namespace softgrain;
using namespace softgrain::verification;

TEST(VerifiedEnergy, BouncesLoseHeightBySquaresOfTheRestitution) {
  const auto here = run_bounces(6);
  const auto exact = bounces_with_weight(6);
  double share = 1.0;
  for (std::size_t n = 0; n < here.size(); ++n) {
    share *= kBounceRestitution;
    // The contact lasts a thousandth of a flight: the weight in it costs as much.
    EXPECT_NEAR(here[n].height / (share * share), 1.0, 0.01) << "bounce " << n + 1;
    EXPECT_NEAR(here[n].duration / share, 1.0, 0.005) << "bounce " << n + 1;
    EXPECT_NEAR(here[n].height / exact[n].height, 1.0, 1e-3) << "bounce " << n + 1;
    EXPECT_NEAR(here[n].duration / exact[n].duration, 1.0, 5e-4) << "bounce " << n + 1;
  }
}

TEST(VerifiedEnergy, EnergyErrorIsFourfoldSmallerAtHalfTheStep) {
  const EnergyCourse coarse = run_pair(PairMotion::pressed, 100, 200);
  const EnergyCourse fine = run_pair(PairMotion::pressed, 200, 200);
  EXPECT_LT(fine.largest, 1e-4);
  EXPECT_NEAR(coarse.rms / fine.rms, 4.0, 0.05);
  EXPECT_NEAR(coarse.largest / fine.largest, 4.0, 0.05);
}

TEST(VerifiedEnergy, NeitherMotionDriftsOverTwoHundredImpacts) {
  const EnergyCourse pressed = run_pair(PairMotion::pressed, 200, 200);
  EXPECT_LT(std::abs(pressed.drift), 3e-7);
  // Contacts that begin anywhere in a step leave an error of either sign.
  const EnergyCourse coarse = run_pair(PairMotion::colliding, 100, 200);
  const EnergyCourse fine = run_pair(PairMotion::colliding, 200, 200);
  EXPECT_LT(fine.largest, 1.5e-4);
  EXPECT_LT(std::abs(fine.drift), 3e-5);
  EXPECT_GT(coarse.rms / fine.rms, 3.5);
}

TEST(SlowVerifiedEnergy, NoDriftOverTenThousandImpacts) {
  EXPECT_LT(std::abs(run_pair(PairMotion::pressed, 200, 10000).drift), 3e-7);
  EXPECT_LT(run_pair(PairMotion::pressed, 200, 10000).largest, 1e-4);
  EXPECT_LT(run_pair(PairMotion::colliding, 200, 10000).largest, 1e-3);
}

TEST(VerifiedEnergy, TheProgram) {
  const auto summary = run_by_program(bounce_scene(1));
  expect_same_end(summary, run_text(bounce_scene(1)));
  // In the flight after the first bounce but one.
  ASSERT_EQ(summary["contacts"].size(), 1U);
  EXPECT_EQ(summary["contacts"][0]["count"], 2);
  const double z = summary["particles"][0]["position"][2].get<double>() - 0.01;
  const double v = summary["particles"][0]["velocity"][2].get<double>();
  EXPECT_NEAR((z + 0.5 * v * v / 9.81) / kDropHeight, bounces_with_weight(2)[1].height, 5e-4);
}

}  // namespace
