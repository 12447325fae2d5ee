// The styles of softgrain in a LAMMPS.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

namespace LAMMPS_NS {
class LAMMPS;
}

namespace softgrain::lammps {

/// Makes pair style softgrain, fixes softgrain/wall and softgrain/relax and compute softgrain/contacts known. The
/// command `clear` of a script forgets them.
void add_styles(const LAMMPS_NS::LAMMPS& lmp);

}  // namespace softgrain::lammps
