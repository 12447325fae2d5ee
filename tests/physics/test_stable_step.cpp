// The largest stable step of a network of contacts: closed forms, and steps just below and above it.
#include "common/dynamics/time_step.h"

#include <gtest/gtest.h>

#include "common/dynamics/verlet.h"
#include "tests/support/small_packing.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kRadius = 0.01;
constexpr double kMass = 2500.0 * 4.0 / 3.0 * std::numbers::pi * kRadius * kRadius * kRadius;
constexpr double kStiffness = 1000.0;

System3 pair_of_springs(double tangential, double damping) {
  LinearSpring law;
  law.normal = kStiffness;
  law.tangential = tangential;
  law.friction = tangential > 0.0 ? 1e9 : 0.0;
  law.damping = damping;
  System3 s;
  s.materials.resize(1);
  s.laws = LawSet(1);
  s.laws.set(0, 0, law);
  for (const double x : {0.0, 1.9 * kRadius}) add_grain(s.particles, test_sphere<3>({{x, 0.0, 0.0}}, kRadius, 2500.0));
  return s;
}

double network_step(const System3& s) { return stable_step(s, std::numeric_limits<double>::infinity()).step; }

TEST(StableStep, OfTwoGrainsIsThatOfTheirOscillators) {
  EXPECT_EQ(stable_step(hertz_system<3>(0.3, 0.9, false), 1.0).step, std::numeric_limits<double>::infinity());
  const double unit = std::sqrt(kMass / kStiffness);
  EXPECT_NEAR(network_step(pair_of_springs(0.0, 0.0)), std::sqrt(2.0) * unit, 2e-3 * unit)
      << "2/omega, omega^2 = 2 k/m";
  // omega^2 = 2 k/m, gamma = 2 zeta omega
  for (const double zeta : {0.05, 0.3, 1.0}) {
    const double omega = std::sqrt(2.0) / unit;
    const double gamma = 2.0 * zeta * omega;
    EXPECT_NEAR(network_step(pair_of_springs(0.0, zeta)),
                2.0 * (std::sqrt(omega * omega + gamma * gamma) - gamma) / (omega * omega), 3e-3 * unit)
        << zeta;
  }
  // Sliding and both spins: slip^2 at the contact over sum m u^2 + I w^2 has 2/m + 2 a^2/I = (2 + 5 a^2/R^2)/m.
  const double across = 2.0 + 5.0 * 0.95 * 0.95;
  EXPECT_NEAR(network_step(pair_of_springs(kStiffness, 0.0)), std::sqrt(2.0 / across) * unit, 2e-3 * unit)
      << "tangential springs: sqrt(2)/omega";
}

SoftUnloading soft_law(const UnloadingBranch& branch) {
  SoftUnloading law;
  law.normal = threshold_term(0.58, 2.8, 0.065);
  law.delta = 0.065;
  law.modulus = 5e5;
  law.partner_is_soft = true;
  law.branch = branch;
  return law;
}

/// Stiffness of loading at this Delta, and that at which the contact begins to unload from there [N/m].
std::pair<double, double> slopes(const SoftUnloading& law, double ratio) {
  const double unit = law.modulus * kRadius;
  const double force = law.normal.a * (std::pow(ratio, law.normal.b) - std::pow(law.delta, law.normal.b));
  return {unit * law.normal.a * law.normal.b * std::pow(ratio, law.normal.b - 1.0),
          unit * law.branch.exponent * force / ((1.0 - law.branch.residual) * (ratio - law.delta))};
}

System3 two_spheres(const AnyLaw& law, double overlap_ratio) {
  System3 s;
  s.materials.resize(1);
  s.laws = LawSet(1);
  s.laws.set(0, 0, law);
  for (const double x : {0.0, (2.0 - overlap_ratio) * kRadius})
    add_grain(s.particles, test_sphere<3>({{x, 0.0, 0.0}}, kRadius, 2500.0));
  return s;
}

