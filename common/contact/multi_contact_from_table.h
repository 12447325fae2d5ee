// From a law table to the laws of the contact loop.
#pragma once

#include <optional>
#include <string>

#include "common/contact/law_set.h"
#include "common/contact/multi_contact_prediction.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

/// A law of the table as the model that predicts with it.
MultiContactModel multi_contact_model(const MultiContactLaw& law);

/// What is not in the table.
struct MultiContactChoices {
  LawForm form = LawForm::directional;
  double modulus = 0.0;                   ///< E of what the soft particles hold [Pa]
  double friction = -1.0;                 ///< mu_soft; negative: as measured
  double wall_friction = -1.0;            ///< friction of grains with planes; negative: as among themselves
  bool unloading = false;                 ///< use the measured unloading branch
  bool rolling = true;                    ///< use rolling resistance, where it was measured
  std::optional<Extrapolation> beyond{};  ///< instead of what the table says
};

/// The laws of soft particles against solid grains in either order, against planes and shells, and among themselves.
struct MultiContactLaws {
  AnyLaw soft_plane;  ///< body i is the soft one: planes and the inside of a parent's shell
  AnyLaw soft_solid;  ///< body i is the soft one
  AnyLaw solid_soft;  ///< body j is the soft one
  AnyLaw soft_soft;
};

/// Throws InputError when the entry has no usable law of this form, or none for soft neighbours.
MultiContactLaws make_multi_contact_laws(const LawTableEntry& entry, const MultiContactChoices& choices);

}  // namespace softgrain
