// Faults that users of other programs reported, and what this one answers. Reports are named by repository and number;
// inputs are of our own.
#include <gtest/gtest.h>

#include "common/dynamics/contact_tensors.h"
#include "tests/support/impact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Material kSoftBall{"soft", 2500.0, 4e5, 0.2, false};
const Material kStiffBall{"stiff", 2500.0, 6e5, 0.2, false};

AnyLaw ball_on_ball(double friction, double restitution, const RollingResistance& rolling = {}) {
  return hertz_law(HertzCoefficients::of(kSoftBall, kSoftBall, friction, restitution, rolling), true);
}

/// lammps/lammps issue 4141: a wall mixed its modulus otherwise than a sphere of that material.
TEST(PublicReports, AWallOfAnotherMaterialIsALargeSphereOfIt) {
  const AnyLaw law = hertz_law(HertzCoefficients::of(kSoftBall, kStiffBall, 0.0, 1.0), false);
  std::array<ImpactOutcome, 2> out;
  for (const Partner partner : {Partner::plane, Partner::sphere}) {
    System3 s = impact_system({partner, 0.01, 1e4, 0.1}, law, kSoftBall);
    out[partner == Partner::plane ? 0 : 1] = collide(s, partner, 1e-6, 40000);
  }
  const double modulus = 1.0 / ((1.0 - 0.04) / 4e5 + (1.0 - 0.04) / 6e5);
  const double mass = 2500.0 * kSphereVolume * 1e-6;
  const HertzImpact closed = hertz_impact(4.0 / 3.0 * modulus * std::sqrt(0.01), mass, 0.1);
  for (const ImpactOutcome& one : out) {
    EXPECT_NEAR(one.max_overlap / closed.overlap, 1.0, 1e-3);
    EXPECT_NEAR(one.duration / closed.duration, 1.0, 1e-3);
    EXPECT_NEAR(one.restitution, 1.0, 1e-6);
  }
}

/// lammps/lammps issue 2812: walls damped otherwise than pairs.
TEST(PublicReports, WallsDampAsPairsDo) {
  for (const double e : {0.2, 0.5, 0.9})
    for (const Partner partner : {Partner::plane, Partner::sphere}) {
      System3 s = impact_system({partner, 0.01, 1.0, 0.1}, ball_on_ball(0.3, e), kSoftBall);
      EXPECT_NEAR(collide(s, partner, 1e-6, 60000).restitution, e, 2e-3) << e;
    }
}

/// chaos-polymtl/lethe pull request 889: the spin entered the motion at a wall with the wrong sign. A ball that rolls
/// without sliding about the middle of its contact feels no friction.
TEST(PublicReports, RollingWithoutSlidingGoesOnForever) {
  System3 s = impact_system({Partner::plane, 0.01}, ball_on_ball(0.5, 0.5), kSoftBall);
  const double weight = 9.81 / s.particles.inverse_mass[0];
  s.gravity = {{0.0, 0.0, -9.81}};
  const double modulus = 0.5 * 4e5 / (1.0 - 0.04);
  const double overlap = std::pow(weight / (4.0 / 3.0 * modulus * std::sqrt(0.01)), 2.0 / 3.0);
  s.particles.sphere[0].x[2] = 0.01 - overlap;
  const double arm = 0.01 - 0.5 * overlap;
  s.particles.velocity[0] = Vec3{{0.1, 0.0, 0.0}};
  s.particles.spin[0] = Vec3{{0.0, 0.1 / arm, 0.0}};
  VelocityVerlet<3> motion(2e-5);
  motion.initialise(s);
  for (int k = 0; k < 5000; ++k) motion.step(s);
  EXPECT_NEAR(s.particles.velocity[0][0], 0.1, 1e-5);
  EXPECT_NEAR(s.particles.spin[0][1], 0.1 / arm, 1e-5 / arm);
}

/// lammps/lammps pull request 1637: twisting went with rolling. Resistance to rolling alone does not resist a turn
/// about the line of centres.
TEST(PublicReports, RollingResistanceDoesNotResistTwisting) {
  ImpactSetup setup{Partner::sphere, 0.01, 1.0, 0.5};
  setup.spin = {{0.0, 0.0, 50.0}};
  System3 s = impact_system(setup, ball_on_ball(0.5, 0.7, {0.3, 1.0, 1.0}), kSoftBall);
  EXPECT_TRUE(collide(s, Partner::sphere, 1e-6, 60000).ended);
  EXPECT_NEAR(s.particles.spin[0][2], 50.0, 1e-10);
  EXPECT_NEAR(norm(s.particles.spin[1]), 0.0, 1e-10);
}

