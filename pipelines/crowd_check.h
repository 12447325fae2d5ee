// softgrain check of law tables and hierarchies that are to be measured.
#pragma once

#include "common/io/scene.h"
#include "pipelines/crowd_setup.h"
#include "pipelines/findings.h"

namespace softgrain {

/// Kind "law-table": counts, overlaps, memory, time from one packing and a short trial of the loop, and what the table
/// will lack.
void check_law_table(const Scene& scene, Findings& out);

/// Kind "hierarchy": the same for every level.
void check_hierarchy(const Scene& scene, Findings& out);

}  // namespace softgrain
