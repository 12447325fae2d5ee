// What must be conserved: momentum, angular momentum, and forces that are gradients of an energy.
#include <gtest/gtest.h>

#include "common/dynamics/force_pass.h"
#include "tests/support/impact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Material kGlass{"glass", 2500.0, 1e8, 0.25, false};

Vec3 momentum(const Particles<3>& p) {
  Vec3 sum{};
  for (std::size_t u = 0; u < p.sphere.size(); ++u)
    if (p.inverse_mass[u] > 0.0) sum += p.velocity[u] * (1.0 / p.inverse_mass[u]);
  return sum;
}

/// About the origin: orbital and of the spins.
Vec3 angular_momentum(const Particles<3>& p) {
  Vec3 sum{};
  for (std::size_t u = 0; u < p.sphere.size(); ++u) {
    if (p.inverse_mass[u] > 0.0) sum += cross(p.sphere[u].x, p.velocity[u] * (1.0 / p.inverse_mass[u]));
    if (p.inverse_inertia[u] > 0.0) sum += p.spin[u] * (1.0 / p.inverse_inertia[u]);
  }
  return sum;
}

void expect_momenta_kept(const ImpactSetup& setup, bool rescaled, double e) {
  System3 s = impact_system(setup, hertz_law(HertzCoefficients::of(kGlass, kGlass, 0.5, e), rescaled), kGlass);
  const Vec3 p = momentum(s.particles);
  const Vec3 l = angular_momentum(s.particles);
  const double p_scale = norm(p);
  const double l_scale = norm(l) + p_scale * setup.radius;
  const double step =
      hertz_impact(std::sqrt(effective_radius(setup)) * HertzCoefficients::of(kGlass, kGlass, 0.0, 1.0).inverse_d,
                   effective_mass(s), setup.speed)
          .duration /
      300.0;
  const ImpactOutcome out = collide(s, setup.partner, step, 3000);
  EXPECT_TRUE(out.ended);
  EXPECT_LT(out.energy_ratio, 0.999) << "friction must have done something";
  EXPECT_LT(norm(momentum(s.particles) - p), 1e-12 * p_scale);
  // The force acts during a step while arms turn: the angular momentum of velocity Verlet is kept up to the order of
  // the step.
  EXPECT_LT(norm(angular_momentum(s.particles) - l), 1e-7 * l_scale);
}

TEST(Conservation, ObliqueFrictionalCollisionsOfSpheres) {
  for (const bool rescaled : {false, true})
    for (const double e : {0.6, 1.0})
      for (const double ratio : {1.0, 5.0})
        expect_momenta_kept({Partner::sphere, 0.01, ratio, 0.5, 0.8, {{10.0, -30.0, 20.0}}}, rescaled, e);
}

TEST(Conservation, InsideAFreeShell) {
  for (const double ratio : {1.5, 4.0})
    expect_momenta_kept({Partner::shell_inside, 0.01, ratio, 0.5, 0.8, {{10.0, -30.0, 20.0}}, true}, false, 0.8);
}

/// Contact forces of any state give no net force and no net moment.
TEST(Conservation, ActionAndReactionOfAState) {
  System3 s = impact_system({Partner::shell_inside, 0.01, 1.5, 0.5, 0.8, {{10.0, -30.0, 20.0}}, true},
                            hertz_law(HertzCoefficients::of(kGlass, kGlass, 0.5, 0.7), false), kGlass);
  s.particles.sphere[0].x[2] -= 1e-4;
  force_pass(s, 1e-6);
  const auto& p = s.particles;
  const double scale = norm(p.force[0]);
  ASSERT_GT(scale, 0.0);
  EXPECT_LT(norm(p.force[0] + p.force[1]), 1e-14 * scale);
  const Vec3 moment = cross(p.sphere[0].x, p.force[0]) + cross(p.sphere[1].x, p.force[1]) + p.torque[0] + p.torque[1];
  EXPECT_LT(norm(moment), 1e-14 * scale * p.sphere[1].r);
}

