// Contact laws for scripts of LAMMPS: read on one rank, known on all.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <mpi.h>

#include <string>
#include <vector>

#include "common/contact/law_set.h"

namespace softgrain::lammps {

/// The text of a file, read on rank 0. All ranks throw IoError when it cannot be read.
std::string broadcast_file(const std::string& path, MPI_Comm world);

/// Law `name` of a laws file (common/contact/law_file.h). Throws InputError (with the names that the file knows),
/// IoError.
AnyLaw law_of_file(const std::string& path, const std::string& name, MPI_Comm world);

/// What a law card leaves open.
struct CardChoices {
  double modulus = 0.0;  ///< E of what is inside the soft particles [Pa]
  double friction = 0.0;
  double damping = 0.0;  ///< zeta, fraction of critical
  bool secant = false;   ///< kt at 1 degree instead of the initial slope
  std::string beyond;    ///< error, clamp or extrapolate; empty: as the card says
};

/// The law of kind "soft-solid" (first body soft) or "soft-soft" of a card as calibrate writes it. Throws InputError,
/// IoError.
AnyLaw law_of_card(const std::string& path, const std::string& kind, const CardChoices& choices, MPI_Comm world);

}  // namespace softgrain::lammps
