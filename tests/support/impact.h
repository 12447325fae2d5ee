// One collision of two bodies, from just before to after, with what closed forms predict about it.
#pragma once

#include <cmath>
#include <numbers>

#include "common/dynamics/verlet.h"
#include "tests/support/small_packing.h"

namespace softgrain::test {

/// Hertz impact in closed form, F = K h^(3/2), reduced mass m, speed v.
struct HertzImpact {
  double overlap = 0.0;
  double force = 0.0;
  double duration = 0.0;
};

inline HertzImpact hertz_impact(double stiffness, double mass, double speed) {
  HertzImpact out;
  out.overlap = std::pow(1.25 * mass * speed * speed / stiffness, 0.4);
  out.force = stiffness * std::pow(out.overlap, 1.5);
  // int_0^1 dx/sqrt(1 - x^(5/2)) = (2/5) B(2/5, 1/2)
  out.duration = 0.8 * std::beta(0.4, 0.5) * out.overlap / speed;
  return out;
}

/// What the second body is.
enum class Partner { sphere, plane, shell_inside };

struct ImpactSetup {
  Partner partner = Partner::sphere;
  double radius = 0.01;        ///< of the moving sphere
  double ratio = 1.0;          ///< radius of the partner over it (sphere, shell)
  double speed = 1.0;          ///< along the line of centres
  double sliding_speed = 0.0;  ///< across it
  Vec3 spin{};                 ///< of the moving sphere
  bool free_shell = false;     ///< the shell has a mass
};

/// The moving sphere is body 0; the normal towards it is +z; they begin a thousandth of the overlap apart.
inline System3 impact_system(const ImpactSetup& setup, const AnyLaw& law, const Material& material) {
  System3 s;
  s.materials = {material};
  s.laws = LawSet(1);
  s.laws.set(0, 0, law);
  const double gap = 1e-6 * setup.radius;
  const double rp = setup.ratio * setup.radius;
  NewBody<3> ball = test_sphere<3>({{0.0, 0.0, setup.radius + gap}}, setup.radius, material.density);
  ball.velocity = {{setup.sliding_speed, 0.0, -setup.speed}};
  ball.spin = setup.spin;
  if (setup.partner == Partner::shell_inside) ball.shell = 1;
  add_grain(s.particles, ball);
  NewBody<3> other;
  if (setup.partner == Partner::sphere) other = test_sphere<3>({{0.0, 0.0, -rp}}, rp, material.density);
  if (setup.partner == Partner::shell_inside) {
    if (setup.free_shell) other = test_sphere<3>({}, rp, material.density);
    other.x = {{0.0, 0.0, rp}};
    other.r = rp;
  }
  if (setup.partner == Partner::sphere) add_grain(s.particles, other);
  if (setup.partner == Partner::shell_inside) add_shell(s.particles, other);
  if (setup.partner == Partner::plane) add_plane(s.particles, other, Vec3{{0.0, 0.0, 1.0}});
  return s;
}

inline double effective_radius(const ImpactSetup& setup) {
  if (setup.partner == Partner::plane) return setup.radius;
  const double rp = setup.partner == Partner::sphere ? setup.ratio * setup.radius : -setup.ratio * setup.radius;
  return setup.radius * rp / (setup.radius + rp);
}

inline double effective_mass(const System3& s) {
  return 1.0 / (s.particles.inverse_mass[0] + s.particles.inverse_mass[1]);
}

/// Overlap of the two bodies; negative: gap.
inline double overlap_of(const System3& s, Partner partner) {
  const auto& a = s.particles.sphere[0];
  const auto& b = s.particles.sphere[1];
  if (partner == Partner::plane) return a.r - (a.x[2] - b.x[2]);
  const double distance = norm(a.x - b.x);
  return partner == Partner::sphere ? a.r + b.r - distance : distance - (b.r - a.r);
}

struct ImpactOutcome {
  double max_overlap = 0.0;
  double duration = 0.0;
  double restitution = 0.0;   ///< along z
  double energy_ratio = 0.0;  ///< kinetic energy after over before
  bool ended = false;
};

/// Steps of `step` until the bodies are apart again, at most `most`.
inline ImpactOutcome collide(System3& s, Partner partner, double step, std::int64_t most) {
  ImpactOutcome out;
  const double before = kinetic_energy(s.particles);
  const double approach = s.particles.velocity[1][2] - s.particles.velocity[0][2];
  VelocityVerlet<3> integrator(step);
  integrator.initialise(s);
  double last = overlap_of(s, partner);
  double begin = 0.0;
  for (std::int64_t k = 0; k < most && !out.ended; ++k) {
    integrator.step(s);
    const double now = overlap_of(s, partner);
    const double crossing = s.time - step * now / (now - last);
    if (now > 0.0 && last <= 0.0) begin = crossing;
    if (now <= 0.0 && last > 0.0) {
      out.ended = true;
      out.duration = crossing - begin;
    }
    out.max_overlap = std::max(out.max_overlap, now);
    last = now;
  }
  out.restitution = (s.particles.velocity[0][2] - s.particles.velocity[1][2]) / approach;
  out.energy_ratio = kinetic_energy(s.particles) / before;
  return out;
}

}  // namespace softgrain::test
