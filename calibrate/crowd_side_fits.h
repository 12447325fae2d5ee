// What a crowd law needs besides normal loading: tangential stiffness, friction limit, unloading branch.
#pragma once

#include <vector>

#include "calibrate/crowd_states.h"
#include "common/contact/crowd_prediction.h"
#include "common/data/crowd_law.h"

namespace softgrain {

/// The packings of one replicate as averaged, and the law refitted to them.
struct CrowdDraw {
  std::vector<CrowdStates> states;
  CrowdModel model;
};

/// Per kind of neighbour kt/kn (secant of the drag at a slide of pi Rs/180, 1 degree, over the law's normal stiffness)
/// and mu_soft (largest drag over the normal force), and s of the unloading branch: means over the configurations that
/// slide or unload and are not held out. Errors and intervals are those of `draws`, in each of which configurations are
/// drawn as well, because they differ by more than packings make of it; with fewer than kEnoughReplicates they are not
/// known (infinite). Without such configurations: solid spheres slide like planes, soft neighbours like solid spheres;
/// without any, kt/kn 0.3, mu_soft the friction of the grains; s = 1; all with infinite error.
void fit_sides(const std::vector<CrowdStates>& states, const CrowdModel& model, const std::vector<CrowdDraw>& draws,
               std::uint64_t seed, LawTableEntry& entry);

}  // namespace softgrain
