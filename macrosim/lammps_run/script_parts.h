// Pieces of the input script.
#pragma once

#include <string>

#include "macrosim/lammps_run/input_script.h"

namespace softgrain::lammps {

/// A heading between parts.
std::string section(const std::string& title);

/// "variable NAME index VALUE  # MEANING": what -var on the command line replaces.
std::string setting(const std::string& name, const std::string& value, const std::string& meaning);

/// Sums over contacts, kept up to date by thermo output, and the clock.
std::string watching();

/// Bodies that were placed loosely are brought into touch (macrosim/preparation.h); settings of it.
std::string compaction_settings(const ScriptScene& scene);
std::string compaction(const ScriptScene& scene);

/// Strain increments as formulas (macrosim/test_protocol.h).
std::string test_variables(const ScriptScene& scene);

/// The loop over points and increments, up to rest.
std::string test_loop(const ScriptScene& scene);

/// A row of points.txt, a restart file, and the end of the loop.
std::string recording();

/// The last state, for the report.
std::string the_end();

}  // namespace softgrain::lammps
