// How rigid a powder is: force indeterminacy, floppy modes, definiteness of its stiffness [CP 3.5].
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "microsim/powder/powder_stiffness.h"
#include "microsim/powder/sparse_rank.h"

namespace softgrain {

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

}  // namespace softgrain
