// points.txt, as the script of LAMMPS leaves it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "macrosim/lammps_run/points_columns.h"
#include "macrosim/macro_packing.h"

namespace softgrain::lammps {

/// One recorded point.
struct PointRow {
  std::array<double, static_cast<std::size_t>(Point::count)> values{};
  std::vector<double> more{};  ///< values of further columns that the scene asks for
  bool earlier = false;        ///< whether an earlier version began the table, without the columns from `unrest` on

  [[nodiscard]] double operator[](Point p) const { return values[static_cast<std::size_t>(p)]; }
};

/// The rows that stand in both tables, points.txt and its copy, from point 0 on without gap; a last row that is in one
/// of them alone or cut short was being written when the run ended, and is left out. A row that comes again replaces
/// the earlier one and those after it: a run that went on from there. Nothing without tables. Throws IoError when
/// the tables differ or hold what the script does not write, InputError when they belong to another scene (`key`).
/// `more`: names of the columns after those that every test has.
std::vector<PointRow> read_points(const std::string& directory, const std::string& key,
                                  const std::vector<std::string>& more = {});

/// Both tables with these rows and no others, for a run that goes on after the last of them.
void write_points(const std::string& directory, const std::string& key, const std::vector<PointRow>& rows,
                  const std::vector<std::string>& more = {});

/// Rows so far, for progress: lines that begin with a number, nothing tested.
std::int64_t count_points(const std::string& directory);

// Who bears the load in a packing of grains, in LAMMPS: what record_grains() of macrosim/body_contacts.h records, from
// sums over contacts.

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
