// Rolling resistance of spheres: closed forms of a ball on a plane, numbers of LAMMPS, and what no law may do.
#include <gtest/gtest.h>
#include <omp.h>

#include "common/dynamics/contact_watch.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/time_step.h"
#include "common/state/system_io.h"
#include "tests/support/impact.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kBall = 0.01;  // radius
constexpr double kGravity = 9.81;
constexpr double kDensity = 2500.0;

double ball_mass() { return kDensity * kSphereVolume * kBall * kBall * kBall; }

/// Of a ball of this size; the weight presses it in by 1e-4 of its radius.
LinearSpringLaw<true> ball_law(double mu_r, double restitution) {
  const double normal = 1e4 * ball_mass() * kGravity / kBall;
  return {normal, 0.8 * normal, 0.9, LinearSpring::zeta(restitution), {mu_r, 1.0, 1.0}};
}

AnyLaw hertz_ball_law(double mu_r, bool rescaled) {
  const Material soft{"soft", kDensity, 1e7, 0.2, false};
  return hertz_law(HertzCoefficients::of(soft, soft, 0.9, 0.5, {mu_r, 1.0, 1.0}), rescaled);
}

/// A ball in touch with the plane z = 0, where its weight is borne, under gravity that is inclined towards x.
System3 ball_on_plane(const AnyLaw& law, double slope = 0.0) {
  System3 s;
  s.materials = {{"ball", kDensity, 1e7, 0.2, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, law);
  s.gravity = {{kGravity * std::sin(slope), 0.0, -kGravity * std::cos(slope)}};
  add_grain(s.particles, test_sphere<3>({{0.0, 0.0, kBall}}, kBall, kDensity));
  add_plane(s.particles, NewBody<3>{}, Vec3{{0.0, 0.0, 1.0}});
  const double weight = ball_mass() * kGravity * std::cos(slope);
  const double overlap = std::visit(
      [&]<class Law>(const Law& l) {
        if constexpr (requires { l.k; })
          return std::pow(weight / (std::sqrt(kBall) * l.k.inverse_d), 2.0 / 3.0);
        else if constexpr (requires { l.normal + l.tangential; })
          return weight / l.normal;
        return 0.0;
      },
      law);
  s.particles.sphere[0].x[2] -= overlap;
  return s;
}

void roll_on(System3& s, double speed) {
  s.particles.velocity[0][0] = speed;
  s.particles.spin[0][1] = speed / kBall;
}

std::vector<AnyLaw> ball_laws(double mu_r) {
  return {ball_law(mu_r, 0.5), hertz_ball_law(mu_r, false), hertz_ball_law(mu_r, true)};
}

/// (m + I/R^2) a = -mu_r m g.
TEST(RollingResistance, ARollingBallStopsWhereTheClosedFormSays) {
  constexpr double kSpeed = 0.1;
  for (const double mu_r : {0.03, 0.1})
    for (const AnyLaw& law : ball_laws(mu_r)) {
      System3 s = ball_on_plane(law);
      roll_on(s, kSpeed);
      VelocityVerlet<3> motion(2e-5);
      motion.initialise(s);
      for (int k = 0; k < 100000 && s.particles.velocity[0][0] > 0.0; ++k) motion.step(s);
      const double slowing = 5.0 / 7.0 * mu_r * kGravity;
      EXPECT_NEAR(s.time / (kSpeed / slowing), 1.0, 0.01) << mu_r << ", law " << law.index();
      EXPECT_NEAR(s.particles.sphere[0].x[0] / (0.5 * kSpeed * kSpeed / slowing), 1.0, 0.01) << law.index();
    }
}

/// Up to tan(slope) = mu_r a ball rests on its springs; above it rolls: (m + I/a^2) x'' = m g (sin - mu_r R/a cos) with
/// the arm a of the contact, R but for half the overlap.
TEST(RollingResistance, ABallRestsOnAnInclineUpToItsLimit) {
  constexpr double kMuR = 0.2;
  for (const AnyLaw& law : ball_laws(kMuR))
    for (const double share : {0.5, 0.95, 1.05, 2.0}) {
      const double slope = std::atan(share * kMuR);
      System3 s = ball_on_plane(law, slope);
      VelocityVerlet<3> motion(2e-5);
      motion.initialise(s);
      for (int k = 0; k < 10000; ++k) motion.step(s);
      const double early = s.particles.velocity[0][0];
      const double begin = s.time;
      for (int k = 0; k < 10000; ++k) motion.step(s);
      const double acceleration = (s.particles.velocity[0][0] - early) / (s.time - begin);
      const double arm = kBall - 0.5 * (kBall - s.particles.sphere[0].x[2]);
      const double exact = kGravity * (std::sin(slope) - kMuR * kBall / arm * std::cos(slope)) /
                           (1.0 + 0.4 * kBall * kBall / (arm * arm));
      if (share < 1.0) {
        EXPECT_LT(std::abs(s.particles.velocity[0][0]), 1e-6) << share << ", law " << law.index();
        EXPECT_LT(s.particles.sphere[0].x[0], 0.1 * kBall) << share;
      } else {
        EXPECT_NEAR(acceleration / exact, 1.0, 1e-3) << share << ", law " << law.index();
      }
    }
}

/// Two springs, of sliding and of rolling: m x'' = -kt u, I w'' = R kt u - Kr w, u = x - R w.
TEST(RollingResistance, SmallRollingSwingsWithTheFrequencyOfItsSpring) {
  LinearSpringLaw<true> law = ball_law(50.0, 1.0);
  law.friction = 50.0;
  law.rolling.stiffness = 0.02;
  System3 s = ball_on_plane(law);
  const double arm = kBall - 0.5 * ball_mass() * kGravity / law.normal;
  const double mass = ball_mass();
  const double inertia = 0.4 * mass * kBall * kBall;
  const double a = law.tangential / mass;
  const double d = (arm * arm * law.tangential + law.rolling.stiffness * law.tangential * kBall * kBall) / inertia;
  const double coupling2 = arm * arm * law.tangential * law.tangential / (mass * inertia);
  const double omega2 = 0.5 * (a + d) - std::sqrt(0.25 * (a - d) * (a - d) + coupling2);
  roll_on(s, 1e-6);
  s.particles.spin[0][1] = 1e-6 * (a - omega2) / (arm * a);  // of the slow mode alone
  const double period = 2.0 * std::numbers::pi / std::sqrt(omega2);
  const double step = 1e-4 * period;
  VelocityVerlet<3> motion(step);
  motion.initialise(s);
  std::vector<double> crossings;
  double last = s.particles.velocity[0][0];
  while (crossings.size() < 9 && s.time < 10.0 * period) {
    motion.step(s);
    const double now = s.particles.velocity[0][0];
    if ((now < 0.0) != (last < 0.0)) crossings.push_back(s.time - step * now / (now - last));
    last = now;
  }
  ASSERT_EQ(crossings.size(), 9U);
  EXPECT_NEAR((crossings[8] - crossings[0]) / (4.0 * period), 1.0, 2e-3);
  EXPECT_GT(period, 5.0 * 2.0 * std::numbers::pi / std::sqrt(a + d)) << "the fast mode is another one";
}

struct LammpsCase {
  RollingResistance rolling{};
  std::array<Vec3, 2> velocity{};
  std::array<Vec3, 2> spin{};
};

/// Two spheres collide: LAMMPS of 29 Sep 2021, pair_style granular, "hooke 1e6 1 damping velocity tangential
/// linear_history 8e5 1 0.6 rolling sds kr gr mu_r" (package GRANULAR), time step 1e-8 s.
TEST(RollingResistance, ACollisionEndsAsInLammps) {
  const std::vector<LammpsCase> cases{
      {{10.0, 1.0, 1.0},
       {{{{0.0792098065271, 0.0529774589748, 0.391932041711}},
         {{-0.00365122581589, -0.0103721823719, -0.111491505214}}}},
       {{{{-5.24180086173, 3.12774173347, 8.0043723873}}, {{-2.26519272282, 2.75203294261, 2.99919126277}}}}},
      {{0.02, 1.0, 1.0},
       {{{{0.0241385783436, -0.0392449602558, 0.391923654185}},
         {{0.00323267770704, 0.00115562003198, -0.111490456773}}}},
       {{{{15.0738428607, -7.2746837359, 7.99918859517}}, {{-5.05792493394, 4.36544880057, 2.99990397684}}}}},
      {{0.1, 2.5, 0.5},
       {{{{0.0402058544073, -0.00632081999662, 0.391931070658}},
         {{0.00122426819909, -0.00295989750042, -0.111491383832}}}},
       {{{{12.6346979216, -6.28216096248, 7.99951895259}}, {{-4.2113362232, 3.95860803155, 2.99973881178}}}}}};
  for (const LammpsCase& c : cases) {
    System3 s;
    s.materials.resize(1);
    s.laws = LawSet(1);
    add_grain(s.particles, test_sphere<3>({{0.0, 0.0, 0.00999}}, 0.01, 2500.0));
    add_grain(s.particles, test_sphere<3>({{0.0, 0.0, -0.02}}, 0.02, 2500.0));
    s.particles.velocity[0] = Vec3{{0.05, -0.03, -0.5}};
    s.particles.spin[0] = Vec3{{20.0, -15.0, 8.0}};
    s.particles.spin[1] = Vec3{{-5.0, 4.0, 3.0}};
    const double mass = 1.0 / (s.particles.inverse_mass[0] + s.particles.inverse_mass[1]);
    s.laws.set(0, 0, LinearSpringLaw<true>{1e6, 8e5, 0.6, 1.0 / (2.0 * std::sqrt(1e6 * mass)), c.rolling});
    VelocityVerlet<3> motion(1e-7);
    motion.initialise(s);
    for (int k = 0; k < 6000; ++k) motion.step(s);
    for (std::size_t u = 0; u < 2; ++u) {
      EXPECT_LT(norm(s.particles.velocity[u] - c.velocity[u]), 1e-3 * 0.5) << "mu_r " << c.rolling.friction;
      EXPECT_LT(norm(s.particles.spin[u] - c.spin[u]), 5e-3 * 26.0) << "mu_r " << c.rolling.friction;
    }
  }
}

const Material kGlassBall{"glass", 2500.0, 1e8, 0.25, false};

AnyLaw rolling_glass(double mu_r, double restitution, bool rescaled) {
  return hertz_law(HertzCoefficients::of(kGlassBall, kGlassBall, 0.5, restitution, {mu_r, 1.0, 1.0}), rescaled);
}

/// Momenta are kept, and energy falls: by more, the larger mu_r is, as long as contacts slip against it.
TEST(RollingResistance, ImpactsKeepMomentaAndMakeNoEnergy) {
  for (const Partner partner : {Partner::sphere, Partner::plane, Partner::shell_inside})
    for (const double restitution : {1.0, 0.6})
      for (const double mu_r : {0.02, 0.3, 5.0})
        for (const double spin : {-0.9, 0.0, 1.5}) {
          ImpactSetup setup{partner, 0.01, partner == Partner::shell_inside ? 3.0 : 2.0, 2.0, 1.0};
          setup.spin = {{20.0, spin * 100.0, -10.0}};
          System3 s = impact_system(setup, rolling_glass(mu_r, restitution, true), kGlassBall);
          const auto spin_sum = [&] {
            Vec3 sum{};
            for (std::size_t u = 0; u < 2; ++u) {
              if (!(s.particles.inverse_mass[u] > 0.0)) continue;
              sum += cross(s.particles.sphere[u].x, s.particles.velocity[u]) * (1.0 / s.particles.inverse_mass[u]);
              sum += s.particles.spin[u] * (1.0 / s.particles.inverse_inertia[u]);
            }
            return sum;
          };
          const Vec3 before = spin_sum();
          const ImpactOutcome out = collide(s, partner, 1e-7, 20000);
          EXPECT_TRUE(out.ended);
          EXPECT_LE(out.energy_ratio, 1.0 + 1e-6) << mu_r << ", spin " << spin << ", e " << restitution;
          if (partner == Partner::sphere) {
            EXPECT_LT(norm(spin_sum() - before), 1e-9 * norm(before)) << mu_r;
          }
        }
}

TEST(RollingResistance, TurnsWithTheSystem) {
  const Vec3 axis = Vec3{{1.0, -2.0, 2.0}} * (1.0 / 3.0);
  const auto turned = [&](const Vec3& v) { return rotate(v, axis, 1.1); };
  for (const bool rescaled : {false, true}) {
    System3 s = impact_system({Partner::sphere, 0.01, 2.0, 0.5, 0.8, {{10.0, -30.0, 20.0}}},
                              rolling_glass(0.05, 0.8, rescaled), kGlassBall);
    System3 other = s;
    for (auto& sphere : other.particles.sphere) sphere.x = turned(sphere.x);
    for (auto* vectors : {&other.particles.velocity, &other.particles.spin})
      for (Stored<3>& v : *vectors) v = turned(v);
    VelocityVerlet<3> first(1e-6);
    VelocityVerlet<3> second(1e-6);
    first.initialise(s);
    second.initialise(other);
    double rolled = 0.0;
    for (int k = 0; k < 1500; ++k) {
      first.step(s);
      second.step(other);
      for (const Stored<3>& angle : s.contacts.roll) rolled = std::max(rolled, norm(Vec3(angle)));
    }
    EXPECT_GT(rolled, 0.0);
    for (std::size_t u = 0; u < 2; ++u)
      EXPECT_LT(norm(turned(s.particles.spin[u]) - Vec3(other.particles.spin[u])), 1e-8 * 40.0);
  }
}

/// A ball that two walls hold by its centre alone swings on the springs of rolling and sliding: the largest stable step
/// knows them, and small motion grows beyond it alone.
TEST(RollingResistance, TheStableStepCountsItsSpringAndDashpot) {
  for (const double ratio : {0.1, 1.0, 30.0})
    for (const double restitution : {1.0, 0.3}) {
      LinearSpringLaw<true> law = ball_law(1e6, restitution);
      law.friction = 1e6;
      law.rolling.stiffness = ratio;
      System3 s = ball_on_plane(law);
      const double step = stable_step(s, std::numeric_limits<double>::infinity()).step;
      EXPECT_LE(stable_step(s, 0.0).step, 1.002 * step);
      const auto grows = [&](double dt) {
        System3 copy = s;
        roll_on(copy, 1e-9);
        copy.particles.spin[0][0] = 1e-7;
        VelocityVerlet<3> motion(dt);
        motion.initialise(copy);
        const double before = kinetic_energy(copy.particles);
        for (int k = 0; k < 400; ++k) motion.step(copy);
        return kinetic_energy(copy.particles) > 100.0 * before;
      };
      EXPECT_FALSE(grows(0.97 * step)) << ratio << ", e " << restitution;
      if (restitution == 1.0) {
        EXPECT_TRUE(grows(1.05 * step)) << ratio;
      }
      LinearSpringLaw<true> free = law;
      free.rolling.stiffness = 1e-9;
      if (ratio > 1.0 && restitution == 1.0) {
        EXPECT_LT(step, 0.5 * stable_step(ball_on_plane(free), HUGE_VAL).step);
        EXPECT_LT(step_limit(s).natural_time, step_limit(ball_on_plane(free)).natural_time);
      }
    }
}

/// A lattice of grains that touch, move and spin.
System3 spinning_lattice() {
  System3 s;
  s.materials = {kGlassBall};
  s.laws = LawSet(1);
  s.laws.set(0, 0, rolling_glass(0.02, 0.7, true));
  RandomStream random(2, RandomPurpose::test, 3);
  for (const Vec3& x : shaken_lattice<3>({}, 0.0195, 18, 4)) {
    NewBody<3> grain = test_sphere<3>(x, 0.01, kDensity);
    for (int k = 0; k < 3; ++k) grain.spin[k] = 20.0 * (random.uniform() - 0.5);
    add_grain(s.particles, grain);
  }
  return s;
}

TEST(RollingResistance, ThreadsAndARestartChangeNoBit) {
  const TemporaryDirectory directory;
  const int before = omp_get_max_threads();
  std::vector<System3> all;
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    all.push_back(spinning_lattice());
    VelocityVerlet<3> motion(2e-6);
    motion.initialise(all.back());
    for (int k = 0; k < 20; ++k) {
      if (k == 10 && threads == 1) {
        h5::AtomicFile file(directory.file("state.h5"));
        write_system(file.root(), all.back());
        file.commit();
      }
      motion.step(all.back());
    }
  }
  omp_set_num_threads(before);
  System3 again = spinning_lattice();
  read_system(h5::open_file(directory.file("state.h5")), again);
  VelocityVerlet<3> motion(2e-6);
  for (int k = 10; k < 20; ++k) motion.step(again);
  all.push_back(again);
  ASSERT_GT(all[0].contacts.size(), 8000) << "too small for the parallel path";
  double rolled = 0.0;
  for (const Stored<3>& angle : all[0].contacts.roll) rolled = std::max(rolled, norm(Vec3(angle)));
  EXPECT_GT(rolled, 0.0);
  for (const std::size_t other : {1U, 2U}) {
    EXPECT_EQ(all[0].particles.spin, all[other].particles.spin);
    EXPECT_EQ(all[0].particles.velocity, all[other].particles.velocity);
    EXPECT_EQ(all[0].contacts.roll, all[other].contacts.roll);
  }
}

TEST(RollingResistance, TheWatchCountsWhatTheSpringStores) {
  LinearSpringLaw<true> law = ball_law(10.0, 1.0);
  System3 s = ball_on_plane(law);
  VelocityVerlet<3> motion(1e-6);
  motion.initialise(s);
  const double before = watch_contacts(s).stored;
  ASSERT_EQ(s.contacts.roll.size(), 1U);
  s.contacts.roll[0] = Vec3{{0.0, 1e-4, 0.0}};
  const double stiffness = law.tangential * kBall * kBall;
  EXPECT_NEAR((watch_contacts(s).stored - before) / (0.5 * stiffness * 1e-8), 1.0, 1e-9);
}

}  // namespace
