// Who bears the load in a packing of grains, in LAMMPS: what macrosim/grain_record.h records, from sums over contacts.
#pragma once

#include <string>
#include <vector>

#include "macrosim/lammps_run/points_file.h"
#include "macrosim/macro_packing.h"

namespace softgrain::lammps {

/// What compute softgrain/contacts is told; empty where the scene names no splits.
std::string grain_words(const MacroSpec& spec, const MacroPacking& packing);

/// A column of points.txt after those that every test has.
struct GrainColumn {
  std::string name;
  std::string expression;  ///< expression of the column in LAMMPS
};

/// Bodies that rattle, then of every split the virials of contacts between coarse and fine ones [N m].
std::vector<GrainColumn> grain_columns(const MacroSpec& spec);

/// Names of these columns, as points_file.h takes them.
std::vector<std::string> grain_names(const MacroSpec& spec);

/// Appends a row to curve.more, as record_grains() does.
void add_grains(const PointRow& row, const MacroSpec& spec, const MacroPacking& packing, MacroCurve& curve);

}  // namespace softgrain::lammps
