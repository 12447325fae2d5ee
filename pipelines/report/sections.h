// The sections of a report that belong to no kind of scene, one file each. A section without data is an empty string.
#pragma once

#include <string>

#include "pipelines/report/run_data.h"

namespace softgrain::report {

std::string heading_section(const RunData& run);     ///< what was run and what came out
std::string remarks_section(const RunData& run);     ///< what to be careful with
std::string laws_section(const RunData& run);        ///< parameters, errors, intervals, units
std::string own_data_section(const RunData& run);    ///< curves of an experiment and the law fitted to them
std::string packing_section(const RunData& run);     ///< the packing in 3D, from the states that the run kept
std::string radii_section(const RunData& run);       ///< size distribution of the packed grains
std::string sizes_section(const RunData& run);       ///< passing over size, asked and obtained
std::string cost_section(const RunData& run);        ///< passes, contact evaluations, seconds, speed-ups
std::string provenance_section(const RunData& run);  ///< version, seeds, command, scene

}  // namespace softgrain::report
