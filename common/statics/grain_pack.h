// A pack of grains between planes in quasi-static equilibrium: geometry, elasticity of every grain, and what each
// contact carries. The reference state of the least-work solver [QS 2.1].
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/vec.h"

namespace softgrain {

/// A plane that bounds the pack.
struct PackWall {
  Vec3 point{};
  Vec3 normal{};                ///< unit, into the pack
  double youngs_modulus = 0.0;  ///< [Pa]; infinity: rigid
  double poisson_ratio = 0.0;
  double friction = 0.0;
  /// Holds every grain whose centre lies on it (within 1e-9 of its radius): such a grain follows the plane along its
  /// normal, turns only about it, and has no contact with it; contacts between two such grains count in full. Other
  /// grains meet a plane without friction.
  bool symmetry = false;
};

/// What a contact carries in the reference state. Force and moment are those on grain i.
struct PackContact {
  std::int32_t i = 0;           ///< a grain
  std::int32_t j = 0;           ///< a grain (j > i), or grains + index of a wall
  Vec3 normal{};                ///< unit, to i
  double overlap = 0.0;         ///< h [m]
  double normal_force = 0.0;    ///< P [N]
  double contact_radius = 0.0;  ///< a = sqrt(R* h) [m]
  Vec3 tangential_force{};      ///< Q [N]
  double torsion = 0.0;         ///< M.n [N m]
  bool sliding = false;         ///< |Q| >= (1 - 1e-6) mu P, both of this state
};

struct GrainPack {
  std::vector<Vec3> position;  ///< centres of the grains [m]
  std::vector<double> radius;  ///< [m]
  std::vector<double> youngs_modulus;
  std::vector<double> poisson_ratio;
  std::vector<double> weight;  ///< m g [N] along `gravity`; empty: no gravity
  Vec3 gravity{};              ///< unit direction
  double friction = 0.0;       ///< between grains; infinity: contacts never slide
  std::vector<PackWall> walls;
  std::vector<PackContact> contacts;  ///< contacts of the reference state, sorted by (i, j)

  [[nodiscard]] std::int32_t grains() const { return static_cast<std::int32_t>(position.size()); }
};

}  // namespace softgrain
