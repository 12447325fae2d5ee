// Rolling resistance of soft particles: a moment under a limit, which never gives back more than it took.
#include <gtest/gtest.h>

#include <cmath>

#include "common/contact/soft_multi_contact.h"
#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "common/neighbours/verlet_list.h"
#include "common/state/system_io.h"
#include "tests/support/small_packing.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using RollingLaw = SoftMultiContact<LawForm::pair, false, true>;
constexpr double kSoftModulus = 5e5;
constexpr double kRollingStiffness = 0.005;
constexpr double kRollingLimit = 0.13;

RollingLaw law_between(bool i_is_soft, bool j_is_soft) {
  RollingLaw law;
  law.form.pressure = {0.8, 3.0, 0.05};
  law.modulus = kSoftModulus;
  law.rolling = kRollingStiffness;
  law.rolling_friction = kRollingLimit;
  law.i_is_soft = i_is_soft;
  law.j_is_soft = j_is_soft;
  return law;
}

/// A contact of bodies of these radii (0: a plane), as deep as a share of the smaller one, that turns at this rate.
ContactState<3> contact(double ri, double rj, double depth, const Vec3& turning, double dt) {
  ContactState<3> s;
  s.overlap = depth * (rj > 0.0 ? std::min(ri, rj) : ri);
  s.normal = {{1.0, 0.0, 0.0}};
  s.turning = turning;
  s.dt = dt;
  s.radius_i = ri;
  s.radius_j = rj;
  s.constants = {1.0, 1.0};
  return s;
}

TEST(Rolling, TheMomentIsThatOfASpring) {
  struct Case {
    bool i, j;
    double ri, rj;
    double soft, both;  ///< the radius in the limit and R12
  };
  for (const Case& c : {Case{true, false, 0.01, 0.0, 0.01, 0.01}, Case{true, false, 0.01, 0.03, 0.01, 0.0075},
                        Case{false, true, 0.03, 0.01, 0.01, 0.0075}, Case{true, true, 0.01, 0.03, 0.015, 0.0075}}) {
    const RollingLaw law = law_between(c.i, c.j);
    const Vec3 turning{{5.0, 0.3, -0.4}};  // what turns about the normal meets nothing
    const auto r = law.evaluate(contact(c.ri, c.rj, 0.3, turning, 1e-4));
    const double stiffness = kRollingStiffness * kSoftModulus * c.soft * c.soft * c.both;
    EXPECT_DOUBLE_EQ(r.rolling_stiffness, stiffness);
    EXPECT_EQ(r.rolling_moment[0], 0.0);
    EXPECT_NEAR(r.rolling_moment[1], -stiffness * 0.3e-4, 1e-12 * stiffness);
    EXPECT_NEAR(r.rolling_moment[2], stiffness * 0.4e-4, 1e-12 * stiffness);
    const auto far = law.evaluate(contact(c.ri, c.rj, 0.3, turning * 1e6, 1e-2));
    EXPECT_GT(far.normal_force, 0.0);
    EXPECT_NEAR(norm(far.rolling_moment), kRollingLimit * far.normal_force * c.soft, 1e-12 * far.normal_force * c.soft);
  }
}

TEST(Rolling, WithoutForceThereIsNoMoment) {
  const auto r = law_between(true, false).evaluate(contact(0.01, 0.0, 0.04, {{0.0, 1.0, 0.0}}, 1e-3));
  EXPECT_EQ(r.normal_force, 0.0);
  EXPECT_EQ(norm(r.rolling_moment), 0.0);
  EXPECT_EQ(norm(r.roll), 0.0);
  EXPECT_EQ(r.rolling_stiffness, 0.0);
}

/// Presses a little, then rolls a little in small steps; gives the work that rolling took.
double pressed_and_rolled(const RollingLaw& law, ContactState<3>& s, double depth, const Vec3& rate) {
  s.overlap = depth * 0.01;
  s.turning = {};
  auto r = law.evaluate(s);
  s.roll = r.roll;
  s.turning = rate;
  double work = 0.0;
  for (int k = 0; k < 10; ++k) {
    const Vec3 before = r.rolling_moment;
    r = law.evaluate(s);
    s.roll = r.roll;
    work -= 0.5 * dot(before + r.rolling_moment, s.turning) * s.dt;
  }
  return work;
}

