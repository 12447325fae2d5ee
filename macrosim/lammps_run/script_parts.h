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

/// Compaction of loosely placed bodies into touch (macrosim/preparation.h), and its settings.
std::string compaction_settings(const ScriptScene& scene);
std::string compaction(const ScriptScene& scene);

/// Strain increments as formulas (macrosim/test_protocol.h).
std::string test_variables(const ScriptScene& scene);

/// The loop over points and increments, up to rest.
std::string test_loop(const ScriptScene& scene);

/// Parts of a test in stages: a table of the stages with what may be changed, formulas of each stage, the loop, and the
/// commands after each row that keep the stresses at which stages begin.
std::string stage_settings(const ScriptScene& scene);
std::string stage_variables(const ScriptScene& scene);
std::string stage_loop(const ScriptScene& scene);
std::string stage_begins(const ScriptScene& scene);
/// Words for the command line of a run that goes on after these points: length at the start, and stresses at which
/// stages began.
std::vector<std::string> begin_settings(const std::vector<MacroStage>& stages, const std::vector<PointRow>& rows);

/// Formula for the points that keep their state, the same as in is_snapshot().
std::string kept_states();

/// Commands after a run: how the relaxation ended, and what it adds to the cost of the point.
std::string counting();

/// Commands that find the increment of a point that ended farthest from rest: at the begin of the point, and after the
/// relaxation of each increment.
std::string unrest_begins();
std::string unrest_watch();

/// Names of the tables of points, at the beginning of a test.
std::string heads(const ScriptScene& scene);

/// A row of points.txt, a restart file, and the end of the loop.
std::string recording(const ScriptScene& scene);

/// The last state, for the report.
std::string the_end();

}  // namespace softgrain::lammps
