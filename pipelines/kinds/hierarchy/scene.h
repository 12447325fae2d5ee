// Scene kind "hierarchy": soft particles that hold soft particles, level by level [SP 1.8].
#pragma once

#include <string>
#include <vector>

#include "common/io/scene.h"
#include "common/packing/void_filling.h"
#include "pipelines/kinds/law_table/crowd_scene.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

struct HierarchySetup {
  std::string title;
  CrowdSetup crowd;          ///< what is measured at every level
  std::int64_t levels = 4;   ///< decades; the finest holds grains only
  VoidFillingOptions voids;  ///< soft particles between the grains of a level, over Rs
  Crowd form = Crowd::directional;
  bool unloading = false;
  bool rolling = true;
  std::int64_t iterations = 8;         ///< levels at most, counted from the finest, on the way to the fixed point
  double tolerance = 0.01;             ///< the fixed point is reached when laws of two levels differ by less
  std::int64_t check_packings = 0;     ///< of the resolved check of two decades; 0: none
  std::vector<double> check_overlaps;  ///< one plane, h/Rs, ascending
  std::int64_t check_inner = 0;        ///< largest inner soft particles that are resolved (and kept); 0: all
};

/// Reads a scene of kind "hierarchy" to the last key. Throws BadInput.
HierarchySetup read_hierarchy_setup(const Scene& scene);

/// Level by level from the finest to the coarsest, then on to the fixed point, then the resolved check of two decades.
/// Writes law_table_level_K.toml, crowd_level_K.h5, law_table.toml (coarsest level), summary.json and the report.
/// Status not_usable when a level has no law, or the fixed point was not reached.
SceneKind hierarchy_kind();

/// Counts, overlaps, memory and time of its levels. Throws BadInput.
void check_hierarchy(const Scene& scene, Findings& out);

}  // namespace softgrain
