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
