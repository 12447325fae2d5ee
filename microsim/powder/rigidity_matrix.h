// The rigidity matrix of a powder: relative displacements in contacts as a linear map of motions [CP 3.5].
#pragma once

#include <cstdint>
#include <vector>

#include "microsim/powder/powder_interactions.h"
#include "microsim/powder/sparse_rank.h"

namespace softgrain {

/// Stiffnesses of the law of a powder, in the units of the sample.
struct PairStiffness {
  double normal = 0.0;      ///< K_N
  double tangential = 0.0;  ///< K_T; 0: no friction
  double rolling = 0.0;     ///< K_r [force times length]; 0: no rolling resistance
  double distant = 0.0;     ///< -F0/D0: attraction that fades with the gap
};

/// Stiffnesses of the law of the first material with itself. Throws std::logic_error when that is not a cohesive disk.
PairStiffness pair_stiffness(const System<2>& system);

/// Motions of the cell that a matrix has columns for.
enum class CellMotions : int {
  none = 0,
  lengths = 2,  ///< strains xx and yy
  strain = 3    ///< strains xx and yy, and gamma_xy = 2 eps_xy
};

/// G: one row per contact and component of its relative displacement, du_N = (u_i - u_j).n, with friction
/// du_T = (u_i - u_j).t - (a_i theta_i + a_j theta_j), with rolling resistance theta_i - theta_j; distant pairs have
/// the first alone. Columns: u_x, u_y and, with friction, R theta of every disk; then the strains of the cell that may
/// move: u includes the strain of the whole, so that only pairs across the boundary see the periods between them
/// (with u relative to it every pair would see its branch vector: the same ranks, but two dense columns). Every contact
/// counts in full, whether it slides or not.
struct RigidityMatrix {
  SparseEntries entries;          ///< M rows, N_f columns
  std::vector<double> stiffness;  ///< stiffness of each row
  std::int64_t contacts = 0;      ///< N_c
  std::int64_t distant = 0;       ///< N_d
  int per_disk = 3;               ///< columns of a disk
  std::int64_t disk_columns = 0;  ///< columns of all disks; strains of the cell follow
};

/// Matrix of the pairs between disks that `keep` names (by slot); the other disks have no columns. Arms and branches
/// are those of the state, overlap included, so that a turn of a whole cluster moves no contact.
RigidityMatrix rigidity_matrix(const std::vector<PowderInteraction>& pairs, const System<2>& system,
                               const std::vector<bool>& keep, CellMotions cell);

}  // namespace softgrain
