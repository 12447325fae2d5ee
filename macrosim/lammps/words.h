// Words of a script, with messages that say what is wrong; and the contact laws that they name: read on one rank,
// known on all.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <mpi.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/contact/law_set.h"

namespace LAMMPS_NS {
class Error;
}

namespace softgrain::lammps {

/// "3", "2*4", "*": a range of atom types within 1..types.
std::pair<int, int> type_range(const std::string& word, int types, LAMMPS_NS::Error* error);

/// A finite number.
double number(const std::string& word, const std::string& what, LAMMPS_NS::Error* error);

/// FILE NAME, or: card FILE KIND modulus E friction MU [kt ..] [damping ..] [beyond ..]
/// [unloading yes|no].
AnyLaw read_law_words(char** words, int count, MPI_Comm world, LAMMPS_NS::Error* error);

/// Refuses laws of disks in three dimensions, and those of three in two (`dimension` of the script).
void check_dimension(const AnyLaw& law, int dimension, LAMMPS_NS::Error* error);

/// The text of a file, read on rank 0. All ranks throw IoError when it cannot be read.
std::string broadcast_file(const std::string& path, MPI_Comm world);

/// Law `name` of a laws file (common/contact/law_set.h). Throws InputError (with the names that the file knows),
/// IoError.
AnyLaw law_of_file(const std::string& path, const std::string& name, MPI_Comm world);

/// What a law card leaves open.
struct CardChoices {
  double modulus = 0.0;  ///< E of what is inside the soft particles [Pa]
  double friction = 0.0;
  double damping = 0.0;             ///< zeta, fraction of critical
  bool secant = false;              ///< kt at 1 degree instead of the initial slope
  std::string beyond;               ///< error, clamp or extrapolate; empty: as the card says
  bool slope_said = false;          ///< whether the script says which slope: no other takes its place
  std::optional<bool> unloading{};  ///< false: without the unloading branch of the card; true: it must have one
};

/// The law of kind "soft-solid" (first body soft) or "soft-soft" of a card as calibrate writes it. Throws InputError,
/// IoError.
AnyLaw law_of_card(const std::string& path, const std::string& kind, const CardChoices& choices, MPI_Comm world);

}  // namespace softgrain::lammps
