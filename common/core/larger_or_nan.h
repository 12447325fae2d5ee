// A maximum that loses nothing.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

namespace softgrain {

/// The larger of two numbers; not a number counts as larger than all, so that no maximum over many can lose it
/// (std::max does, by order).
inline double larger_or_nan(double a, double b) { return a >= b || std::isnan(a) ? a : b; }

}  // namespace softgrain
