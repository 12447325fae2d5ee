// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/styles.h"

#include "force.h"
#include "lammps.h"
#include "macrosim/lammps/compute_softgrain_contacts.h"
#include "macrosim/lammps/fix_softgrain_history.h"
#include "macrosim/lammps/fix_softgrain_relax.h"
#include "macrosim/lammps/fix_softgrain_wall.h"
#include "macrosim/lammps/pair_softgrain.h"
#include "modify.h"

namespace {

using namespace LAMMPS_NS;

template <class Style>
Fix* make_fix(LAMMPS* lmp, int count, char** words) {
  return new Style(lmp, count, words);
}

}  // namespace

void softgrain::lammps::add_styles(const LAMMPS& lmp) {
  (*lmp.force->pair_map)["softgrain"] = [](LAMMPS* l) -> Pair* { return new PairSoftgrain(l); };
  (*lmp.modify->fix_map)["softgrain/history"] = make_fix<FixSoftgrainHistory>;
  (*lmp.modify->fix_map)["softgrain/wall"] = make_fix<FixSoftgrainWall>;
  (*lmp.modify->fix_map)["softgrain/relax"] = make_fix<FixSoftgrainRelax>;
  (*lmp.modify->compute_map)["softgrain/contacts"] = [](LAMMPS* l, int count, char** words) -> Compute* {
    return new ComputeSoftgrainContacts(l, count, words);
  };
}
