// Restitution that comes back out of a scene, over restitution, size ratio, speed and where in a step the contact
// begins.
#include "tests/verification/cases/restitution_cases.h"
#include "tests/verification/the_program.h"

namespace {

using namespace softgrain;
using namespace softgrain::verification;

/// Largest error over size ratios, speeds and phases.
double largest_error(NormalLaw law, double e, double steps_per_impact) {
  double largest = 0.0;
  for (const double ratio : {0.0, 1.0, 3.0, 100.0})
    for (const double speed : {0.01, 10.0})
      for (const double phase : {0.1, 0.5, 0.9})
        largest =
            std::max(largest, std::abs(recovered_restitution({law, e, ratio, speed, phase, steps_per_impact}) - e));
  return largest;
}

TEST(VerifiedRestitution, HertzWithTheDampingOfTsuji) {
  for (const double e : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9})
    EXPECT_LT(largest_error(NormalLaw::hertz, e, 400.0), 4e-4) << e;
  EXPECT_LT(largest_error(NormalLaw::hertz, 1.0, 400.0), 1e-6);
}

TEST(VerifiedRestitution, LinearSpringWhoseDashpotSetsInAtOnce) {
  for (const double e : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9})
    EXPECT_LT(largest_error(NormalLaw::linear, e, 400.0), 2e-3) << e;
  EXPECT_LT(largest_error(NormalLaw::linear, 1.0, 400.0), 1e-6);
}

TEST(VerifiedRestitution, ErrorsFallWithTheStep) {
  for (const NormalLaw law : {NormalLaw::hertz, NormalLaw::linear})
    EXPECT_GT(largest_error(law, 0.5, 100.0) / largest_error(law, 0.5, 1600.0), 10.0);
}

TEST(VerifiedRestitution, TheProgram) {
  const RestitutionCase which{NormalLaw::hertz, 0.6, 3.0, 2.0};
  const auto summary = run_by_program(restitution_scene(which));
  expect_same_end(summary, run_text(restitution_scene(which)));
  const auto speed = [&](std::size_t i) { return summary["particles"][i]["velocity"][0].get<double>(); };
  EXPECT_NEAR((speed(1) - speed(0)) / 2.0, 0.6, 4e-4);
}

}  // namespace
