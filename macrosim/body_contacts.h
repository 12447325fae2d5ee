// Contacts between whole bodies: what the grains of one soft particle do to another body is summed into one force, so
// that law runs and resolved twins are counted alike. And who bears the load in a packing of grains.
#pragma once

#include <cstdint>
#include <string>
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

/// Fabric tensor of the contacts between bodies, walls left out; and of the strong ones alone, those with more than the
/// mean normal force of all (Radjai, Wolf, Jean, Moreau 1998, DOI 10.1103/PhysRevLett.80.61). Zero without contacts.
struct BodyFabric {
  Matrix<3> all{};
  Matrix<3> strong{};
};
BodyFabric body_fabric(const MacroSystem& macro, const std::vector<BodyContact>& contacts);

/// Mean number of bodies and walls that a body touches.
double body_coordination(const MacroSystem& macro, const std::vector<BodyContact>& contacts);

// Who bears the load in a packing of grains: coarse ones, fine ones, or none.

/// Names of the columns of MacroCurve::more, of a split at `split` of the largest radius.
enum class Bearers { coarse_coarse, coarse_fine, fine_fine };

template <>
inline constexpr auto enum_names<Bearers> = enum_name_list<Bearers>({{Bearers::coarse_coarse, "coarse-coarse"},
                                                                     {Bearers::coarse_fine, "coarse-fine"},
                                                                     {Bearers::fine_fine, "fine-fine"}});

inline constexpr const char* kSolidFraction = "solid_fraction";
inline constexpr const char* kRattlers = "rattlers";
std::string share_name(Bearers bearers, double split);

/// Contacts that a grain needs, to grains that do not rattle, so that it does not: four, with friction two.
inline int contacts_that_hold(const MacroSpec& spec) { return spec.friction > 0.0 ? 2 : 4; }

/// Appends a point to curve.more: the solid fraction (full volume of every grain, overlaps twice, over that of the
/// cell), the share of the grains that rattle, and of the mean stress the shares that contacts between coarse and fine
/// grains carry (their virials over that of all; walls count with neither). A grain rattles with fewer than
/// contacts_that_hold().
void record_grains(const MacroSystem& macro, const MacroSpec& spec, MacroCurve& curve);

}  // namespace softgrain
