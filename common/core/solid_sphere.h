// Volume, mass and inertia of solid spheres and disks, in one place.
#pragma once

#include <numbers>

#include "common/core/particles.h"

namespace softgrain {

/// Volume of a sphere of radius 1.
inline constexpr double kSphereVolume = 4.0 / 3.0 * std::numbers::pi;

inline double cube(double x) { return x * x * x; }

/// A body with mass 4/3 pi r^3 rho and inertia 2/5 m r^2. SI units.
inline NewBody<3> solid_sphere(const Vec3& x, double r, double density, std::int32_t material) {
  NewBody<3> body;
  body.x = x;
  body.r = r;
  body.mass = density * kSphereVolume * r * r * r;
  body.inertia = 0.4 * body.mass * r * r;
  body.material = material;
  return body;
}

/// A body with mass pi r^2 rho, rho per area, and inertia 1/2 m r^2.
inline NewBody<2> solid_disk(const Vec2& x, double r, double density, std::int32_t material) {
  NewBody<2> body;
  body.x = x;
  body.r = r;
  body.mass = density * std::numbers::pi * r * r;
  body.inertia = 0.5 * body.mass * r * r;
  body.material = material;
  return body;
}

}  // namespace softgrain