/// Whatever is pressed, rolled and released in any order: rolling takes at least what it could give back.
TEST(Rolling, NoCycleGainsEnergy) {
  RandomStream random(3, RandomPurpose::test, 1);
  const RollingLaw law = law_between(true, true);
  const double stiffness = kRollingStiffness * kSoftModulus * 1e-4 * 0.005;
  for (int cycle = 0; cycle < 100; ++cycle) {
    ContactState<3> s = contact(0.01, 0.01, 0.0, {}, 1e-4);
    double work = 0.0;
    double depth = 0.2;
    for (int k = 0; k < 300; ++k) {
      depth = std::clamp(depth + 0.02 * (random.uniform() - 0.5) + (k > 250 ? -0.01 : 0.0), 0.0, 0.4);
      work += pressed_and_rolled(law, s, depth, {{0.0, random.uniform() - 0.5, random.uniform() - 0.5}});
      ASSERT_GE(work, 0.5 * stiffness * norm2(s.roll) - 1e-9 * work) << cycle << ", " << k;
    }
    EXPECT_EQ(norm(s.roll), 0.0) << "apart at the end";
    EXPECT_GT(work, 0.0);
  }
}

/// Two soft bodies that touch; the second one turns against the first, and both go round together.
System3 pair() {
  System3 s;
  s.materials = {{"soft", 1700.0, kSoftModulus, 0.3, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, law_between(true, true));
  add_grain(s.particles, test::test_sphere<3>({{0.0, 0.0, 0.0}}, 0.01, 2000.0));
  add_grain(s.particles, test::test_sphere<3>({{0.016, 0.0, 0.0}}, 0.01, 2000.0));
  s.particles.spin[1] = Vec3{{0.0, 0.0, 2.0}};
  return s;
}

TEST(Rolling, MomentsOnBothBodiesAddUpToNothing) {
  System3 s = pair();
  force_pass(s, 1e-3, History::advance);
  EXPECT_LT(s.particles.torque[1][2], 0.0);
  EXPECT_DOUBLE_EQ(s.particles.torque[0][2], -s.particles.torque[1][2]);
}

TEST(Rolling, WhatHasRolledTurnsWithThePairAndIsForgottenApart) {
  System3 s = pair();
  force_pass(s, 1e-3, History::advance);
  const double moment = s.particles.torque[0][2];
  s.particles.spin[1] = {};
  s.particles.sphere[1].x = {{0.0, 0.0, 0.016}};  // by a right angle about y: the roll about z must lie across again
  force_pass(s, 0.0, History::none);
  EXPECT_NEAR(norm(Vec3(s.particles.torque[0])), 0.0, 1e-9 * moment) << "a roll along the new normal";
  s = pair();
  force_pass(s, 1e-3, History::advance);
  s.particles.spin[1] = {};
  s.particles.sphere[1].x = {{0.0, 0.016, 0.0}};  // about z itself: nothing changes
  force_pass(s, 0.0, History::advance);
  EXPECT_NEAR(s.particles.torque[0][2], moment, 1e-12 * moment);
  s.particles.sphere[1].x = {{0.0, 0.03, 0.0}};
  force_pass(s, 0.0, History::advance);
  s.particles.sphere[1].x = {{0.0, 0.016, 0.0}};
  force_pass(s, 0.0, History::advance);
  EXPECT_EQ(norm(Vec3(s.particles.torque[0])), 0.0);
}

TEST(Rolling, ItIsPartOfASavedState) {
  const test::TemporaryDirectory directory;
  System3 s = pair();
  force_pass(s, 1e-3, History::advance);
  {
    h5::AtomicFile file(directory.file("state.h5"));
    write_system(file.root(), s);
    file.commit();
  }
  System3 again = pair();
  read_system(h5::open_file(directory.file("state.h5")), again);
  ASSERT_EQ(again.contacts.roll.size(), 1U);
  EXPECT_EQ(again.contacts.roll[0], s.contacts.roll[0]);
  EXPECT_NE(norm(Vec3(again.contacts.roll[0])), 0.0);
}

/// A contact that comes through the list of another build keeps what it has rolled.
TEST(Rolling, ANewListKeepsIt) {
  System3 s = pair();
  force_pass(s, 1e-3, History::advance);
  const Vec3 before = s.contacts.roll[0];
  rebuild_neighbours(s);
  EXPECT_EQ(Vec3(s.contacts.roll[0]), before);
}

}  // namespace
}  // namespace softgrain
