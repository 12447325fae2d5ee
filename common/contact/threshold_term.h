// From the numbers of a law card to a term of the loop.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "common/contact/soft_contact.h"

namespace softgrain {

/// F(Delta) = a (Delta^b - delta^b) above the threshold delta [SP 1.5], as a PowerTerm. The offset follows from a, b
/// and delta, so that the law is zero at its threshold to the last bit; the card's own c is rounded. Dimensionless; a >
/// 0, b > 0, 0 <= delta < 1 (not checked: whoever reads the card does).
inline PowerTerm threshold_term(double a, double b, double delta) { return {a, b, -a * power(delta, b)}; }

}  // namespace softgrain
