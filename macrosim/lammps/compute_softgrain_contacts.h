// Compute softgrain/contacts: what the contacts of a state add up to, and the contacts themselves.
//
//   compute ID all softgrain/contacts
//
// Vector: [1] contacts that carry force, walls included, [2] of them with walls, [3] sum of |normal force| [N], [4] zz
// minus xx of the fabric tensor of contacts between bodies, [5..10] sum of force times branch, xx yy zz xy xz yz [N m]
// (over the volume: stress, compression positive; of walls the branch is along the normal), [11] largest overlap over
// the smaller radius, [12..16] uses of fitted laws: asked, beyond their range, largest over the end of the range,
// refused, clamped, [17] bodies whose centre is behind a wall.
// Local: one row per contact that carries force: tag i, tag j (walls: minus their number from 1), normal force, force
// on i (3), branch x_i - x_j (3).
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <vector>

#include "common/contact/law_use.h"
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
  void compute_vector() override;
  void compute_local() override;
  double memory_usage() override;

 private:
  static constexpr int kValues = 17;
  static constexpr int kColumns = 9;

  void look();
  template <class Surface>
  void look_at(const softgrain::lammps::ContactStore& store, const std::vector<softgrain::AnyLaw>& laws,
               const Surface& surface, int planes_before);
  template <class Law>
  void note_use(const Law& law, const softgrain::ContactState<3>& state, int i, int j, bool mine);
  void note_sums();

  PairSoftgrain* pair_ = nullptr;
  bigint looked_ = -1;
  std::array<double, kValues> values_{};  ///< of this rank; fabric as a sum
  double pairs_ = 0.0;                    ///< contacts between bodies, of this rank
  softgrain::LawUse use_;
  std::vector<const softgrain::CrowdForm*> form_;  ///< per own atom: of the law that serves its sum
  std::vector<std::array<double, kColumns>> rows_;
  std::vector<double*> row_pointers_;
};

}  // namespace LAMMPS_NS
