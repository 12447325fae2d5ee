// What measurements of soft particles leave behind, and laws fitted to them.
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults soft_particle_results();

namespace report {
std::string normal_section(const RunData& run);       ///< Fn(Delta)
std::string tangential_section(const RunData& run);   ///< Ft(ht)
std::string stiffness_section(const RunData& run);    ///< kt(Delta)
std::string relaxations_section(const RunData& run);  ///< published against damped relaxation
}  // namespace report

}  // namespace softgrain
