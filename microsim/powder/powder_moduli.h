// Elastic moduli of a powder at rest, from the stiffness of its contacts [CP 3.5].
#pragma once

#include <optional>

#include "microsim/powder/powder_interactions.h"

namespace softgrain {

/// Moduli of a pack in the plane, in units of the sample (F0/a; without cohesion P): stress = C strain, strains (xx,
/// yy, gamma_xy). Both shear moduli are the same in an isotropic pack.
struct PowderModuli {
  double bulk = 0.0;         ///< B = (C11 + C22 + 2 C12)/4: mean stress over relative change of area
  double shear = 0.0;        ///< G = ((C11 + C22 - 2 C12)/4 + C33)/2, mean of the two
  double shear_axes = 0.0;   ///< (C11 + C22 - 2 C12)/4: one axis in, the other out
  double shear_cross = 0.0;  ///< C33: along the axes
  bool distant = true;       ///< whether distant pairs are included, whose springs have a negative stiffness
};

/// C = (K_ee - K_eu K_uu^-1 K_ue)/A of K = G^T k G, whose columns are motions of disks (u) and strains of the cell (e).
/// Every contact counts with its springs, whether it slides or not, and prestress is left out, which is the response to
/// the smallest probes. Motions without stiffness (rattlers, hinges) have no force from a strain: they are held by
/// springs of 1e-9 times the mean stiffness. Where the springs of distant pairs make K indefinite they are left out.
/// Empty without contacts, or in free space.
std::optional<PowderModuli> powder_moduli(const System<2>& system, const std::vector<PowderInteraction>& pairs);

}  // namespace softgrain
