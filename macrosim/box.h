// What is around a system, six planes or a periodic cell: its motion and its stress.
#pragma once

#include <array>
#include <vector>

#include "common/dynamics/force_pass.h"
#include "common/system.h"

namespace softgrain {

/// Planes in the order x low, x high, y low, y high, z low, z high; none around a periodic cell, whose low corner is
/// the origin.
struct Box {
  std::array<Slot, 6> plane{};
  bool periodic = false;
};

/// Adds six planes of a material around [low, high]; bodies must have been added before.
Box add_box(System3& system, const Vec3& low, const Vec3& high, std::int32_t material);

/// Makes the cell periodic with these edges; bodies are at places in [0, size].
Box add_periodic_cell(System3& system, const Vec3& size);

Vec3 box_low(const System3& system, const Box& box);
Vec3 box_high(const System3& system, const Box& box);

/// Where the motion of the box is zero: its centre, of a periodic cell the origin.
Vec3 box_centre(const System3& system, const Box& box);

/// The place that says how far the motion of the box takes body `u` along: its own, of a grain in a shell that of the
/// shell, in the image near the grain.
inline Vec3 carried_place(const System3& system, std::size_t u) {
  const auto& p = system.particles;
  if (u >= at(p.grains) || p.shell[u] < 0) return p.sphere[u].x;
  const Vec3& shell = p.sphere[at(p.shell[u])].x;
  return shell + system.cell.image_shift(system.cell.image_near(p.sphere[u].x, shell));
}

/// Strains the box by the factors 1 - strain per axis about its centre, opposite planes symmetrically, and takes the
/// bodies along affinely (grains inside shells move with their shell).
void strain_box(System3& system, const Box& box, const Vec3& strain);

/// Stress on what is around the bodies [Pa], compression positive, from the last pass: mean of the normal forces of
/// opposite planes over the area they close; of a periodic cell contact_stress().
Vec3 box_stress(const System3& system, const Box& box);

/// Stress tensor from contacts: sum of branch (x) force over the volume, compression positive [Pa]; row k is the
/// component k of the branch. Its antisymmetric part is what moments are out of balance.
Matrix<3> contact_stress_tensor(const System3& system, const Box& box, const std::vector<ContactRecord<3>>& contacts);

/// Displaces all bodies of a periodic cell along x by -shear times their height, and the cell with them: simple shear
/// in one stroke. The sign is that of strains here, which are positive in compression: stress xz grows with it. Bodies
/// turn with half of it, as the material does; those inside shells move with their shell.
void shear_cell(System3& system, double shear);

/// Stress from the contacts inside: sum over contacts of force times branch over the volume [Pa]. In equilibrium it
/// equals the stress on the box.
Vec3 contact_stress(const System3& system, const Box& box);

}  // namespace softgrain
