// Pieces of the input script.
#pragma once

#include <string>
#include <vector>

#include "macrosim/lammps_run/input_script.h"
#include "macrosim/lammps_run/points_file.h"

namespace softgrain::lammps {

/// A heading between parts.
std::string section(const std::string& title);

/// "variable NAME index VALUE  # MEANING": what -var on the command line replaces.
std::string setting(const std::string& name, const std::string& value, const std::string& meaning);

double smallest_radius(const MacroPacking& packing);

/// Sums over contacts, kept up to date by thermo output, and the clock.
std::string watching(const ScriptScene& scene);

/// Bodies that were placed loosely are brought into touch (macrosim/preparation.h); settings of it.
std::string compaction_settings(const ScriptScene& scene);
std::string compaction(const ScriptScene& scene);

/// Strain increments as formulas (macrosim/test_protocol.h).
std::string test_variables(const ScriptScene& scene);

/// The loop over points and increments, up to rest.
std::string test_loop(const ScriptScene& scene);

/// The same of a test in stages: a table of them with what may be changed, formulas of each, the loop, and the stresses
/// at which stages begin, which a row is written with.
std::string stage_settings(const ScriptScene& scene);
std::string stage_variables(const ScriptScene& scene);
std::string stage_loop(const ScriptScene& scene);
std::string stage_begins(const ScriptScene& scene);
/// What goes on after these points needs to know of them: words for the command line.
std::vector<std::string> begin_settings(const std::vector<MacroStage>& stages, const std::vector<PointRow>& rows);

/// Which points keep their state, as is_snapshot() has it.
std::string kept_states();

/// After a run: how the relaxation ended, and what it adds to the cost of the point.
std::string counting();

/// At the begin of a point, and after the relaxation of each of its increments: which of them ended farthest from rest.
std::string unrest_begins();
std::string unrest_watch();

/// Names of the tables of points, at the beginning of a test.
std::string heads(const ScriptScene& scene);

/// A row of points.txt, a restart file, and the end of the loop.
std::string recording(const ScriptScene& scene);

/// The last state, for the report.
std::string the_end();

}  // namespace softgrain::lammps
