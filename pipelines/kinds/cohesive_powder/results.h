// What runs of cohesive powders leave behind.
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults powder_results();

/// powder.h5: pictures of the assembly without contacts, then the state that it ended in, with them. Throws
/// IoError.
void visit_powder(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit);

namespace report {
std::string powder_section(const RunData& run);           ///< packings, forces, I(k), courses
std::string powder_variants_section(const RunData& run);  ///< all variants beside what is published
}  // namespace report

}  // namespace softgrain
