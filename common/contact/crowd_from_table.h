// From a law table to the laws of the contact loop.
#pragma once

#include <optional>
#include <string>

#include "common/contact/crowd_prediction.h"
#include "common/contact/law_set.h"
#include "common/data/crowd_law.h"

namespace softgrain {

/// A law of the table as the model that predicts with it.
CrowdModel crowd_model(const CrowdLaw& law);

/// What is not in the table.
struct CrowdChoices {
  Crowd form = Crowd::directional;
  double modulus = 0.0;            ///< E of what the soft particles hold [Pa]
  double friction = -1.0;          ///< mu_soft; negative: as measured
  double wall_friction = -1.0;     ///< of planes: what grains have with them; negative: as among themselves
  bool unloading = false;          ///< with the measured unloading branch
  bool rolling = true;             ///< with rolling resistance, where that was measured
  std::optional<Beyond> beyond{};  ///< instead of what the table says
};

/// The laws of soft particles against solid grains in either order, against planes and shells, and among themselves.
struct CrowdLaws {
  AnyLaw soft_plane;  ///< body i is the soft one: planes and the inside of a parent's shell
  AnyLaw soft_solid;  ///< body i is the soft one
  AnyLaw solid_soft;  ///< body j is the soft one
  AnyLaw soft_soft;
};

/// Throws BadInput when the entry has no usable law of this form, or none for soft neighbours.
CrowdLaws make_crowd_laws(const LawTableEntry& entry, const CrowdChoices& choices);

}  // namespace softgrain
