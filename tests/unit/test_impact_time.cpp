// Impact times of contact laws, which bound the time step, against impacts that are integrated.
#include <gtest/gtest.h>

#include <cmath>

#include "common/contact/law_set.h"

namespace {

using namespace softgrain;

const PairBodies kBodies{0.01, 0.02, 1.0 / 0.3, 1.0 / 0.5};

/// Time from touch to release of an undamped central impact, by leapfrog with the elastic force of the law.
template <int D, class Law>
double integrated_impact(const Law& law, double speed) {
  const double dt = law.impact_time(kBodies, speed) / 20000.0;
  ContactState<D> state;
  state.constants = law.pair_constants(kBodies);
  double overlap = 0.0;
  double time = 0.0;
  while (overlap >= 0.0) {
    state.overlap = overlap + 0.5 * dt * speed;
    speed -= dt * law.evaluate(state).elastic_force / kBodies.effective_mass();
    overlap = state.overlap + 0.5 * dt * speed;
    time += dt;
  }
  return time;
}

TEST(ImpactTime, OfHertzIsThatOfAnIntegratedImpactAtAnySpeed) {
  const HertzMindlin<Tangential::none, false> law{{.inverse_d = 3e7}};
  for (const double speed : {0.01, 1.0}) {
    EXPECT_NEAR(integrated_impact<3>(law, speed) / law.impact_time(kBodies, speed), 1.0, 1e-3);
  }
  EXPECT_NEAR(law.impact_time(kBodies, 0.01) / law.impact_time(kBodies, 1.0), std::pow(100.0, 0.2), 1e-12);
}

TEST(ImpactTime, OfHertzHasTheFactorOfTheClosedForm) {
  const HertzMindlin<Tangential::none, false> law{{.inverse_d = 1.0}};
  const PairBodies one{2.0, 2.0, 0.5, 0.5};  // effective radius and mass 1
  EXPECT_DOUBLE_EQ(law.impact_time(one, 1.0), 0.8 * std::beta(0.4, 0.5) * std::pow(1.25, 0.4));
}

TEST(ImpactTime, OfSpringsIsHalfAPeriodAtAnySpeed) {
  const LinearSpring spring{.normal = 5e4};
  EXPECT_NEAR(integrated_impact<3>(spring, 0.3) / spring.impact_time(kBodies, 0.3), 1.0, 1e-3);
  const CohesiveDisk<false, false> disk{.normal = 5e4};
  EXPECT_NEAR(integrated_impact<2>(disk, 0.3) / disk.impact_time(kBodies, 0.3), 1.0, 1e-3);
}

TEST(ImpactTime, OfFittedLawsSetsNoLimit) {
  EXPECT_TRUE(std::isinf(SoftContact{}.impact_time(kBodies, 1.0)));
  EXPECT_TRUE(std::isinf(SoftMultiContact<LawForm::pair, false>{}.impact_time(kBodies, 1.0)));
}

}  // namespace
