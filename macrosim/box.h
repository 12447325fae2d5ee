// A box of six planes around a system, its motion and its stress.
#pragma once

#include <array>

#include "common/system.h"

namespace softgrain {

/// Planes in the order x low, x high, y low, y high, z low, z high.
struct Box {
  std::array<Slot, 6> plane{};
};

/// Adds six planes of a material around [low, high]; bodies must have been added before.
Box add_box(System3& system, const Vec3& low, const Vec3& high, std::int32_t material);

Vec3 box_low(const System3& system, const Box& box);
Vec3 box_high(const System3& system, const Box& box);

/// Strains the box by the factors 1 - strain per axis about its centre, opposite planes symmetrically, and takes the
/// bodies along affinely (grains inside shells move with their shell).
void strain_box(System3& system, const Box& box, const Vec3& strain);

/// Mean of the normal forces of opposite planes over the area they close [Pa], compression positive, from the last
/// pass.
Vec3 wall_stress(const System3& system, const Box& box);

/// The same from the contacts inside: sum over contacts of force times branch over the volume [Pa]; equal in
/// equilibrium.
Vec3 contact_stress(const System3& system, const Box& box);

}  // namespace softgrain
