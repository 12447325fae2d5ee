// Everything that can touch: grains (solid or soft), shells (insides of spheres) and planes, as a structure of arrays.
// Slots are ordered grains, shells, planes, so that one index names a body everywhere (contacts, forces, output).
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "common/core/vec.h"

namespace softgrain {

/// Position and radius sit together: the contact loop gathers them in one aligned 32-byte load.
template <int D>
struct alignas(32) Sphere {
  Vec<D> x;        ///< centre [m]; a point of the plane for planes
  double r = 0.0;  ///< radius [m]; 0 for planes
};

template <int D>
struct Particles {
  std::vector<Sphere<D>> sphere;
  std::vector<Stored<D>> velocity;      ///< [m/s]
  std::vector<StoredRot<D>> spin;       ///< [rad/s]
  std::vector<Stored<D>> force;         ///< force on the body in the last pass [N]
  std::vector<StoredRot<D>> torque;     ///< [N m]
  std::vector<double> inverse_mass;     ///< [1/kg]; 0: not moved by forces
  std::vector<double> inverse_inertia;  ///< [1/(kg m^2)]; 0: not turned by torques
  std::vector<std::int32_t> material;   ///< index into the materials of the scene
  std::vector<std::int32_t> shell;      ///< slot of the shell this grain (or shell) lives in, -1: none
  std::vector<double> largest_volume;   ///< largest equivalent volume S of each body at rest so far, of laws that
                                        ///< remember it; empty before the first rest and without such a law
  std::vector<std::int32_t> id;         ///< order of addition of each grain; empty while it equals the slot
  std::vector<Vec<D>> plane_normal;     ///< one per plane, unit, into the space of the grains
  std::vector<double>
      plane_load;           ///< one per plane: outside force along its normal [N]; acts on planes moved by forces
  std::int32_t grains = 0;  ///< slots [0, grains)
  std::int32_t shells = 0;  ///< slots [grains, grains + shells)
  std::int32_t planes = 0;  ///< the rest

  [[nodiscard]] std::int32_t size() const { return grains + shells + planes; }
  [[nodiscard]] std::int32_t first_plane() const { return grains + shells; }
  [[nodiscard]] const Vec<D>& normal_of(std::int32_t slot) const {
    return plane_normal[static_cast<std::size_t>(slot - first_plane())];
  }
};

using Slot = std::int32_t;
inline std::size_t at(Slot slot) { return static_cast<std::size_t>(slot); }

/// A body to be added. Mass and inertia zero mean "not moved by forces".
template <int D>
struct NewBody {
  Vec<D> x{};
  double r = 0.0;
  double mass = 0.0;
  double inertia = 0.0;
  std::int32_t material = 0;
  Slot shell = -1;
  Vec<D> velocity{};
  Rot<D> spin{};
};

namespace detail {
template <int D>
void insert_body(Particles<D>& p, Slot at, const NewBody<D>& b) {
  const auto k = static_cast<std::ptrdiff_t>(at);
  p.sphere.insert(p.sphere.begin() + k, Sphere<D>{b.x, b.r});
  p.velocity.insert(p.velocity.begin() + k, b.velocity);
  p.spin.insert(p.spin.begin() + k, b.spin);
  p.force.insert(p.force.begin() + k, Vec<D>{});
  p.torque.insert(p.torque.begin() + k, Rot<D>{});
  p.inverse_mass.insert(p.inverse_mass.begin() + k, b.mass > 0.0 ? 1.0 / b.mass : 0.0);
  p.inverse_inertia.insert(p.inverse_inertia.begin() + k, b.inertia > 0.0 ? 1.0 / b.inertia : 0.0);
  p.material.insert(p.material.begin() + k, b.material);
  p.shell.insert(p.shell.begin() + k, b.shell);
  if (!p.largest_volume.empty()) p.largest_volume.insert(p.largest_volume.begin() + k, 0.0);
}
}  // namespace detail

/// Bodies are added in the order grains, shells, planes (asserted by the slot returned being the last).
template <int D>
Slot add_grain(Particles<D>& p, const NewBody<D>& b) {
  detail::insert_body(p, p.grains, b);
  return p.grains++;
}
template <int D>
Slot add_shell(Particles<D>& p, const NewBody<D>& b) {
  detail::insert_body(p, p.first_plane(), b);
  return p.grains + p.shells++;
}
template <int D>
Slot add_plane(Particles<D>& p, const NewBody<D>& b, const Vec<D>& unit_normal) {
  detail::insert_body(p, p.size(), b);
  p.plane_normal.push_back(unit_normal);
  p.plane_load.push_back(0.0);
  return p.first_plane() + p.planes++;
}

// Volume, mass and inertia of solid spheres and disks, in one place.

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
