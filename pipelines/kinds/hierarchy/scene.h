// Scene kind "hierarchy": soft particles that hold soft particles, level by level [SP 1.8].
#pragma once

#include <string>
#include <vector>

#include "common/io/scene.h"
#include "common/packing/void_filling.h"
#include "pipelines/kinds/law_table/crowd_scene.h"

namespace softgrain {

struct HierarchySetup {
  std::string title;
  CrowdSetup crowd;          ///< what is measured at every level
  std::int64_t levels = 4;   ///< decades; the finest holds grains only
  VoidFillingOptions voids;  ///< soft particles between the grains of a level, over Rs
  Crowd form = Crowd::directional;
  bool unloading = false;
  std::int64_t iterations = 8;         ///< levels at most, counted from the finest, on the way to the fixed point
  double tolerance = 0.01;             ///< the fixed point is reached when laws of two levels differ by less
  std::int64_t check_packings = 0;     ///< of the resolved check of two decades; 0: none
  std::vector<double> check_overlaps;  ///< one plane, h/Rs, ascending
  std::int64_t check_inner = 0;        ///< largest inner soft particles that are resolved (and kept); 0: all
};

/// Reads a scene of kind "hierarchy" to the last key. Throws BadInput.
HierarchySetup read_hierarchy_setup(const Scene& scene);

}  // namespace softgrain
