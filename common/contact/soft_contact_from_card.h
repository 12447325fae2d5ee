// From a law card to the law of the loop.
#pragma once

#include "common/contact/soft_contact.h"
#include "common/data/law_card.h"

namespace softgrain {

/// Law of a soft-solid or soft-soft contact of particles with modulus E [Pa], friction coefficient mu_soft and damping zeta
/// (fraction of critical). The tangential stiffness is the initial slope, or the secant at the card's secant angle. For
/// soft-solid the soft particle is body i; set i_is_soft = false for the reverse order.
/// Throws BadInput when the card has no usable law of this kind (no threshold crossing, not run, no tangential data).
SoftContact make_soft_contact(const LawCard& card, PairKind kind, double modulus, double friction, double damping, bool use_secant);

}  // namespace softgrain
