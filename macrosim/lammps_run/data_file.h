// The bodies of a macro scene as a data file of LAMMPS.
#pragma once

#include <string>

#include "macrosim/lammps_run/body_types.h"

namespace softgrain::lammps {

/// atom_style sphere: id (from 1, in the order of the packing) type diameter density x y z, SI; numbers read back to
/// the same bits. Soft bodies have the density of their contents. Written line by line, atomically: memory does not
/// grow with the scene. `title` goes to the first line. Throws IoError.
void write_data_file(const std::string& path, const std::string& title, const MacroPacking& packing,
                     const BodyTypes& types, double density, double inner_solid_fraction);

/// The springs between solid bodies of a preparation with friction, as pair style softgrain reads them. Throws
/// IoError.
void write_springs_file(const std::string& path, const MacroPacking& packing);

/// Whether a test begins with them.
bool has_springs(const MacroSpec& spec, const MacroPacking& packing);

}  // namespace softgrain::lammps
