// Small systems for tests: grains that fall inside a shell onto a plane that cuts it, and beside it in the open.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <vector>

#include "common/core/random.h"
#include "common/system.h"

namespace softgrain::test {

template <int D>
NewBody<D> test_sphere(const Vec<D>& x, double r, double density, Slot shell = -1) {
  NewBody<D> body;
  body.x = x;
  body.r = r;
  body.mass = density * 4.0 / 3.0 * std::numbers::pi * r * r * r;
  body.inertia = 0.4 * body.mass * r * r;
  body.shell = shell;
  return body;
}

inline Material glass() { return {"glass", 2500.0, 1e7, 0.25, false}; }

/// One material, one Hertz law for everything.
template <int D>
System<D> hertz_system(double friction, double restitution, bool rescaled, const Material& material = glass()) {
  System<D> s;
  s.materials = {material};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(material, material, friction, restitution), rescaled));
  return s;
}

/// Centres on a cubic lattice of spacing `a` around `centre`, shaken by a tenth of it.
template <int D>
std::vector<Vec<D>> shaken_lattice(const Vec<D>& centre, double a, int per_axis, std::uint64_t seed) {
  RandomStream random(seed, RandomPurpose::test, 0);
  std::vector<Vec<D>> out;
  int total = 1;
  for (int k = 0; k < D; ++k) total *= per_axis;
  for (int n = 0; n < total; ++n) {
    Vec<D> x = centre;
    int rest = n;
    for (int k = 0; k < D; ++k, rest /= per_axis)
      x[k] += a * (rest % per_axis - 0.5 * (per_axis - 1) + 0.2 * (random.uniform() - 0.5));
    out.push_back(x);
  }
  return out;
}

/// Lattices of grains inside a shell of radius 1 at the origin and outside at x = 4; planes z = -0.6 (cuts the shell)
/// and a slope; random velocities and spins.
template <int D>
System<D> shell_and_plane_system(double friction, double restitution, bool rescaled) {
  System<D> s = hertz_system<D>(friction, restitution, rescaled);
  s.gravity[D - 1] = -9.81;
  RandomStream random(7, RandomPurpose::test, 1);
  const auto add = [&](const Vec<D>& x, Slot shell) {
    NewBody<D> grain = test_sphere(x, 0.12 + 0.03 * random.uniform(), 2500.0, shell);
    for (int k = 0; k < D; ++k) grain.velocity[k] = random.uniform() - 0.5;
    for (double& w : grain.spin.v) w = 4.0 * random.uniform() - 2.0;
    add_grain(s.particles, grain);
  };
  const auto inner = shaken_lattice<D>({}, 0.31, 3, 1);
  Vec<D> beside{};
  beside[0] = 4.0;
  const auto outer = shaken_lattice<D>(beside, 0.31, 3, 2);
  const auto shell = static_cast<Slot>(inner.size() + outer.size());
  for (const Vec<D>& x : inner) add(x, shell);
  for (const Vec<D>& x : outer) add(x, -1);
  NewBody<D> wall;
  wall.r = 1.0;
  add_shell(s.particles, wall);
  NewBody<D> plane;
  plane.x[D - 1] = -0.6;
  Vec<D> up{};
  up[D - 1] = 1.0;
  add_plane(s.particles, plane, up);
  plane.x = {};
  plane.x[0] = -1.5;
  Vec<D> slope{};
  slope[0] = 0.6;
  slope[D - 1] = 0.8;
  add_plane(s.particles, plane, slope);
  return s;
}

/// Bitwise equality, so that NaN equals itself and -0 differs from 0.
inline bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

template <class V>
void expect_same_bits(const std::vector<V>& a, const std::vector<V>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t u = 0; u < a.size(); ++u)
    for (std::size_t k = 0; k < a[u].v.size(); ++k)
      ASSERT_TRUE(same_bits(a[u].v[k], b[u].v[k])) << what << " of " << u << ": " << a[u].v[k] << ", " << b[u].v[k];
}

/// Motion, forces and histories of two systems are the same bits.
template <int D>
void expect_same_state(const System<D>& a, const System<D>& b) {
  ASSERT_EQ(a.particles.size(), b.particles.size());
  for (std::size_t u = 0; u < a.particles.sphere.size(); ++u) {
    for (int k = 0; k < D; ++k)
      ASSERT_TRUE(same_bits(a.particles.sphere[u].x[k], b.particles.sphere[u].x[k])) << "position of " << u;
    ASSERT_TRUE(same_bits(a.particles.sphere[u].r, b.particles.sphere[u].r)) << "radius of " << u;
  }
  expect_same_bits(a.particles.velocity, b.particles.velocity, "velocity");
  expect_same_bits(a.particles.spin, b.particles.spin, "spin");
  expect_same_bits(a.particles.force, b.particles.force, "force");
  expect_same_bits(a.particles.torque, b.particles.torque, "torque");
  expect_same_bits(a.contacts.spring, b.contacts.spring, "spring");
  EXPECT_EQ(a.contacts.i, b.contacts.i);
  EXPECT_EQ(a.contacts.j, b.contacts.j);
  EXPECT_EQ(a.contacts.image, b.contacts.image);
  EXPECT_EQ(a.contacts.memory, b.contacts.memory);
  EXPECT_EQ(a.particles.largest_volume, b.particles.largest_volume);
  expect_same_bits(a.contacts.roll, b.contacts.roll, "roll");
  EXPECT_TRUE(a.cell.edges == b.cell.edges);
  EXPECT_TRUE(same_bits(a.time, b.time));
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.neighbours.rebuilds, b.neighbours.rebuilds);
  EXPECT_EQ(a.cost.loop_passes, b.cost.loop_passes);
  EXPECT_EQ(a.cost.contact_evaluations, b.cost.contact_evaluations);
}

}  // namespace softgrain::test
