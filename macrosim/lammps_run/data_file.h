// The bodies of a macro scene as a data file of LAMMPS.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "macrosim/macro_packing.h"

namespace softgrain::lammps {

/// Types of atoms in LAMMPS: bodies of a kind and of a size class, so that lists reach no farther than they must.
struct BodyTypes {
  std::vector<std::int32_t> of;  ///< per body, from 1: solid classes first, then soft ones
  std::int32_t solid = 0;        ///< number of solid types
  std::int32_t soft = 0;
  std::vector<double> largest;  ///< radius per type, the first at [0] [m]

  [[nodiscard]] std::int32_t count() const { return solid + soft; }
  /// "1*3" as LAMMPS takes it; empty without such bodies.
  [[nodiscard]] std::string solid_range() const;
  [[nodiscard]] std::string soft_range() const;
};

/// Classes halve the radius, from the largest body of each kind down; empty ones have no type.
BodyTypes body_types(const MacroPacking& packing);

/// atom_style sphere: id (from 1, in the order of the packing) type diameter density x y z, SI; numbers read back to
/// the same bits. Soft bodies have the density of their contents. Written line by line, atomically: memory does not
/// grow with the scene. `title` goes to the first line. Throws IoError.
void write_data_file(const std::string& path, const std::string& title, const MacroPacking& packing,
                     const BodyTypes& types, double density, double inner_solid_fraction);

/// The springs of solid bodies that a preparation with friction left, as pair style softgrain reads them. Throws
/// IoError.
void write_springs_file(const std::string& path, const MacroSpec& spec, const MacroPacking& packing);

/// Whether a test begins with them.
bool has_springs(const MacroSpec& spec, const MacroPacking& packing);

}  // namespace softgrain::lammps