/// The step goes by the way back where that is steeper, up to the end of a clamped law.
TEST(StepLimit, TakesTheSteeperOfLoadingAndUnloading) {
  for (const double residual : {0.0, 0.5, 0.8, 0.95}) {
    SoftUnloading law = soft_law({residual, least_unloading_exponent(residual, 2.8)});
    const auto [loading, unloading] = slopes(law, 0.35);
    const StepLimit limit = step_limit(two_spheres(law, -1.0));
    EXPECT_NEAR(limit.stiffness / std::max(loading, unloading), 1.0, 1e-12) << residual;
    EXPECT_NEAR(limit.natural_time / std::sqrt(kMass / limit.stiffness), 1.0, 1e-12);
    EXPECT_EQ(unloading > loading, residual != 0.5) << "of both kinds";
    EXPECT_NEAR(step_limit(two_spheres(static_cast<SoftContact>(law), -1.0)).stiffness / loading, 1.0, 1e-12);
    law.range = {0.2, Extrapolation::clamp};
    const auto [at_end, back] = slopes(law, 0.2);
    EXPECT_NEAR(step_limit(two_spheres(law, -1.0)).stiffness / std::max(at_end, back), 1.0, 1e-12) << residual;
  }
}

/// Of a contact whose tangential spring is far stiffer than the normal one, the network of two bodies says the same.
TEST(SlideLimit, IsThatOfTwoBodiesThatTouch) {
  LinearSpring law;
  law.normal = 1e3;
  law.friction = 0.5;
  for (const double stiffer : {10.0, 1e4}) {
    law.tangential = stiffer * law.normal;
    const System3 s = two_spheres(law, 0.01);
    const SlideLimit limit = slide_limit(s);
    EXPECT_NEAR(limit.step / std::sqrt(2.0 * kMass / (7.0 * law.tangential)), 1.0, 1e-9);
    EXPECT_NEAR(limit.step / network_step(s), 1.0, 0.01) << stiffer;
    EXPECT_EQ(limit.law, 0);
  }
  law.friction = 0.0;
  EXPECT_TRUE(std::isinf(slide_limit(two_spheres(law, 0.01)).step)) << "what slides at once bears nothing";
  EXPECT_GT(network_step(two_spheres(law, 0.01)), 1.0 * std::sqrt(kMass / law.normal));
  law.friction = 0.5;
  law.tangential = law.normal;
  EXPECT_TRUE(std::isinf(slide_limit(two_spheres(law, 0.01)).step)) << "left to the limit of the normal spring";
}

template <LawForm kLawForm>
void expect_steeper_by_unloading() {
  constexpr double kSteeper = 3.5;
  const auto law_of = []<bool kUnloading>(std::bool_constant<kUnloading>) {
    SoftMultiContact<kLawForm, kUnloading> law;
    law.form.pressure = {0.8, 3.0, 0.02, {0.5, Extrapolation::extrapolate}};
    law.form.coupling = {0.8, 0.15, 0.1};
    law.partner.common_exponent = 1.25;
    law.modulus = 5e5;
    law.j_is_soft = true;
    law.unloading = kSteeper;
    return law;
  };
  const double loading = step_limit(two_spheres(law_of(std::false_type{}), -1.0)).stiffness;
  const double unloading = step_limit(two_spheres(law_of(std::true_type{}), -1.0)).stiffness;
  EXPECT_GT(loading, 0.0);
  EXPECT_NEAR(unloading / loading, kSteeper, 1e-9) << to_string(kLawForm);
}

TEST(StepLimit, OfLawTablesTakesTheUnloadingBranch) {
  expect_steeper_by_unloading<LawForm::pair>();
  expect_steeper_by_unloading<LawForm::isotropic>();
  expect_steeper_by_unloading<LawForm::directional>();
}

