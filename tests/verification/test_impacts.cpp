// Elastic normal impacts: Chung and Ooi tests 1 and 2.
#include "tests/verification/cases/impact_cases.h"
#include "tests/verification/the_program.h"

namespace {

using namespace softgrain;
using namespace softgrain::verification;

std::vector<ImpactCase> cases() { return {two_spheres(), sphere_on_rigid_plane()}; }

TEST(VerifiedImpacts, ClosedFormsAreThoseThatWerePublished) {
  for (const ImpactCase& c : cases()) {
    EXPECT_NEAR(c.closed_form.force / c.published.force, 1.0, 1e-7) << c.name;
    EXPECT_NEAR(c.closed_form.overlap / c.published.overlap, 1.0, 1e-6) << c.name;
    EXPECT_NEAR(c.closed_form.duration / c.published.duration, 1.0, 2e-7) << c.name;
  }
}

TEST(VerifiedImpacts, TwoHundredStepsGiveTheClosedForm) {
  for (const ImpactCase& c : cases()) {
    const ImpactErrors e = run_impact(c, 200.0);
    EXPECT_LT(std::abs(e.relative.force), 4e-5) << c.name;
    EXPECT_LT(std::abs(e.relative.overlap), 4e-5) << c.name;
    EXPECT_LT(std::abs(e.relative.duration), 4e-5) << c.name;
    EXPECT_LT(std::abs(e.relative_restitution), 5e-6) << c.name;
  }
}

TEST(VerifiedImpacts, ErrorsFallWithTheSquareOfTheStep) {
  for (const ImpactCase& c : cases()) {
    const ImpactErrors coarse = run_impact(c, 50.0);
    const ImpactErrors fine = run_impact(c, 400.0);
    EXPECT_NEAR(coarse.relative.force / fine.relative.force, 64.0, 10.0) << c.name;
    EXPECT_NEAR(coarse.relative.overlap / fine.relative.overlap, 64.0, 10.0) << c.name;
    EXPECT_NEAR(coarse.relative.duration / fine.relative.duration, 64.0, 10.0) << c.name;
  }
}

TEST(VerifiedImpacts, CurvesFollowThoseReadOffTheFigures) {
  for (const ImpactCase& c : cases()) {
    EXPECT_LT(distance_over_time(c).largest, 0.015) << c.name;
    EXPECT_LT(distance_over_time(c).rms, 0.008) << c.name;
    EXPECT_LT(distance_over_overlap(c).largest, 0.015) << c.name;
    EXPECT_LT(distance_over_overlap(c).rms, 0.008) << c.name;
  }
}

TEST(VerifiedImpacts, TheProgramWithItsOwnStep) {
  for (const ImpactCase& c : cases()) {
    const auto summary = run_file_by_program(c.scene);
    expect_same_end(summary, run_file(c.scene));
    ASSERT_EQ(summary["contacts"].size(), 1U) << c.name;
    const auto& contact = summary["contacts"][0];
    EXPECT_EQ(contact["count"], 1) << c.name;
    EXPECT_NEAR(contact["max_force"].get<double>() / c.published.force, 1.0, 1e-4) << c.name;
    EXPECT_NEAR(contact["max_overlap"].get<double>() / c.published.overlap, 1.0, 1e-4) << c.name;
    EXPECT_NEAR(contact["duration"].get<double>() / c.published.duration, 1.0, 1e-4) << c.name;
    EXPECT_LE(summary["step"].get<double>(), c.published.duration / 200.0 * 1.001) << "step that \"auto\" chose";
  }
}

}  // namespace
