// The sections of a report, one file each. A section without data is an empty string.
#pragma once

#include <string>

#include "pipelines/report/run_data.h"

namespace softgrain::report {

std::string heading_section(const RunData& run);       ///< what was run and what came out
std::string remarks_section(const RunData& run);       ///< what to be careful with
std::string laws_section(const RunData& run);          ///< parameters, errors, intervals, units
std::string own_data_section(const RunData& run);      ///< curves of an experiment and the law fitted to them
std::string inverse_section(const RunData& run);       ///< the soft particle that gives a target curve
std::string normal_section(const RunData& run);        ///< Fn(Delta)
std::string tangential_section(const RunData& run);    ///< Ft(ht)
std::string stiffness_section(const RunData& run);     ///< kt(Delta)
std::string relaxations_section(const RunData& run);   ///< published against damped relaxation
std::string law_table_section(const RunData& run);     ///< several neighbours at once: measured and fitted
std::string hierarchy_section(const RunData& run);     ///< soft particles in soft particles, level by level
std::string macro_section(const RunData& run);         ///< stress and strain, law against resolved twin
std::string macro_scenes_section(const RunData& run);  ///< every law and both twins on every scene: error and cost
std::string packing_section(const RunData& run);       ///< the packing in 3D, from the states that the run kept
std::string radii_section(const RunData& run);         ///< size distribution of the packed grains
std::string particles_section(const RunData& run);     ///< final states and contacts of a scene of explicit particles
std::string grain_box_section(const RunData& run);     ///< packs between six planes: stresses, moduli, contacts
std::string powder_section(const RunData& run);        ///< cohesive powders: packings, forces, I(k), courses
std::string powder_variants_section(const RunData& run);  ///< all variants beside what is published
std::string cost_section(const RunData& run);             ///< passes, contact evaluations, seconds, speed-ups
std::string provenance_section(const RunData& run);       ///< version, seeds, command, scene

}  // namespace softgrain::report
