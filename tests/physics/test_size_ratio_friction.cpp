// Friction at large size ratios. A small grain rolls down the groove between two fixed large ones. The larger they are,
// the narrower the wedge that it sits in, so that a small spurious sliding in the direction of the wedge pulls it in
// and holds it. The usual velocity Verlet, where forces see the velocities of the half step and the normals of the full
// one, makes such sliding out of nothing but the turning of the normals: v dt/2 per radian that the grain goes round.
// Reported by Vyas, Ottino, Lueptow and Umbanhowar, Computer Physics Communications 310 (2025) 109524 (arXiv
// 2410.14798).
#include <gtest/gtest.h>

#include <cmath>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "tests/support/small_packing.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kGravity = 9.81;
constexpr double kSmall = 1e-3;  // radius of the small grain [m]

/// Large over small radius, and a friction that matters in a wedge as narrow as theirs.
struct Groove {
  double ratio = 1.0;
  double mu = 0.5;

  /// Distance of the small grain's centre from the line through the large ones, which touch [m].
  [[nodiscard]] double orbit() const { return kSmall * std::sqrt(2.0 * ratio + 1.0); }
  /// Unit of time [s].
  [[nodiscard]] double fall() const { return std::sqrt(orbit() / kGravity); }
};

/// The small grain (slot 0) rests 1 rad from the top; the large ones lie along x and do not move.
System3 groove_system(const Groove& groove) {
  constexpr double kAngle = 1.0;
  System3 s = hertz_system<3>(groove.mu, 0.5, false);
  const double h = groove.orbit();
  add_grain(s.particles, test_sphere<3>({{0.0, h * std::sin(kAngle), h * std::cos(kAngle)}}, kSmall, 2500.0));
  for (const double side : {-1.0, 1.0}) {
    NewBody<3> large;
    large.r = groove.ratio * kSmall;
    large.x = {{side * large.r, 0.0, 0.0}};
    add_grain(s.particles, large);
  }
  s.gravity = {{0.0, 0.0, -kGravity}};
  return s;
}

/// What is compared with: forces see the velocities and spins of the half step.
void half_step_verlet(System3& s, double dt) {
  auto& p = s.particles;
  const auto kick = [&] {
    for (std::size_t u = 0; u < p.force.size(); ++u) {
      p.velocity[u] += p.force[u] * (0.5 * dt * p.inverse_mass[u]);
      p.spin[u] += p.torque[u] * (0.5 * dt * p.inverse_inertia[u]);
    }
  };
  kick();
  for (std::size_t u = 0; u < p.force.size(); ++u) p.sphere[u].x += p.velocity[u] * dt;
  force_pass(s, dt);
  add_gravity(s);
  kick();
  s.contacts.commit();
  s.time += dt;
}

enum class Velocities { half_step, full_step };

/// When the grain has rolled off the large ones and fallen 1.5 orbits below them, in units of Groove::fall; 18 when it
/// has not by then. `fraction`: step over sqrt(m/k).
double time_of_fall(const Groove& groove, Velocities seen, double fraction) {
  System3 s = groove_system(groove);
  const double dt = fraction * step_limit(s).natural_time;
  VelocityVerlet<3> ours(dt);
  ours.initialise(s);
  constexpr double kLongest = 18.0;
  while (s.time < kLongest * groove.fall()) {
    if (seen == Velocities::full_step)
      ours.step(s);
    else
      half_step_verlet(s, dt);
    if (s.particles.sphere[0].x[2] < -1.5 * groove.orbit()) return s.time / groove.fall();
  }
  return kLongest;
}

/// The limit of small steps, from the scheme that is not ours: its error is of first order, so that two steps tell it.
double true_time_of_fall(const Groove& groove) {
  constexpr double kFine = 0.0125;
  return 2.0 * time_of_fall(groove, Velocities::half_step, kFine) -
         time_of_fall(groove, Velocities::half_step, 2.0 * kFine);
}

TEST(SizeRatioFriction, LargeStepsDoNotHoldSmallGrains) {
  for (const Groove& groove : {Groove{1.0, 0.5}, Groove{10.0, 0.8}, Groove{40.0, 0.5}, Groove{100.0, 0.3}}) {
    const double truth = true_time_of_fall(groove);
    ASSERT_LT(truth, 10.0) << "ratio " << groove.ratio;
    for (const double fraction : {0.05, 0.2, 0.3})
      EXPECT_NEAR(time_of_fall(groove, Velocities::full_step, fraction) / truth, 1.0, 2e-3)
          << "ratio " << groove.ratio << ", step " << fraction;
  }
}

TEST(SizeRatioFriction, HalfStepVelocitiesWouldHoldThem) {
  const double equal = time_of_fall({1.0, 0.5}, Velocities::half_step, 0.2) / true_time_of_fall({1.0, 0.5});
  EXPECT_NEAR(equal, 1.0, 2e-3) << "no trouble with equal grains";
  for (const Groove& groove : {Groove{10.0, 0.8}, Groove{40.0, 0.5}, Groove{100.0, 0.3}})
    EXPECT_GT(time_of_fall(groove, Velocities::half_step, 0.2) / true_time_of_fall(groove), 1.03)
        << "ratio " << groove.ratio << ": the error that the other test looks for would not show here";
  EXPECT_EQ(time_of_fall({40.0, 0.5}, Velocities::half_step, 0.3), 18.0) << "held for good";
}

}  // namespace
