// Contacts between whole bodies: what the grains of one soft particle do to another body is summed into one force, so
// that law runs and resolved twins are counted alike.
#pragma once

#include <cstdint>
#include <vector>

#include "common/dynamics/force_pass.h"
#include "macrosim/macro_system.h"

namespace softgrain {

struct BodyContact {
  std::int32_t a = 0;         ///< number of the first body
  std::int32_t b = 0;         ///< number of the second body, above a; or MacroSystem::bodies + number of the wall
  Vec3 force{};               ///< force on a, summed over all contacts between both [N]
  Vec3 branch{};              ///< vector from the centre of b to that of a; from a wall along its normal [m]
  double normal_force = 0.0;  ///< component of the force along the branch, positive when it pushes [N]
};

/// Contacts between different bodies, sorted by a, then b. Contacts within a body (grain on grain, grain on its own
/// shell) are left out. The centre of a resolved soft particle is that of its shell, without shell the centre of mass
/// of its grains.
std::vector<BodyContact> body_contacts(const MacroSystem& macro, const std::vector<ContactRecord<3>>& contacts);

/// Anisotropy of the fabric tensor sum n n / N over directions n: its zz minus its xx component, between -1 and 1; 0
/// without contacts. Walls, whose directions are given, are left out.
double fabric_anisotropy(const MacroSystem& macro, const std::vector<BodyContact>& contacts);

/// Anisotropy of the fabric tensor of the contacts between grains. Contacts with walls and shells are left out.
double fabric_anisotropy(const MacroSystem& macro, const std::vector<ContactRecord<3>>& contacts);

/// Mean number of bodies and walls that a body touches.
double body_coordination(const MacroSystem& macro, const std::vector<BodyContact>& contacts);

}  // namespace softgrain
