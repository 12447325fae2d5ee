// Words of a script, with messages that say what is wrong.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <mpi.h>

#include <string>
#include <utility>

#include "common/contact/law_set.h"

namespace LAMMPS_NS {
class Error;
}

namespace softgrain::lammps {

/// "3", "2*4", "*": a range of atom types within 1..types.
std::pair<int, int> type_range(const std::string& word, int types, LAMMPS_NS::Error* error);

/// A finite number.
double number(const std::string& word, const std::string& what, LAMMPS_NS::Error* error);

/// FILE NAME, or: card FILE KIND modulus E friction MU [kt ..] [damping ..] [beyond ..].
AnyLaw read_law_words(char** words, int count, MPI_Comm world, LAMMPS_NS::Error* error);

/// Refuses laws of disks in three dimensions, and those of three in two (`dimension` of the script).
void check_dimension(const AnyLaw& law, int dimension, LAMMPS_NS::Error* error);

}  // namespace softgrain::lammps
