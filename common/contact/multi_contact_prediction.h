// What a law says about a configuration of a multi-contact measurement: for fits, reports and tests; the contact loop
// has its own way to the same numbers.
#pragma once

#include <vector>

#include "common/contact/soft_multi_contact.h"
#include "common/data/multi_contact_measurements.h"

namespace softgrain {

/// A law of soft particles without units: forces are over E Rs^2, lengths over Rs. SoftMultiContact has the equations
/// [SP 1.7.1]; it is valid within `form.pressure.range`.
struct MultiContactModel {
  LawForm multi_contact = LawForm::directional;
  MultiContactForm form;
  LostVolumeTable solid;           ///< w and m against solid neighbours, by their radius over Rs
  LostVolumeTable soft;            ///< w and m against soft neighbours
  PairConstants smooth{1.0, 1.0};  ///< w and m of a plane without friction
};

/// w and m of the volume that a neighbour takes.
PairConstants neighbour_constants(const MultiContactModel& model, const MultiContactPartner& p);

/// What it covers at this overlap, in radii of the soft particle that it meets; nothing where they are apart.
Lens<double> neighbour_lens(const MultiContactPartner& p, double overlap);

/// The particle in the middle as soft neighbour `p` sees it: a soft one of radius 1/ratio.
MultiContactPartner seen_from_neighbour(const MultiContactPartner& p);

/// Forces on the neighbours of the centre over E Rs^2 at these overlaps [Rs]. Soft neighbours have this contact and
/// those with the planes that press them.
std::vector<double> multi_contact_forces(const MultiContactModel& model,
                                         const std::vector<MultiContactPartner>& partners,
                                         const std::vector<double>& overlap);

/// The equivalent volume S of the particle in the middle, over its own; MultiContactForm says what it is.
double multi_contact_volume(const MultiContactModel& model, const std::vector<MultiContactPartner>& partners,
                            const std::vector<double>& overlap);

/// Sets w per ratio (ascending; soft neighbours: at least 1, the same from either side) and m of one kind; of planes
/// those without friction, whatever the ratio.
void set_partners(MultiContactModel& model, PartnerKind kind, const std::vector<double>& ratios,
                  const std::vector<double>& log_weights, double exponent);

}  // namespace softgrain
