// Compute softgrain/contacts: what the contacts of a state add up to, and the contacts themselves.
//
//   compute ID all softgrain/contacts [grains LEAST RADIUS ...]
//
// Vector: [1] contacts that carry force, walls included, [2] of them with walls, [3] sum of |normal force| [N], [4] zz
// minus xx of the fabric tensor of contacts between bodies, [5..10] sum of force times branch, xx yy zz xy xz yz [N m]
// (over the volume: stress, compression positive; of walls the branch is along the normal), [11] largest overlap over
// the smaller radius, [12..16] uses of fitted laws: asked, beyond their range, largest over the end of the range,
// refused, clamped, [17] bodies whose centre is behind a wall. With `grains`: [18] bodies that rattle (fewer than LEAST
// contacts, walls included, to bodies that do not); then of every RADIUS the virial (trace of force times branch, [N
// m]) of contacts between bodies of that size or larger, of such with smaller ones, of smaller ones. Local: one row per
// contact that carries force: tag i, tag j (walls: minus their number from 1), normal force, force on i (3), branch x_i
// - x_j (3).
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <vector>

#include "common/core/law_range.h"
#include "compute.h"
#include "macrosim/lammps/contact_loop.h"

namespace LAMMPS_NS {

class PairSoftgrain;

class ComputeSoftgrainContacts : public Compute {
 public:
  ComputeSoftgrainContacts(LAMMPS* engine, int count, char** words);
  ~ComputeSoftgrainContacts() override;
  ComputeSoftgrainContacts(const ComputeSoftgrainContacts&) = delete;
  ComputeSoftgrainContacts& operator=(const ComputeSoftgrainContacts&) = delete;

  void init() override;
  int pack_forward_comm(int n, int* list, double* buf, int, int*) override;
  void unpack_forward_comm(int n, int first, double* buf) override;
  void compute_vector() override;
  void compute_local() override;
  double memory_usage() override;

 private:
  static constexpr int kValues = 17;
  static constexpr int kColumns = 9;

  /// Partners of own atoms: an atom, own or ghost, or -1, a plane.
  struct Hold {
    int i = 0;
    int j = 0;
  };

  void look();
  template <class Surface>
  void look_at(const softgrain::lammps::ContactStore& store, const std::vector<softgrain::AnyLaw>& laws,
               const Surface& surface, int planes_before);
  template <class Law>
  void note_use(const Law& law, const softgrain::ContactState<3>& state, int i, int j, bool mine);
  void note_sums();
  void note_grains(int i, int j, double virial, bool mine);
  void count_rattlers();

  PairSoftgrain* pair_ = nullptr;
  bigint looked_ = -1;
  std::array<double, kValues> values_{};  ///< values of the vector on this rank; fabric as a sum
  double pairs_ = 0.0;                    ///< number of contacts between bodies on this rank
  softgrain::LawUse use_;
  std::vector<const softgrain::MultiContactForm*> form_;  ///< form of the law for the sum of an own atom
  int least_ = 0;                     ///< contacts of a body that is held; 0: grains are not asked for
  std::vector<double> coarse_;        ///< radii from which bodies are coarse [m]
  std::vector<double> grain_values_;  ///< values for `grains` on this rank
  std::vector<Hold> holds_;           ///< contacts of own atoms
  std::vector<double> loose_;         ///< per atom, ghosts included: 1 where it rattles
  std::vector<std::array<double, kColumns>> rows_;
  std::vector<double*> row_pointers_;
};

}  // namespace LAMMPS_NS
