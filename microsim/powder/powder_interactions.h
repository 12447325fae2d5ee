// Contacts and attracting pairs of a powder one by one, as the analyses of its forces and its rigidity see them
// [CP 3.5].
#pragma once

#include <cstdint>
#include <vector>

#include "common/system.h"

namespace softgrain {

/// What a pair does, and the colour of its line in pictures. The numbers are those of files.
enum class ForceKind : std::int64_t {
  compressive = 0,  ///< contact, N > 0 (red)
  tensile = 1,      ///< contact, N <= 0 (green)
  distant = 2,      ///< attraction across a gap (black)
  unstressed = 3    ///< contact with |F| below the limit that counts as none (blue)
};

/// One pair, in the units of the sample. The signs of both forces do not depend on which disk is called i.
struct PowderInteraction {
  Slot i = 0;
  Slot j = 0;
  Vec<2> normal{};                ///< unit, to i
  Vec<2> branch{};                ///< x_i - x_j, image of j nearest to i
  double arm_i = 0.0;             ///< distance from the centre of i to the contact point; arm_i + arm_j = |branch|
  double arm_j = 0.0;             ///< distance from the centre of j to the contact point
  double normal_force = 0.0;      ///< N, repulsion positive
  double tangential_force = 0.0;  ///< T, of the force on i along (-n_y, n_x); T > 0 turns both clockwise
  double rolling_moment = 0.0;    ///< rolling moment on i, counter-clockwise; 0 without rolling resistance
  bool distant = false;
  ForceKind kind = ForceKind::unstressed;

  [[nodiscard]] double force() const;  ///< |F| = sqrt(N^2 + T^2)
};

/// Contacts with a force below it count as unstressed [CP 3.5], in F0 (without cohesion P a), with and without rolling
/// resistance.
constexpr double kPowderZeroForce = 1e-4;

/// All pairs of the state as it is, in the order of the contact list. `zero`: a contact with |F| below it counts as
/// unstressed.
std::vector<PowderInteraction> powder_interactions(const System<2>& system, double zero);

/// How many periods lie between the centre of i and that image of j that it meets, per axis: x_i - x_j - branch over
/// the lengths of the cell; 0 along open axes.
Vec<2> winding(const System<2>& system, const PowderInteraction& pair);

}  // namespace softgrain