// ---- force = -dE/dx
// -------------------------------------------------------------------------------------------------------

const SoftContact kSoft{{0.6, 2.2, -0.6 * std::pow(0.05, 2.2)}, {}, 0.05, 1e8, 0.0, 0.0, true, true, {}};

/// Energy of a contact under its law.
double contact_energy(const AnyLaw& law, const ContactRecord<3>& c, double radius) {
  if (std::holds_alternative<LinearSpring>(law)) return 0.5 * c.normal_force * c.overlap;
  if (const auto* soft = std::get_if<SoftContact>(&law)) {
    // E R^3 int_delta^D (a d^b + c) dd
    const double d = c.overlap / radius;
    const auto primitive = [&](double x) {
      return soft->normal.a * std::pow(x, soft->normal.b + 1.0) / (soft->normal.b + 1.0) + soft->normal.c * x;
    };
    return soft->modulus * radius * radius * radius * (primitive(d) - primitive(soft->delta));
  }
  return 0.4 * c.normal_force * c.overlap;
}

double energy(const System3& s, const AnyLaw& law) {
  double sum = 0.0;
  for (const auto& c : contact_records(s)) {
    double radius = s.particles.sphere[static_cast<std::size_t>(c.i)].r;
    if (c.j < s.particles.grains) radius = std::min(radius, s.particles.sphere[static_cast<std::size_t>(c.j)].r);
    sum += contact_energy(law, c, radius);
  }
  return sum;
}

/// Crowded grains of different sizes, in a cell or inside a shell cut by a plane.
System3 crowd(const AnyLaw& law, bool periodic) {
  System3 s;
  s.materials = {kGlass};
  s.laws = LawSet(1);
  s.laws.set(0, 0, law);
  RandomStream random(5, RandomPurpose::test, 3);
  const auto places = shaken_lattice<3>({{0.5, 0.5, 0.5}}, 0.24, 4, 9);
  const bool walls = !periodic && !std::holds_alternative<SoftContact>(law);
  for (const Vec3& x : places)
    add_grain(s.particles, test_sphere<3>(x, 0.11 + 0.04 * random.uniform(), 2500.0, walls ? 64 : -1));
  if (periodic) {
    s.cell = box_cell<3>({{0.96, 0.96, 0.96}}, {true, true, true});
    s.cell.edges[0][1] = 0.3;
    s.cell.edges[0][2] = -0.2;
    s.cell.edges[1][2] = 0.25;
  }
  if (walls) {
    NewBody<3> shell;
    shell.x = {{0.5, 0.5, 0.5}};
    shell.r = 0.7;
    add_shell(s.particles, shell);
    NewBody<3> plane;
    plane.x = {{0.0, 0.0, 0.15}};
    add_plane(s.particles, plane, Vec3{{0.0, 0.6, 0.8}});
  }
  return s;
}

void expect_gradient(const AnyLaw& law, bool periodic) {
  System3 s = crowd(law, periodic);
  force_pass(s, 0.0);
  double largest = 0.0;
  for (const Vec3& f : s.particles.force) largest = std::max(largest, norm(f));
  ASSERT_GT(largest, 0.0);
  const double h = 1e-6;
  for (std::size_t u = 0; u < 64; u += 7)
    for (int k = 0; k < 3; ++k) {
      System3 up = s;
      System3 down = s;
      up.particles.sphere[u].x[k] += h;
      down.particles.sphere[u].x[k] -= h;
      EXPECT_NEAR(-(energy(up, law) - energy(down, law)) / (2.0 * h), s.particles.force[u][k], 1e-6 * largest)
          << u << " " << k;
    }
}

TEST(Conservation, ForceIsTheGradientOfTheEnergy) {
  for (const bool periodic : {false, true}) {
    expect_gradient(hertz_law(HertzCoefficients::of(kGlass, kGlass, 0.0, 1.0), false), periodic);
    expect_gradient(LinearSpring{1e6, 0.0, 0.0, 0.0}, periodic);
    expect_gradient(kSoft, periodic);
  }
}

}  // namespace
