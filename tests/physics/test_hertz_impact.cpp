// Elastic impacts against the closed forms; energy and order of the integrator.
#include <gtest/gtest.h>

#include "common/dynamics/force_pass.h"
#include "tests/support/impact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Material kSteel{"steel", 7800.0, 2.1e11, 0.3, false};

void expect_closed_form(const ImpactSetup& setup) {
  const HertzCoefficients k = HertzCoefficients::of(kSteel, kSteel, 0.0, 1.0);
  System3 s = impact_system(setup, hertz_law(k, false), kSteel);
  const HertzImpact expected =
      hertz_impact(std::sqrt(effective_radius(setup)) * k.inverse_d, effective_mass(s), setup.speed);
  const ImpactOutcome out = collide(s, setup.partner, expected.duration / 200.0, 2000);
  EXPECT_NEAR(out.duration / expected.duration, 1.0, 1e-4);
  EXPECT_NEAR(out.max_overlap / expected.overlap, 1.0, 1e-4);
  EXPECT_NEAR(out.restitution, 1.0, 1e-5);
}

TEST(HertzImpact, ClosedFormForSpheresPlanesShells) {
  for (const double ratio : {1.0, 7.0, 1000.0}) expect_closed_form({Partner::sphere, 0.005, ratio, 0.7});
  expect_closed_form({Partner::plane, 0.005, 1.0, 0.7});
  for (const double ratio : {1.2, 10.0}) expect_closed_form({Partner::shell_inside, 0.005, ratio, 0.7});
}

TEST(HertzImpact, EffectiveModulusOfTwoMaterials) {
  const Material soft{"soft", 1000.0, 1e8, 0.45, false};
  Material rigid{"rigid", 0.0, 0.0, 0.0, true};
  // 1/D = 4/3 E*, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
  const double compliance = (1.0 - 0.45 * 0.45) / 1e8 + (1.0 - 0.3 * 0.3) / 2.1e11;
  EXPECT_NEAR(HertzCoefficients::of(soft, kSteel, 0.0, 1.0).inverse_d * compliance, 4.0 / 3.0, 1e-14);
  EXPECT_NEAR(HertzCoefficients::of(soft, rigid, 0.0, 1.0).inverse_d * (1.0 - 0.45 * 0.45) / 1e8, 4.0 / 3.0, 1e-14);
  EXPECT_NEAR(HertzCoefficients::of(soft, soft, 0.0, 1.0).shear * (2.0 - 0.45) * (1.0 + 0.45) / 2e8, 1.0, 1e-14);
}

/// Frictionless Hertz gas inside a fixed shell.
System3 gas() {
  System3 s = hertz_system<3>(0.0, 1.0, false);
  RandomStream random(11, RandomPurpose::test, 0);
  for (const Vec3& x : shaken_lattice<3>({}, 0.33, 3, 4)) {
    NewBody<3> grain = test_sphere<3>(x, 0.14, 2500.0, 27);
    for (int k = 0; k < 3; ++k) grain.velocity[k] = 2.0 * random.uniform() - 1.0;
    add_grain(s.particles, grain);
  }
  NewBody<3> shell;
  shell.r = 0.75;
  add_shell(s.particles, shell);
  return s;
}

/// Kinetic and Hertz energy, (2/5) F h per contact.
double total_energy(const System3& s) {
  double sum = kinetic_energy(s.particles);
  for (const auto& c : contact_records(s)) sum += 0.4 * c.normal_force * c.overlap;
  return sum;
}

/// Root mean square of the relative energy error over the run.
double energy_error(double step, int steps) {
  System3 s = gas();
  VelocityVerlet<3> integrator(step);
  integrator.initialise(s);
  const double before = total_energy(s);
  double sum = 0.0;
  for (int k = 0; k < steps; ++k) {
    integrator.step(s);
    sum += std::pow(total_energy(s) / before - 1.0, 2);
  }
  return std::sqrt(sum / steps);
}

TEST(Integrator, EnergyErrorOfAHertzGasIsFourfoldSmallerAtHalfTheStep) {
  const double coarse = energy_error(1e-4, 1500);
  const double fine = energy_error(5e-5, 3000);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.6) << coarse << " " << fine;
}

/// Error of position and velocity after a while of a ball that swings on a linear spring with dashpot under gravity,
/// always in contact: x'' = -w^2 (x - x_rest) - 2 zeta w x'.
double oscillator_error(double zeta, int steps) {
  const double w = 2.0 * std::numbers::pi;
  const double amplitude = 1e-3;
  const ImpactSetup setup{Partner::plane, 0.1, 1.0, 0.0};
  System3 s = impact_system(setup, LinearSpring{}, kSteel);
  const double mass = 1.0 / s.particles.inverse_mass[0];
  s.laws = LawSet(1);
  s.laws.set(0, 0, LinearSpring{mass * w * w, 0.0, 0.0, zeta});
  s.gravity = {{0.0, 0.0, -9.81}};
  const double rest = 0.1 - 9.81 / (w * w);
  s.particles.sphere[0].x[2] = rest + amplitude;
  s.particles.velocity[0] = {};
  VelocityVerlet<3> integrator(0.8 / steps);
  integrator.initialise(s);
  for (int k = 0; k < steps; ++k) integrator.step(s);
  const double wd = w * std::sqrt(1.0 - zeta * zeta);
  const double phase = wd * 0.8;
  const double x = amplitude * std::exp(-zeta * w * 0.8) * (std::cos(phase) + zeta * w / wd * std::sin(phase));
  return std::abs(s.particles.sphere[0].x[2] - rest - x) / amplitude;
}

TEST(Integrator, SecondOrderWithAndWithoutDamping) {
  for (const double zeta : {0.0, 0.1, 0.5}) {
    const double coarse = oscillator_error(zeta, 200);
    const double fine = oscillator_error(zeta, 400);
    EXPECT_LT(coarse, 1e-2);
    EXPECT_NEAR(coarse / fine, 4.0, 0.3) << "zeta " << zeta;
  }
}

}  // namespace
