// Values of own atoms for their ghosts, by the communication of LAMMPS.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <type_traits>

#include "pair.h"

namespace softgrain::lammps {

/// Sends what `style` packs (pack_forward_comm) to the ghosts. Releases of LAMMPS from 2022 on have one function for
/// all styles, earlier ones (Debian 12) a function for each kind. A template, so that only the one that is there is
/// compiled.
template <class Communicator, class Style>
void forward_values(Communicator& comm, Style* style) {
  if constexpr (requires { comm.forward_comm(style); })
    comm.forward_comm(style);
  else if constexpr (std::is_base_of_v<LAMMPS_NS::Pair, Style>)
    comm.forward_comm_pair(style);
  else
    comm.forward_comm_compute(style);
}

}  // namespace softgrain::lammps
