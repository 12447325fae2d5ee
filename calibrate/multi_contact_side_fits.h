// What a multi-contact law needs besides normal loading: tangential stiffness, friction limit, unloading branch.
#pragma once

#include <vector>

#include "calibrate/multi_contact_states.h"
#include "common/contact/multi_contact_prediction.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

/// What slides and retreats give, by configuration; held-out ones have no part.
struct SideValues {
  struct Slides {
    std::vector<double> kt_ratio;
    std::vector<double> friction;
    std::vector<double> rolling;
    std::vector<double> rolling_friction;
    std::vector<double> unloading;
  };
  Slides plane;
  Slides solid;
  Slides soft;
};

/// Values per kind of neighbour, of every configuration that slides, rolls or unloads. kt/kn: secant of the drag at a
/// slide of pi Rs/180, 1 degree; kn is that of the law at the force that was measured. mu_soft: largest drag over the
/// normal force. Stiffness and limit of rolling: moment over E R^2 and the way of the contact over the surface, secant
/// at the same way; mean of the moment over F R beyond 0.4 of the way. s of the unloading branch: sum of the forces
/// over that at the deepest state.
SideValues side_values(const std::vector<MultiContactStates>& states, const MultiContactModel& model);

/// Means over configurations. Errors and intervals are those of `drawn`, the same of packings drawn with replacement,
/// of each of which configurations are drawn as well, because they differ by more than packings make of it; with fewer
/// than kEnoughReplicates they are not known (infinite). Without such configurations: solid spheres slide like planes,
/// soft neighbours like solid spheres; without any, kt/kn 0.3, mu_soft the friction of the grains; s = 1; all with
/// infinite error. What no configuration rolled rolls freely; what none unloaded comes back as planes do.
void fit_sides(const SideValues& measured, const std::vector<SideValues>& drawn, std::uint64_t seed,
               LawTableEntry& entry);

}  // namespace softgrain