/// lammps/lammps issue 4219: forces of several contacts of one particle entered its stress more than once. Of a cubic
/// lattice that is pressed on all sides it is F/(2 r)^2 with the squeezed distance, and no shear.
TEST(PublicReports, TheStressOfACubicLatticeHasNoShear) {
  constexpr double kDistance = 0.0199;
  constexpr int kSide = 3;
  System3 s;
  s.materials = {kSoftBall};
  s.laws = LawSet(1);
  s.laws.set(0, 0, ball_on_ball(0.5, 0.5));
  const double edge = kSide * kDistance;
  s.cell = box_cell<3>({{edge, edge, edge}}, {true, true, true});
  for (int i = 0; i < kSide * kSide * kSide; ++i)
    add_grain(s.particles,
              test_sphere<3>({{(i % 3 + 0.5) * kDistance, (i / 3 % 3 + 0.5) * kDistance, (i / 9 + 0.5) * kDistance}},
                             0.01, 2500.0));
  force_pass(s, 1e-6);
  const auto contacts = contact_records(s);
  ASSERT_EQ(contacts.size(), 81U);
  const Matrix<3> sum = branch_force_sum(contacts, s.particles.first_plane());
  const double force = 4.0 / 3.0 * 0.5 * 4e5 / (1.0 - 0.04) * std::sqrt(0.005) * std::pow(0.02 - kDistance, 1.5);
  const double stress = force / (kDistance * kDistance);
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l)
      EXPECT_NEAR(sum[k][l] / (edge * edge * edge), k == l ? stress : 0.0, 1e-9 * stress) << k << l;
}

/// chaos-polymtl/lethe pull request 1417: three balls that touch each other and turn differently, with springs against
/// rolling. Momentum and moment of momentum stay.
TEST(PublicReports, ThreeTurningBallsKeepTheirMomenta) {
  System3 s;
  s.materials = {kSoftBall};
  s.laws = LawSet(1);
  s.laws.set(0, 0, ball_on_ball(0.3, 0.5, {0.1, 1.0, 1.0}));
  for (std::size_t k = 0; k < 3; ++k) {
    const double angle = 2.0 * std::numbers::pi / 3.0 * static_cast<double>(k);
    const double away = 0.0199 / std::sqrt(3.0);
    add_grain(s.particles, test_sphere<3>({{away * std::cos(angle), away * std::sin(angle), 0.0}}, 0.01, 2500.0));
    s.particles.spin[k] = Vec3{{3.0, -1.0, 5.0}} * static_cast<double>(k);
  }
  const auto momenta = [&] {
    std::array<Vec3, 2> out{};
    for (std::size_t u = 0; u < 3; ++u) {
      const Vec3 momentum = Vec3(s.particles.velocity[u]) * (1.0 / s.particles.inverse_mass[u]);
      out[0] += momentum;
      out[1] += cross(s.particles.sphere[u].x, momentum);
      out[1] += Vec3(s.particles.spin[u]) * (1.0 / s.particles.inverse_inertia[u]);
    }
    return out;
  };
  const auto before = momenta();
  VelocityVerlet<3> motion(1e-5);
  motion.initialise(s);
  for (int k = 0; k < 2000; ++k) motion.step(s);
  const auto after = momenta();
  EXPECT_LT(norm(after[0]), 1e-10 * norm(before[1]) / 0.01);
  EXPECT_LT(norm(after[1] - before[1]), 1e-10 * norm(before[1]));
  EXPECT_LT(norm(s.particles.spin[2]), norm(Vec3{{6.0, -2.0, 10.0}}));
}

/// lammps/lammps pull request 5007: grazing impacts on a wall gained up to a third of their energy and left faster
/// along the wall than they came.
TEST(PublicReports, GrazingImpactsGainNothing) {
  for (const Partner partner : {Partner::plane, Partner::sphere})
    for (const double friction : {0.1, 0.5})
      for (const double degrees : {30.0, 60.0, 76.0, 85.0}) {
        const double angle = degrees * std::numbers::pi / 180.0;
        ImpactSetup setup{partner, 0.01, 1e4, std::cos(angle)};
        setup.sliding_speed = std::sin(angle);
        System3 s = impact_system(setup, ball_on_ball(friction, 0.9), kSoftBall);
        const ImpactOutcome out = collide(s, partner, 1e-6, 60000);
        ASSERT_TRUE(out.ended) << degrees;
        EXPECT_LT(out.energy_ratio, 1.0) << degrees << " " << friction;
        EXPECT_LE(s.particles.velocity[0][0], setup.sliding_speed) << degrees << " " << friction;
        EXPECT_GT(s.particles.velocity[0][0], 0.0) << "it is not thrown back";
      }
}

