// Friction between cells: a tangential spring at every face, with memory from one strain step to the next.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/tessellation/radical_cells.h"
#include "macrosim/cell_matter/equation_of_state.h"
#include "macrosim/cell_matter/shear_memory.h"

namespace softgrain {

struct FaceFriction {
  double coefficient = 0.0;  ///< friction coefficient mu_f; 0: no friction
  double stiffness = 1.0;    ///< chi: spring stiffness over B A/d, B the mean of -V dp/dV of both cells
};

/// A face, whichever image its sites are kept at: i, j and the periods from i to j along the paths of both.
struct FaceKey {
  std::int32_t i = 0;
  std::int32_t j = 0;
  std::array<std::int32_t, 3> periods{};

  friend auto operator<=>(const FaceKey&, const FaceKey&) = default;
};

struct FaceSpring {
  FaceKey key;
  Vec3 force;              ///< force on j from i, in the plane of the face [N]
  double stiffness = 0.0;  ///< k [N/m]
  Vec3 separation;         ///< x_j - x_i when the spring was kept [m]
  bool slides = false;     ///< whether the force is at the Coulomb limit
  double tangent = 0.0;    ///< trial spring: stiffness against a motion in the face, before the limit [N/m]
  double kept = 1.0;       ///< trial spring: share of that which the limit leaves
  double yields = 0.0;     ///< trial spring: share of what is left that yields along the force
  double shape = 0.0;      ///< A/d of the face when the spring was kept [m]; with ShearMemory only

  [[nodiscard]] double energy() const { return stiffness > 0.0 ? norm2(force) / (2.0 * stiffness) : 0.0; }
};

/// Springs of all faces, in their order. With ShearMemory each is six in parallel: `force` is their sum, and `parts`
/// and `energy` have an entry for each face; else they are empty.
struct SpringSet {
  std::vector<FaceSpring> springs;
  std::vector<SpringForces> parts;
  std::vector<double> energy;  ///< of trial springs [J]
};

/// Springs of the last kept state. A trial state never changes them, so a relaxation may try what it likes and friction
/// depends on where it ends alone.
///
/// The trial spring T of a face follows from its kept spring (T0, k0, D0). For separation D, stiffness k = chi B A/d
/// and limit mu_f p A it is T = P [T0 min(1, k/k0) - min(k, (k + k0)/2) (D - D0)], cut to the limit. P projects on the
/// face (perpendicular to D); B and p are means of both cells. So
/// - the motion counts as the bodies move, the affine part of an imposed strain included (D holds it);
/// - the face may turn: T turns with it by projection, which only takes energy away;
/// - a face that shrinks or unloads (k < k0) keeps its displacement, T = k u (as the rescaled Mindlin springs of
///   LAMMPS); one that grows keeps its force and gets stiffer on the way, dT = k du, here by the mean of both ends (the
///   stiffness of the end alone makes stresses depend on the strain step, by 4 % at steps of 0.04; the mean leaves
///   0.1 %). Either way T^2/(2 k) falls with D at rest, so no change of stiffness makes energy;
/// - a new face begins with zero, once it is kept; a vanished one is forgotten with its energy;
/// - without pressure there is no force.
/// T acts on j and -T on i, both at the centres: sites have no rotation, so a coarse grain gets no moment from its
/// faces. (The mantle of fines around it shears and rolls with it; a spin of the grain would need a stiffness of its
/// own that nothing measures. The price: a rotation of the whole sample as a rigid body would load the springs, and
/// stress has a small antisymmetric part. Strains without rotation have no such spin on average.) Walls are smooth.
///
/// With ShearMemory the stiffness follows B both ways, T = k u (hyperelastic), at the A/d of the kept state; pressures
/// of CellForces then have a part of the springs, so that no change of volume makes energy. When a trial is kept, its
/// springs take the A/d that there is now: a smaller one keeps the displacement, a larger one the force, either of
/// which takes energy. Limits are mu p A, mu the mean of the strengths of both cells at the last kept state.
class FaceSprings {
 public:
  /// Trial springs of all faces. `keys`, `response` and `volume` belong to the trial state.
  [[nodiscard]] SpringSet trial(const FaceFriction& friction, bool memory, const RadicalCells& cells,
                                const std::vector<FaceKey>& keys, const std::vector<CellResponse>& response) const;

  void keep(SpringSet springs);
  /// Strengths mu of all cells, for the limits of trials with ShearMemory.
  void keep_strength(std::vector<double> strength) { strength_ = std::move(strength); }

  [[nodiscard]] const SpringSet& kept() const { return kept_; }
  [[nodiscard]] const std::vector<double>& strength() const { return strength_; }
  /// Place of a face in kept(); none: it is new.
  [[nodiscard]] std::optional<std::size_t> find(const FaceKey& key) const;

 private:
  SpringSet kept_;  ///< ordered by key
  std::vector<double> strength_;
};

}  // namespace softgrain
