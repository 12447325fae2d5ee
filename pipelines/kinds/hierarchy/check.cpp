// softgrain check of hierarchies.
#include <fmt/format.h>

#include "pipelines/kinds/hierarchy/run.h"
#include "pipelines/kinds/hierarchy/scene.h"
#include "pipelines/kinds/law_table/crowd_check.h"

namespace softgrain {

void check_hierarchy(const Scene& scene, Findings& out) {
  const HierarchySetup setup = read_hierarchy_setup(scene.root());
  const auto configurations = static_cast<std::int64_t>(setup.crowd.configurations.size());
  out.facts["levels"] = setup.levels;
  out.facts["levels_max"] = setup.iterations;
  out.facts["runs_per_level_min"] = configurations * setup.crowd.packings_min;
  out.lines += fmt::format("  {} levels, up to {} on the way to the fixed point, {} to {} runs each\n", setup.levels,
                           setup.iterations, configurations * setup.crowd.packings_min,
                           configurations * setup.crowd.packings_max);
  spend_on_crowd(setup.crowd, check_crowd(setup.crowd, out), static_cast<double>(setup.levels), "levels", out);
}

}  // namespace softgrain
