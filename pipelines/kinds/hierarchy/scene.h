// Scene kind "hierarchy": soft particles that hold soft particles, level by level [SP 1.8].
#pragma once

#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// How soft particles come into a level.
enum class LevelFill {
  voids,  ///< soft particles in the voids of the published packing of grains, largest hole first, up to their mass
  masses  ///< soft particles of their full mass, whatever room grains must make for them
};

template <>
inline constexpr auto enum_names<LevelFill> = enum_name_list<LevelFill>({{LevelFill::voids, "voids"},
                                                                         {LevelFill::masses, "masses"}});

struct HierarchySetup {
  std::string title;
  MultiContactSetup multi_contact;  ///< what is measured at every level
  std::int64_t levels = 4;          ///< decades; the finest holds grains only
  LevelFill fill = LevelFill::voids;
  double inner_radius = 0.1;       ///< radius of the soft particles in a level, over Rs; largest one in voids
  double inner_radius_min = 0.05;  ///< smallest radius in voids, over Rs: smaller voids stay empty
  double next_volume = 0.0;        ///< volume of the grains of the next finer level over that of a level's own
  LawForm form = LawForm::directional;
  bool unloading = false;
  bool rolling = true;
  bool seeks_fixed_point = false;      ///< whether the fixed point is required: the run is not usable without it
  std::int64_t iterations = 4;         ///< levels at most, counted from the finest, on the way to the fixed point
  double tolerance = 0.01;             ///< the fixed point is reached when laws of two levels differ by less
  std::int64_t replicates = 40;        ///< refits to packings drawn with replacement, for error bars; 0: none
  std::int64_t check_packings = 0;     ///< packings of the resolved check of two decades; 0: none
  std::vector<double> check_overlaps;  ///< one plane, h/Rs, ascending
  std::int64_t check_inner = 0;        ///< number of largest inner soft particles resolved (and kept) in voids; 0: all
};

/// Reads a scene of kind "hierarchy" to the last key. Throws InputError.
HierarchySetup read_hierarchy_setup(const Scene& scene);

/// Level by level from the finest to the coarsest, then on to the fixed point, then the resolved check of two decades.
/// Writes law_table_level_K.toml, multi_contact_level_K.h5, law_table.toml (coarsest level), summary.json and the
/// report. Status not_usable when a level has no law, or the fixed point was not reached.
SceneKind hierarchy_kind();

/// Counts, overlaps, memory and time of its levels. Throws InputError.
void check_hierarchy(const HierarchySetup& setup, Findings& out);

}  // namespace softgrain
