// Forces and their derivatives by the numbers of a law, against the law as it is written once and its differences.
#include "calibrate/multi_contact_slopes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace softgrain {
namespace {

/// Neighbours of every kind around one soft particle, one of them soft and pressed from its other sides.
struct Crowded {
  std::vector<MultiContactPartner> partners;
  std::vector<std::vector<double>> overlaps;
};

Vec3 unit(double x, double y, double z) { return Vec3{x, y, z} * (1.0 / std::sqrt(x * x + y * y + z * z)); }

Crowded crowded() {
  Crowded c;
  c.partners = {{PartnerKind::plane, 0.0, unit(1, 0.1, 0)},
                {PartnerKind::plane, 0.0, unit(-0.2, 1, 0.3), true},
                {PartnerKind::solid, 0.5, unit(-1, -0.4, 0.2)},
                {PartnerKind::solid, 2.0, unit(0.1, -1, 0.5)},
                {PartnerKind::soft, 1.0, unit(0.2, 0.3, 1)},
                {PartnerKind::soft, 2.0, unit(0.1, -0.2, -1)},
                {PartnerKind::plane, 0.0, unit(0.2, 0.3, 1), false, 4},
                {PartnerKind::plane, 0.0, unit(1, 0, -0.2), false, 4}};
  c.overlaps = {{0.20, 0.16, 0.15, 0.18, 0.24, 0.22, 0.12, 0.10},
                {0.05, 0.00, 0.22, 0.01, 0.30, 0.90, 0.00, 0.15},
                {0.01, 0.00, 0.00, 0.00, 0.02, 0.00, 0.00, 0.00}};
  return c;
}

MultiContactModel model_of(LawForm form) {
  MultiContactModel model;
  model.multi_contact = form;
  model.form.pressure = {0.6, 2.7, 0.09};
  if (form == LawForm::directional) model.form.coupling = {1.3, 0.7, 0.4};
  set_partners(model, PartnerKind::solid, {0.5, 1.0, 2.0}, {0.4, 0.1, 0.05}, 0.93);
  set_partners(model, PartnerKind::soft, {1.0, 2.0}, {-0.7, -0.4}, 1.2);
  set_partners(model, PartnerKind::plane, {0.0}, {-0.1}, 1.1);
  return model;
}

class MultiContactSlopesOf : public ::testing::TestWithParam<LawForm> {
 protected:
  MultiContactSlopesOf() {
    for (const auto& overlap : multi_contact_.overlaps) states_.push_back({&multi_contact_.partners, &overlap});
  }
  Crowded multi_contact_ = crowded();
  std::vector<OverlapState> states_;
};

TEST_P(MultiContactSlopesOf, ForcesAreThoseOfTheLaw) {
  const MultiContactModel model = model_of(GetParam());
  const MultiContactSlopes slopes(GetParam(), states_);
  ASSERT_EQ(slopes.forces(), 18U);
  std::vector<double> force(slopes.forces());
  slopes.evaluate(slopes.numbers_of(model), force);
  std::size_t next = 0;
  double largest = 0.0;
  for (const auto& overlap : multi_contact_.overlaps)
    for (const double expected : multi_contact_forces(model, multi_contact_.partners, overlap)) {
      EXPECT_NEAR(force[next], expected, 1e-13) << next;
      largest = std::max(largest, force[next++]);
    }
  EXPECT_EQ(next, force.size());
  EXPECT_GT(largest, 1e-3);
  EXPECT_EQ(force.back(), 0.0);  // far below the threshold
}

/// The particle in the middle of a state comes first, then its two soft neighbours.
TEST_P(MultiContactSlopesOf, ParticlesAreAboveTheirThresholdWhereTheyBearForce) {
  if (GetParam() == LawForm::pair) GTEST_SKIP() << "every contact by itself";
  const MultiContactModel model = model_of(GetParam());
  const MultiContactSlopes slopes(GetParam(), states_);
  const std::vector<double> above = slopes.above_threshold(slopes.numbers_of(model));
  ASSERT_EQ(above.size(), 9U);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(above[3 * k],
                cap_depth(multi_contact_volume(model, multi_contact_.partners, multi_contact_.overlaps[k])) -
                    model.form.pressure.delta,
                1e-13)
        << k;
  EXPECT_GT(above[0], 0.0);
  for (std::size_t k = 6; k < 9; ++k) EXPECT_LT(above[k], 0.0) << "no force in the last state";
  EXPECT_EQ(above[8], -1.0) << "no overlap";
}

TEST_P(MultiContactSlopesOf, SlopesAreTheDifferencesOfForces) {
  const MultiContactSlopes slopes(GetParam(), states_);
  const std::vector<double> numbers = slopes.numbers_of(model_of(GetParam()));
  // Plane, smooth plane, two solids, soft ones of ratio 1, 2 and, from the other side, 1/2.
  ASSERT_EQ(numbers.size(), 6U + 2U * 7U);
  std::vector<double> slope(slopes.forces() * slopes.numbers());
  slopes.slopes(numbers, slope);
  std::array<std::vector<double>, 2> force;
  for (std::size_t j = 0; j < numbers.size(); ++j) {
    constexpr double kStep = 1e-5;
    for (const int side : {0, 1}) {
      std::vector<double> moved = numbers;
      moved[j] += side == 0 ? -kStep : kStep;
      force[static_cast<std::size_t>(side)].resize(slopes.forces());
      slopes.evaluate(moved, force[static_cast<std::size_t>(side)]);
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < slopes.forces(); ++i) {
      const double expected = (force[1][i] - force[0][i]) / (2.0 * kStep);
      EXPECT_NEAR(slope[i * numbers.size() + j], expected, 1e-7 * (1.0 + std::abs(expected))) << i << " by " << j;
      largest = std::max(largest, std::abs(expected));
    }
    const bool coupling = j >= 3 && j < 6;
    if (!coupling || GetParam() == LawForm::directional) {
      EXPECT_GT(largest, 1e-4) << j;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, MultiContactSlopesOf,
                         ::testing::Values(LawForm::pair, LawForm::isotropic, LawForm::directional),
                         [](const auto& form) { return to_string(form.param); });

}  // namespace
}  // namespace softgrain
