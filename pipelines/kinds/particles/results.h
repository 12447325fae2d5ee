// What runs of explicit particles leave behind.
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults particles_results();

/// run.h5: every recorded frame, with the contacts of those that kept them; frames whose numbers were lost are left
/// out. Throws IoError.
void visit_particles(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit);

namespace report {
std::string particles_section(const RunData& run);  ///< final states and contacts
}

}  // namespace softgrain
