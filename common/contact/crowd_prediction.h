// What a law says about a configuration of a crowd measurement: for fits, reports and tests; the contact loop has its
// own way to the same numbers.
#pragma once

#include <vector>

#include "common/contact/soft_crowd.h"
#include "common/data/crowd_measurements.h"

namespace softgrain {

/// A law of soft particles without units.
struct CrowdModel {
  Crowd crowd = Crowd::directional;
  CrowdForm form;
  LostVolumeTable solid;
  LostVolumeTable soft;
  PairConstants smooth{1.0, 1.0};  ///< w and m of a plane without friction
};

/// w and m of the volume that a neighbour takes.
PairConstants neighbour_constants(const CrowdModel& model, const CrowdPartner& p);

/// What it covers at this overlap, in radii of the soft particle that it meets; nothing where they are apart.
Lens<double> neighbour_lens(const CrowdPartner& p, double overlap);

/// The particle in the middle as soft neighbour `p` sees it: a soft one of radius 1/ratio.
CrowdPartner seen_from_neighbour(const CrowdPartner& p);

/// Forces on the neighbours of the centre over E Rs^2 at these overlaps [Rs]. Soft neighbours have this contact and
/// those with the planes that press them.
std::vector<double> crowd_forces(const CrowdModel& model, const std::vector<CrowdPartner>& partners,
                                 const std::vector<double>& overlap);

/// The equivalent volume S of the particle in the middle.
double crowd_volume(const CrowdModel& model, const std::vector<CrowdPartner>& partners,
                    const std::vector<double>& overlap);

/// Sets w per ratio (ascending; soft neighbours: at least 1, the same from either side) and m of one kind; of planes
/// those without friction, whatever the ratio.
void set_partners(CrowdModel& model, PartnerKind kind, const std::vector<double>& ratios,
                  const std::vector<double>& log_weights, double exponent);

}  // namespace softgrain