/// chaos-polymtl/lethe pull request 559: a ball touched one wall at a time, so one in a corner fell through the others.
TEST(PublicReports, ABallInACornerTouchesAllWalls) {
  System3 s;
  s.materials = {kSoftBall};
  s.laws = LawSet(1);
  s.laws.set(0, 0, ball_on_ball(0.0, 0.5));
  const double overlap = 1e-4;
  add_grain(s.particles, test_sphere<3>({{0.01 - overlap, 0.01 - 2.0 * overlap, 0.01 - 3.0 * overlap}}, 0.01, 2500.0));
  for (int a = 0; a < 3; ++a) {
    Vec3 normal{};
    normal[a] = 1.0;
    add_plane(s.particles, NewBody<3>{}, normal);
  }
  force_pass(s, 1e-7);
  const auto contacts = contact_records(s);
  ASSERT_EQ(contacts.size(), 3U);
  const double stiffness = 4.0 / 3.0 * 0.5 * 4e5 / (1.0 - 0.04) * std::sqrt(0.01);
  for (int a = 0; a < 3; ++a) {
    const double force = stiffness * std::pow(static_cast<double>(a + 1) * overlap, 1.5);
    EXPECT_NEAR(s.particles.force[0][a], force, 1e-9 * force) << a;
  }
}

/// chaos-polymtl/lethe pull request 1949: pairs over an edge or a corner of a cell that repeats in several directions.
TEST(PublicReports, APairOverTheCornerOfAPeriodicCellIsAPair) {
  const Vec3 apart{{0.0112, 0.0113, 0.0111}};
  const auto forces = [&](const Vec3& at) {
    System3 s;
    s.materials = {kSoftBall};
    s.laws = LawSet(1);
    s.laws.set(0, 0, ball_on_ball(0.5, 0.5));
    s.cell = box_cell<3>({{0.1, 0.1, 0.1}}, {true, true, true});
    for (const Vec3& x : {at, at + apart}) {
      Vec3 inside = x;
      for (int k = 0; k < 3; ++k) inside[k] -= 0.1 * std::floor(inside[k] / 0.1);
      add_grain(s.particles, test_sphere<3>(inside, 0.01, 2500.0));
    }
    s.particles.velocity[0] = Vec3{{0.1, -0.2, 0.05}};
    s.particles.spin[1] = Vec3{{3.0, -1.0, 2.0}};
    VelocityVerlet<3> motion(1e-6);
    motion.initialise(s);
    for (int k = 0; k < 200; ++k) motion.step(s);
    EXPECT_EQ(contact_records(s).size(), 1U);
    return std::array<Vec3, 2>{Vec3(s.particles.velocity[1]), Vec3(s.particles.spin[1])};
  };
  const auto middle = forces({{0.05, 0.05, 0.05}});
  for (const Vec3& at : {Vec3{{0.095, 0.095, 0.05}}, Vec3{{0.095, 0.05, 0.095}}, Vec3{{0.095, 0.095, 0.095}}}) {
    const auto corner = forces(at);
    for (std::size_t k = 0; k < 2; ++k) EXPECT_LT(norm(corner[k] - middle[k]), 1e-9 * norm(middle[k])) << k;
  }
}

/// chaos-polymtl/lethe pull request 300: both balls of a pair had the torque of one radius. Each has its own arm, the
/// distance of its centre from the middle of the contact.
TEST(PublicReports, UnequalBallsHaveArmsOfTheirOwn) {
  ImpactSetup setup{Partner::sphere, 0.01, 3.0, 0.2};
  setup.sliding_speed = 0.1;
  System3 s = impact_system(setup, ball_on_ball(0.5, 0.7), kSoftBall);
  VelocityVerlet<3> motion(1e-6);
  motion.initialise(s);
  for (int k = 0; k < 300; ++k) motion.step(s);
  ASSERT_GT(overlap_of(s, Partner::sphere), 0.0);
  const auto turned = [&](std::size_t u) { return s.particles.spin[u][1] / s.particles.inverse_inertia[u]; };
  ASSERT_GT(std::abs(turned(0)), 0.0);
  EXPECT_NEAR(turned(1) / turned(0), 3.0, 0.01) << "the same force on arms of 3 to 1";
}

}  // namespace
