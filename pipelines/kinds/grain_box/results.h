// What runs of grain boxes leave behind.
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults grain_box_results();

/// grain_box.h5: the last state of every pack, one series each, whatever the choice. Throws IoError.
void visit_grain_boxes(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit);

namespace report {
std::string grain_box_section(const RunData& run);  ///< stresses, moduli, contacts
}

}  // namespace softgrain
