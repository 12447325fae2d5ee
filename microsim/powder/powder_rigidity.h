// How rigid a powder is: force indeterminacy, floppy modes, definiteness of its stiffness, elastic moduli [CP 3.5].
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "microsim/powder/powder_interactions.h"
#include "microsim/powder/rigidity_matrix.h"
#include "microsim/powder/sparse_rank.h"

namespace softgrain {

/// Whether the springs of a powder hold it against every small motion: definiteness of K = G^T k G, k diagonal: K_N,
/// K_T, K_r of contacts, -F0/D0 of distant pairs.
struct Definiteness {
  bool positive = false;
  /// Smallest pivot of K scaled to a unit diagonal; none when the factorisation broke down.
  std::optional<double> smallest_pivot;
};

/// Smaller pivots of K (unit diagonal) count as zero.
inline constexpr double kPivotTolerance = 1e-12;

/// Sparse Cholesky of K with both displacements of one disk held, which takes away the two translations and nothing
/// else. Prestress is left out: forces that turn with their pairs add to K or take from it in the order of overlap over
/// size. Positive definite means rigid; the reverse holds only without distant pairs. False without disks.
Definiteness stiffness_definiteness(const RigidityMatrix& matrix);

/// Rigidity of one set of disks and one set of motions. N_f + h = M + k holds by algebra. Here h and k come from two
/// independent factorisations, so that the identity checks them.
struct Rigidity {
  std::int64_t freedoms = 0;       ///< N_f: 3 N (without friction 2 N), 2 more when the cell is free
  std::int64_t constraints = 0;    ///< M: 2 N_c + N_d, with rolling resistance 3 N_c + N_d, without friction N_c + N_d
  std::int64_t indeterminacy = 0;  ///< h = dim ker G^T, independent self-stresses
  std::int64_t floppy = 0;         ///< k = dim ker G, translations included (and turns of the whole in free space)
  SparseRank of_matrix;            ///< QR of G: k = N_f - rank
  SparseRank of_transpose;         ///< QR of G^T: h = M - rank
  Definiteness stiffness;

  [[nodiscard]] bool identity_holds() const { return freedoms + indeterminacy == constraints + floppy; }
};

/// h, k and definiteness of one matrix.
Rigidity rigidity_of(const RigidityMatrix& matrix);

/// All variants of one sample. Every contact counts in full, also those that slide or carry nothing.
struct PowderRigidity {
  Rigidity fixed;                         ///< cell held
  std::optional<Rigidity> free;           ///< the two strains are motions too; none in free space
  std::optional<Rigidity> backbone;       ///< cell held, without rattlers; only without cohesion
  std::optional<Rigidity> backbone_free;  ///< cell free, without rattlers; only without cohesion
};

/// `cohesive`: disks held by tension are no rattlers.
PowderRigidity powder_rigidity(const System<2>& system, const std::vector<PowderInteraction>& pairs, bool cohesive);

// Elastic moduli of a powder at rest, from the stiffness of its contacts [CP 3.5].

/// Moduli of a pack in the plane, in units of the sample (F0/a; without cohesion P): stress = C strain, strains (xx,
/// yy, gamma_xy). Both shear moduli are the same in an isotropic pack.
struct PowderModuli {
  double bulk = 0.0;         ///< B = (C11 + C22 + 2 C12)/4: mean stress over relative change of area
  double shear = 0.0;        ///< G = ((C11 + C22 - 2 C12)/4 + C33)/2, mean of the two
  double shear_axes = 0.0;   ///< (C11 + C22 - 2 C12)/4: one axis in, the other out
  double shear_cross = 0.0;  ///< C33: along the axes
  bool distant = true;       ///< whether distant pairs are included, whose springs have a negative stiffness
};

/// C = (K_ee - K_eu K_uu^-1 K_ue)/A of K = G^T k G, whose columns are motions of disks (u) and strains of the cell (e).
/// Every contact counts with its springs, whether it slides or not, and prestress is left out, which is the response to
/// the smallest probes. Motions without stiffness (rattlers, hinges) have no force from a strain: they are held by
/// springs of 1e-9 times the mean stiffness. Where the springs of distant pairs make K indefinite they are left out.
/// Empty without contacts, or in free space.
std::optional<PowderModuli> powder_moduli(const System<2>& system, const std::vector<PowderInteraction>& pairs);

}  // namespace softgrain
