// One contact of the least-work solver against its formulas [QS 2.1].
#include <gtest/gtest.h>

#include <numbers>

#include "common/statics/contact_law.h"

namespace {

using namespace softgrain;
using namespace softgrain::statics;

/// Two spheres of 1 mm, E = 70 GPa, nu = 0.2, 10 um deep; the reference state carries Q0 and a moment.
struct Sample {
  NormalConstants normal{4.0 / 3.0 * 70e9 / (2.0 * 0.96) * std::sqrt(0.5e-3), std::sqrt(0.5e-3)};
  FrictionConstants friction;
  ContactPlace place = place_of_spheres({{1.99e-3, 0.0, 0.0}}, 1.99e-3, 1e-3, 1e-3);

  explicit Sample(double mu) {
    const double shear_modulus = 70e9 / 2.4;
    const double p0 = hertz_force(normal, 1e-5).force;
    friction.shear = 8.0 * shear_modulus / (2.0 * 1.8);
    friction.twist = 16.0 / 3.0 * shear_modulus / 2.0;
    friction.friction = mu;
    friction.overlap0 = 1e-5;
    friction.contact_radius0 = std::sqrt(0.5e-3 * 1e-5);
    friction.limit0 = mu * p0;
    friction.tangential0 = {{0.0, 0.3 * friction.limit0, 0.0}};
    friction.torsion0 = 0.2 * 3.0 * std::numbers::pi / 16.0 * friction.contact_radius0 * friction.limit0;
  }
  [[nodiscard]] double stick() const { return friction.shear * friction.contact_radius0; }
};

using Published = FrictionLaw<CoulombRule::reference, true>;
using Current = FrictionLaw<CoulombRule::current, true>;

TEST(LeastWorkContact, HertzForceAndItsDerivatives) {
  const Sample s(0.3);
  const double h = 1e-5;
  const NormalForce f = hertz_force(s.normal, h);
  EXPECT_NEAR(f.force, 4.0 / 3.0 * 70e9 / 1.92 * std::sqrt(0.5e-3) * std::pow(h, 1.5), 1e-13 * f.force);
  const double d = 1e-9;
  const double slope = (hertz_force(s.normal, h + d).force - hertz_force(s.normal, h - d).force) / (2.0 * d);
  const double force = (hertz_force(s.normal, h + d).work - hertz_force(s.normal, h - d).work) / (2.0 * d);
  EXPECT_NEAR(slope / f.stiffness, 1.0, 1e-8);
  EXPECT_NEAR(force / f.force, 1.0, 1e-8);
}

TEST(LeastWorkContact, ArmsEndAtTheCircleOfIntersection) {
  const double ri = 1e-3, rj = 2.5e-3, d = 3.2e-3;
  const ContactPlace p = place_of_spheres({{0.0, d, 0.0}}, d, ri, rj);
  // Both spheres see the same circle.
  EXPECT_NEAR(ri * ri - p.arm_i * p.arm_i, rj * rj - p.arm_j * p.arm_j, 1e-18);
  EXPECT_NEAR(p.arm_i + p.arm_j, d, 1e-18);
}

TEST(LeastWorkContact, RollingAboutACommonAxisDoesNotSlide) {
  const ContactPlace p = place_of_spheres({{0.0, 0.0, 2e-3}}, 2e-3, 1e-3, 1e-3);
  const Vec3 turn{{1e-3, 2e-3, 0.0}};
  EXPECT_LT(norm(sliding_displacement(p, {}, turn, -turn)), 1e-18);
  // Equal turns slide by arm_i + arm_j.
  EXPECT_NEAR(norm(sliding_displacement(p, {}, turn, turn)), 2e-3 * norm(turn), 1e-15);
}

TEST(LeastWorkContact, SticksWithinTheLimit) {
  const Sample s(0.3);
  const Vec3 moved{{0.0, 0.1 * s.friction.limit0 / s.stick(), -0.2 * s.friction.limit0 / s.stick()}};
  const statics::ContactResponse r = respond<Published>(s.normal, &s.friction, s.place, moved, {}, {});
  EXPECT_EQ(r.tangential.stiffness, r.tangential.stick);
  EXPECT_LT(norm(r.tangential.force - (s.friction.tangential0 - moved * s.stick())), 1e-12 * s.friction.limit0);
}

TEST(LeastWorkContact, PublishedSlipLowersTheStiffnessUntilTheForceIsTheLimit) {
  const Sample s(0.3);
  for (const double y : {-3.0, -0.5, 0.4, 5.0}) {
    const Vec3 moved{{0.0, y * s.friction.limit0 / s.stick(), 2.0 * s.friction.limit0 / s.stick()}};
    const statics::ContactResponse r = respond<Published>(s.normal, &s.friction, s.place, moved, {}, {});
    ASSERT_LT(r.tangential.stiffness, r.tangential.stick);
    EXPECT_NEAR(norm(r.tangential.force) / s.friction.limit0, 1.0, 1e-13);
    // On the line Qp - k' u, 0 <= k' <= k*.
    const Vec3 change = s.friction.tangential0 - r.tangential.force;
    EXPECT_LT(norm(cross(change, moved)), 1e-12 * norm(change) * norm(moved));
    EXPECT_GE(r.tangential.stiffness, 0.0);
    EXPECT_LE(r.tangential.stiffness, s.stick());
  }
}

TEST(LeastWorkContact, SlipStiffnessIsNeverNegative) {
  EXPECT_EQ(slip_stiffness(-1.0, 1.0, 4.0, 1.0), 0.0);  // no solution: |Qp| > limit, turned away
  EXPECT_GE(slip_stiffness(-1.0, 1.0, 1.0, 1.0), 0.0);
  EXPECT_NEAR(slip_stiffness(-1e8, 1.0, 0.0, 1.0), 0.5e-8, 1e-20);  // cancellation-free
}

TEST(LeastWorkContact, ReturnMappingTakesTheCurrentNormalForce) {
  Sample s(0.3);
  const Vec3 moved{{0.0, 4.0 * s.friction.limit0 / s.stick(), 0.0}};
  s.place = place_of_spheres({{1.995e-3, 0.0, 0.0}}, 1.995e-3, 1e-3, 1e-3);  // half the overlap
  const statics::ContactResponse r = respond<Current>(s.normal, &s.friction, s.place, moved, {}, {});
  const double p = hertz_force(s.normal, 5e-6).force;
  EXPECT_NEAR(norm(r.tangential.force) / (0.3 * p), 1.0, 1e-9);
  EXPECT_LT(r.tangential.force[1], 0.0);
}

TEST(LeastWorkContact, AContactMadeInTheIncrementHasFrictionOnlyUnderTheCurrentRule) {
  Sample s(0.3);
  s.friction.fresh = true;
  s.friction.overlap0 = -1e-5;
  s.friction.contact_radius0 = s.friction.limit0 = s.friction.torsion0 = 0.0;
  s.friction.tangential0 = {};
  const Vec3 moved{{0.0, 1e-8, 0.0}};
  EXPECT_EQ(norm(respond<Published>(s.normal, &s.friction, s.place, moved, {}, {}).tangential.force), 0.0);
  const statics::ContactResponse r = respond<Current>(s.normal, &s.friction, s.place, moved, {}, {});
  // It has slid over half of the path, with the stiffness of its contact radius now.
  EXPECT_NEAR(norm(r.tangential.force) / (s.friction.shear * std::sqrt(0.5e-3 * 1e-5) * 0.5e-8), 1.0, 1e-9);
}

TEST(LeastWorkContact, WithoutALimitTheForceFadesWhereTheContactOpens) {
  Sample s(std::numeric_limits<double>::infinity());
  s.friction.tangential0 = {{0.0, 1.0, 0.0}};
  s.friction.torsion0 = 0.0;
  const double d = 2e-3 - 1e-5 * 1e-4;  // a hundredth of the contact radius
  const ContactPlace nearly_open = place_of_spheres({{d, 0.0, 0.0}}, d, 1e-3, 1e-3);
  const statics::ContactResponse r = respond<Current>(s.normal, &s.friction, nearly_open, {}, {}, {});
  EXPECT_NEAR(norm(r.tangential.force), 0.01, 1e-6);
}

TEST(LeastWorkContact, TorsionSticksAndSlipsTheSameWay) {
  const Sample s(0.3);
  const double limit = 3.0 * std::numbers::pi / 16.0 * s.friction.contact_radius0 * s.friction.limit0;
  const double stiffness = s.friction.twist * std::pow(s.friction.contact_radius0, 3);
  const Vec3 small{{0.3 * limit / stiffness, 0.0, 0.0}};
  const statics::ContactResponse stuck = respond<Published>(s.normal, &s.friction, s.place, {}, small, {});
  EXPECT_NEAR(stuck.torsion.moment / (s.friction.torsion0 - 0.3 * limit), 1.0, 1e-12);
  const statics::ContactResponse slid = respond<Published>(s.normal, &s.friction, s.place, {}, small * 10.0, {});
  EXPECT_NEAR(slid.torsion.moment / -limit, 1.0, 1e-12);
}

/// Pi's slope along `d` at `moved`, geometry frozen, against -Q.d; stiffness frozen where the contact slips.
TEST(LeastWorkContact, FrozenGeometryGivesTheExactGradientInStick) {
  const Sample s(0.3);
  const double scale = 0.2 * s.friction.limit0 / s.stick();
  const Vec3 moved{{0.0, 0.5 * scale, 0.7 * scale}};
  const Vec3 turn{{0.1 * scale / 1e-3, 0.3 * scale / 1e-3, 0.0}};
  const Vec3 direction{{0.0, 0.6, -0.8}};
  const double step = 1e-2 * scale;
  const auto work = [&](double t) {
    const statics::ContactResponse r =
        respond<Published>(s.normal, &s.friction, s.place, moved + direction * t, turn, {});
    return r.tangential.work + r.torsion.work;
  };
  const statics::ContactResponse r = respond<Published>(s.normal, &s.friction, s.place, moved, turn, {});
  ASSERT_EQ(r.tangential.stiffness, r.tangential.stick);
  const double slope = (work(step) - work(-step)) / (2.0 * step);
  EXPECT_NEAR(slope / -dot(r.tangential.force, direction), 1.0, 1e-11);
}

/// The stiffness handed to the linear solver is the secant Qp - Q over u_s, at most that of stick.
TEST(LeastWorkContact, StiffnessIsTheSecant) {
  const Sample s(0.3);
  const double scale = s.friction.limit0 / s.stick();
  for (const double size : {0.2, 3.0}) {
    const Vec3 moved{{0.0, 0.3 * size * scale, size * scale}};
    const TangentialForce t = respond<Published>(s.normal, &s.friction, s.place, moved, {}, {}).tangential;
    EXPECT_LT(norm(s.friction.tangential0 - moved * t.stiffness - t.force), 1e-12 * s.friction.limit0);
    EXPECT_LE(t.stiffness, t.stick * (1.0 + 1e-15));
  }
}

}  // namespace
