// Cohesive disks: the published force law, friction and rolling limits by the elastic repulsion alone, attraction at a
// distance that the neighbour list must not miss.
#include "common/contact/cohesive_disk.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/verlet.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {
namespace {

using System2 = System<2>;

/// Units of the publication: a = F0 = m = 1.
template <bool kRolling, bool kFriction = true>
CohesiveDisk<kFriction, kRolling> published(double kappa) {
  CohesiveDisk<kFriction, kRolling> law;
  law.normal = law.tangential = kappa;
  law.friction = 0.5;
  law.damping = 0.8;
  law.adhesion = 1.0;
  law.range = 1e-3;
  law.rolling = 1e-4 * kappa;
  law.rolling_limit = 1e-2 * 0.5;
  return law;
}

ContactState<2> at_overlap(double h) {
  ContactState<2> s;
  s.overlap = h;
  s.normal = {{1.0, 0.0}};
  return s;
}

TEST(CohesiveDisk, NormalForceIsPublished) {
  const auto law = published<false>(1e5);
  const auto force = [&](double h) { return law.evaluate(at_overlap(h)).normal_force; };
  EXPECT_EQ(force(-1.1e-3), 0.0);
  EXPECT_NEAR(force(-0.5e-3), -0.5, 1e-12);
  EXPECT_NEAR(force(-1e-12), -1.0, 1e-6) << "continuous at contact";
  EXPECT_NEAR(force(1e-12), -1.0, 1e-6);
  EXPECT_NEAR(force(1e-5), 0.0, 1e-12) << "equilibrium at h = F0/K_N";
  EXPECT_NEAR(force(3e-5), 2.0, 1e-12);
}

TEST(CohesiveDisk, DampingActsInContactAlone) {
  auto law = published<false>(1e4);
  ContactState<2> s = at_overlap(1e-4);
  s.constants = law.pair_constants({0.5, 0.5, 1.0, 1.0});
  const double eta = 0.8 * std::sqrt(4.0 * 1e4 * 0.5);
  s.normal_speed = -0.01;  // closing
  EXPECT_NEAR(law.evaluate(s).normal_force, 0.0 + 0.01 * eta, 1e-12);
  s.overlap = -0.5e-3;
  EXPECT_NEAR(law.evaluate(s).normal_force, -0.5, 1e-12);
}

TEST(CohesiveDisk, FrictionFollowsTheElasticRepulsion) {
  const auto law = published<false>(1e5);
  ContactState<2> s = at_overlap(1e-5);  // N = 0, repulsion = F0
  s.sliding = {{0.0, 1.0}};
  s.dt = 1.0;
  const auto r = law.evaluate(s);
  EXPECT_NEAR(r.normal_force, 0.0, 1e-12);
  EXPECT_NEAR(norm(r.tangential_force), 0.5, 1e-12) << "the cone starts at N = -F0";
  EXPECT_TRUE(r.sliding);
  s.overlap = -1e-4;
  s.spring = r.spring;
  EXPECT_EQ(law.evaluate(s).spring, (Vec<2>{})) << "forgotten when the contact opens";
}

TEST(CohesiveDisk, RollingIsElasticUpToItsLimit) {
  const auto law = published<true>(1e5);
  ContactState<2> s = at_overlap(2e-5);
  s.turning[0] = 1e-4;
  s.dt = 1.0;
  EXPECT_NEAR(law.evaluate(s).rolling_moment[0], -1e-4 * 1e5 * 1e-4, 1e-15);
  s.turning[0] = 10.0;
  EXPECT_NEAR(law.evaluate(s).rolling_moment[0], -5e-3 * 2.0, 1e-15) << "mu_r times the repulsion 2 F0";
  s.overlap = -1e-5;
  EXPECT_EQ(law.evaluate(s).memory, 0.0);
}

template <class Law>
System2 disks(const Law& law, const std::vector<Vec<2>>& x, double radius, double cell) {
  System2 s;
  s.materials = {{"disk", 1.0, 1.0, 0.3, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, law);
  s.cell = box_cell<2>({{cell, cell}}, {true, true});
  for (const Vec<2>& at : x) {
    NewBody<2> b;
    b.x = at;
    b.r = radius;
    b.mass = 4.0 * radius * radius;
    b.inertia = 0.5 * b.mass * radius * radius;
    add_grain(s.particles, b);
  }
  return s;
}

/// A scatter of disks against the double sum over all pairs and images, while they move.
TEST(CohesiveDisk, NoPairWithinReachIsMissed) {
  auto law = published<true>(1e3);
  law.range = 0.05;
  RandomStream random(3, RandomPurpose::test, 0);
  constexpr double kCell = 8.0;
  std::vector<Vec<2>> x;
  while (x.size() < 40) {
    const Vec<2> at{{kCell * random.uniform(), kCell * random.uniform()}};
    bool free = true;
    for (const auto& y : x)
      for (int a = -1; a <= 1; ++a)
        for (int b = -1; b <= 1; ++b) free = free && norm(at - y - Vec<2>{{a * kCell, b * kCell}}) > 1.0;
    if (free) x.push_back(at);
  }
  System2 s = disks(law, x, 0.5, kCell);
  for (auto& v : s.particles.velocity)
    for (int k = 0; k < 2; ++k) v[k] = random.uniform() - 0.5;
  VelocityVerlet<2> integrator(1e-3);
  integrator.initialise(s);
  int distant = 0;
  for (int step = 0; step < 2000; ++step) {
    integrator.step(s);
    if (step % 100 != 0) continue;
    System2 now = s;
    force_pass(now, 0.0);
    std::vector<Vec<2>> expected(x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t j = i + 1; j < x.size(); ++j)
        for (int a = -1; a <= 1; ++a)
          for (int b = -1; b <= 1; ++b) {
            const Vec<2> d = s.particles.sphere[i].x - s.particles.sphere[j].x - Vec<2>{{a * kCell, b * kCell}};
            const double gap = norm(d) - 1.0;
            if (gap <= 0.0 || gap >= law.range) continue;
            ++distant;
            const Vec<2> f = d * (-(1.0 - gap / law.range) / norm(d));
            expected[i] += f;
            expected[j] -= f;
          }
    for (std::size_t i = 0; i < x.size(); ++i) {
      bool touches = false;  // such forces hold friction; only distant ones are compared
      for (const auto& c : contact_records(now))
        touches =
            touches || (c.overlap > 0.0 && (static_cast<std::size_t>(c.i) == i || static_cast<std::size_t>(c.j) == i));
      if (!touches) {
        EXPECT_NEAR(norm(static_cast<Vec<2>>(now.particles.force[i]) - expected[i]), 0.0, 1e-10) << step << ", " << i;
      }
    }
  }
  EXPECT_GT(distant, 20);
}

/// Action and reaction, also of the moments of rolling.
TEST(CohesiveDisk, MomentsOfRollingAreOpposite) {
  System2 s = disks(published<true>(1e4), {{{1.0, 1.0}}, {{1.9999, 1.0}}}, 0.5, 10.0);
  s.particles.spin[0][0] = 0.3;
  s.particles.spin[1][0] = 0.3;  // both the same way: they slide, but do not roll against each other
  force_pass(s, 1e-3);
  const double sliding = s.particles.torque[0][0];
  EXPECT_NEAR(s.particles.torque[1][0], sliding, 1e-12) << "a tangential force turns both the same way";
  s.particles.spin[1][0] = -0.3;  // like wheels: they roll, but do not slide
  force_pass(s, 1e-3);
  EXPECT_NEAR(s.particles.torque[0][0], -1e-4 * 1e4 * 0.6e-3, 1e-12);
  EXPECT_NEAR(s.particles.torque[1][0], 1e-4 * 1e4 * 0.6e-3, 1e-12);
}

/// Two disks that meet slowly stick; above sqrt(F0 D0/m) and without damping they part again.
TEST(CohesiveDisk, DisksStickWhenSlowAndPartWhenFast) {
  const auto end_distance = [](double speed) {
    auto law = published<false>(1e4);
    law.damping = 0.0;
    System2 s = disks(law, {{{4.0, 5.0}}, {{5.002, 5.0}}}, 0.5, 10.0);
    s.particles.velocity[0][0] = 0.5 * speed;
    s.particles.velocity[1][0] = -0.5 * speed;
    VelocityVerlet<2> integrator(1e-4);
    integrator.initialise(s);
    for (int k = 0; k < 20000; ++k) integrator.step(s);
    return norm(s.particles.sphere[1].x - s.particles.sphere[0].x);
  };
  EXPECT_GT(end_distance(0.2), 1.01) << "no energy is lost";
  auto law = published<false>(1e4);
  System2 s = disks(law, {{{4.0, 5.0}}, {{5.002, 5.0}}}, 0.5, 10.0);
  s.particles.velocity[0][0] = 0.01;
  s.particles.velocity[1][0] = -0.01;
  VelocityVerlet<2> integrator(1e-4);
  integrator.initialise(s);
  for (int k = 0; k < 40000; ++k) integrator.step(s);
  EXPECT_NEAR(norm(s.particles.sphere[1].x - s.particles.sphere[0].x), 1.0 - 1e-4, 1e-6) << "at rest at h = F0/K_N";
}

/// What a law without friction leaves out has no bit of influence: positions and velocities are those of mu = 0.
TEST(CohesiveDisk, WithoutFrictionNothingButSpinsIsMissing) {
  std::vector<Vec<2>> x;
  for (int k = 0; k < 36; ++k) x.push_back({{1.02 * (k % 6) + 0.5, 1.02 * (k / 6) + 0.5 + 0.1 * (k % 2)}});
  auto with = published<false>(1e3);
  with.friction = 0.0;
  System2 a = disks(with, x, 0.5, 6.2);
  System2 b = disks(published<false, false>(1e3), x, 0.5, 6.2);
  RandomStream random(4, RandomPurpose::test, 0);
  for (std::size_t u = 0; u < x.size(); ++u)
    for (int k = 0; k < 2; ++k) a.particles.velocity[u][k] = b.particles.velocity[u][k] = random.uniform() - 0.5;
  VelocityVerlet<2> step_a(1e-3);
  VelocityVerlet<2> step_b(1e-3);
  step_a.initialise(a);
  step_b.initialise(b);
  for (int k = 0; k < 3000; ++k) {
    step_a.step(a);
    step_b.step(b);
  }
  EXPECT_FALSE(b.contacts.has_spring);
  EXPECT_GT(contact_records(b).size(), 20U);
  for (std::size_t u = 0; u < x.size(); ++u) {
    EXPECT_EQ(a.particles.sphere[u].x, b.particles.sphere[u].x) << u;
    EXPECT_EQ(a.particles.velocity[u], b.particles.velocity[u]) << u;
    EXPECT_EQ(b.particles.spin[u][0], 0.0) << u;
  }
}

TEST(CohesiveDisk, ThreadsChangeNoBit) {
  std::vector<Vec<2>> x;
  for (int k = 0; k < 4900; ++k) x.push_back({{0.9999 * (k % 70) + 0.5, 0.9999 * (k / 70) + 0.5}});
  const int before = omp_get_max_threads();
  std::vector<System2> passed;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    passed.push_back(disks(published<true>(1e4), x, 0.5, 70.0));
    System2& s = passed.back();
    for (std::size_t k = 0; k < x.size(); ++k) s.particles.spin[k][0] = 0.01 * static_cast<double>(k % 13);
    force_pass(s, 1e-3);
  }
  omp_set_num_threads(before);
  ASSERT_GT(passed[0].contacts.size(), 8000) << "too small for the parallel path";
  bool turns = false;
  for (std::size_t k = 0; k < x.size(); ++k) {
    turns = turns || passed[0].particles.torque[k][0] != 0.0;
    for (const std::size_t other : {1U, 2U}) {
      EXPECT_EQ(passed[0].particles.torque[k], passed[other].particles.torque[k]) << k;
      EXPECT_EQ(passed[0].particles.force[k], passed[other].particles.force[k]) << k;
    }
  }
  EXPECT_TRUE(turns);
}

}  // namespace
}  // namespace softgrain
