// From a law card to a law of the loop.
#pragma once

#include <optional>

#include "common/contact/soft_contact.h"
#include "common/data/law_card.h"

namespace softgrain {

/// The fitted law of `kind` for a material of Young's modulus `modulus` [Pa], Coulomb coefficient `friction` and
/// viscous damping `damping` (fraction of critical). Tangential stiffness from the initial slope, or from the secant at
/// 1 degree with `use_secant`; when only one of them was fitted, that one; when none was, the share of the normal
/// stiffness that assumed_kt_ratio() says. Throws InputError when the card has no usable
/// law of this kind
/// ("no threshold crossing", "not run") - an underdetermined law is accepted: it reproduces its data within its range.
/// `beyond` is what the law does above the range it was fitted in; empty: what the card says.
SoftContact make_soft_contact(const LawCard& card, PairKind kind, double modulus, double friction, double damping,
                              bool use_secant, std::optional<Extrapolation> beyond = std::nullopt);

}  // namespace softgrain