/// Two spheres that touch: 2/omega, omega^2 = 2 k/m, k that with which they would part.
TEST(StableStep, TakesTheSteeperOfLoadingAndUnloading) {
  for (const double residual : {0.2, 0.9}) {
    const SoftUnloading law = soft_law({residual, least_unloading_exponent(residual, 2.8)});
    const double unit = std::sqrt(kMass / slopes(law, 0.25).second);
    EXPECT_NEAR(network_step(two_spheres(law, 0.25)), std::sqrt(2.0) * unit, 2e-3 * unit) << residual;
  }
}

TEST(StableStep, ABoundFromSumsIsBelowItAndNotFar) {
  for (const double tangential : {0.0, 300.0, kStiffness})
    for (const double zeta : {0.0, 0.2}) {
      const System3 s = pair_of_springs(tangential, zeta);
      const double bound = stable_step(s, 0.0).step;
      const double exact = network_step(s);
      EXPECT_LE(bound, 1.002 * exact);
      EXPECT_GT(bound, 0.5 * exact);
    }
}

/// Face-centred lattice `overlap` radii deep, every grain with twelve contacts; all move a little.
System3 lattice(double overlap, double friction, double restitution) {
  System3 s = hertz_system<3>(friction, restitution, true, {"a", 2500.0, 1e6, 0.2, false});
  const double edge = (2.0 - overlap) * kRadius * std::sqrt(2.0);
  s.cell = box_cell<3>({{3.0 * edge, 3.0 * edge, 3.0 * edge}}, {true, true, true});
  RandomStream random(1, RandomPurpose::test, 0);
  const double base[4][3] = {{0.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, {0.5, 0.0, 0.5}, {0.0, 0.5, 0.5}};
  for (int n = 0; n < 27; ++n)
    for (const auto& b : base) {
      const int cell[3] = {n % 3, n / 3 % 3, n / 9};
      Vec3 x;
      for (int k = 0; k < 3; ++k) x[k] = edge * (cell[k] + b[k]);
      NewBody<3> grain = test::test_sphere(x, kRadius, 2500.0);
      for (double& v : grain.velocity.v) v = 1e-5 * (random.uniform() - 0.5);
      for (double& w : grain.spin.v) w = 1e-3 * (random.uniform() - 0.5);
      add_grain(s.particles, grain);
    }
  return s;
}

/// Whether small motion grows in 300 steps.
bool grows(System3 s, double step) {
  VelocityVerlet<3> integrator(step);
  integrator.initialise(s);
  const double start = kinetic_energy(s.particles);
  for (int k = 0; k < 60; ++k) {
    integrator.advance(s, 5);
    if (kinetic_energy(s.particles) > 100.0 * start) return true;
  }
  return false;
}

TEST(StableStep, StepsBelowItHoldAndStepsAboveItDoNot) {
  for (const double overlap : {0.4, 0.05})
    for (const double friction : {0.0, 0.3})
      for (const double restitution : {1.0, 0.5, 0.1}) {
        const System3 s = lattice(overlap, friction, restitution);
        const double limit = network_step(s);
        EXPECT_FALSE(grows(s, kLargestStableShare * limit)) << overlap << " " << friction << " " << restitution;
        EXPECT_TRUE(grows(s, 1.15 * limit)) << overlap << " " << friction << " " << restitution;
        EXPECT_LE(stable_step(s, 0.0).step, limit);
      }
}

TEST(StableStep, SpringsAloneAllowMore) {
  const double infinite = std::numeric_limits<double>::infinity();
  const double springs = stable_step(lattice(0.05, 0.3, 0.5), infinite, Dashpots::leave_out).step;
  EXPECT_GT(springs, 1.5 * network_step(lattice(0.05, 0.3, 0.5)));
  EXPECT_NEAR(springs, network_step(lattice(0.05, 0.3, 1.0)), 1e-3 * springs) << "nothing else sets them apart";
}

TEST(StableStep, LooksAndTouchesNothing) {
  const System3 s = lattice(0.05, 0.3, 0.5);
  const System3 before = s;
  const StableStep a = stable_step(s, 1.0);
  const StableStep b = stable_step(s, 1.0);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.contacts, 12);
  expect_same_state(before, s);
}

}  // namespace
