// A multi-contact law that is known, and configurations to measure it with: what tests of fits and averages share.
#pragma once

#include <cmath>
#include <vector>

#include "calibrate/multi_contact_fit.h"
#include "tests/support/synthetic_multi_contact.h"

namespace softgrain::synthetic {

inline MultiContactModel known(LawForm multi_contact) {
  MultiContactModel model;
  model.multi_contact = multi_contact;
  model.form.pressure = {0.62, 2.7, 0.07};
  if (multi_contact == LawForm::directional) model.form.coupling = {0.65, 0.55, 0.15};
  set_partners(model, PartnerKind::solid, {0.5, 2.0}, {std::log(0.7), std::log(0.85)}, 1.1);
  set_partners(model, PartnerKind::soft, {1.0, 2.0}, {std::log(0.4), std::log(0.5)}, 1.25);
  return model;
}

inline std::vector<MultiContactConfiguration> arrangements() {
  std::vector<MultiContactConfiguration> list{
      multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3),
      multi_contact_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.25),
      multi_contact_configuration(Arrangement::orthogonal, PartnerKind::plane, 0.0, 0.25),
      multi_contact_configuration(Arrangement::tetrahedron, PartnerKind::plane, 0.0, 0.2),
      multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.18),
      multi_contact_configuration(Arrangement::icosahedron, PartnerKind::plane, 0.0, 0.13),
      multi_contact_configuration(Arrangement::one, PartnerKind::solid, 0.5, 0.35),
      multi_contact_configuration(Arrangement::one, PartnerKind::solid, 2.0, 0.3),
      multi_contact_configuration(Arrangement::one, PartnerKind::soft, 1.0, 0.35),
      multi_contact_configuration(Arrangement::opposite, PartnerKind::soft, 2.0, 0.35)};
  list[5].held_out = true;
  return list;
}

inline MultiContactFitOptions quick(double discrepancy = 0.01) {
  MultiContactFitOptions o;
  o.discrepancy = discrepancy;
  o.replicates = 0;
  return o;
}

}  // namespace softgrain::synthetic
