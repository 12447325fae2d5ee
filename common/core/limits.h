// Numbers that stand for what is not known and for what has no limit, and a maximum that loses nothing.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <limits>

namespace softgrain {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The larger of two numbers; not a number counts as larger than all, so that no maximum over many can lose it
/// (std::max does, by order).
inline double larger_or_nan(double a, double b) { return a >= b || std::isnan(a) ? a : b; }

}  // namespace softgrain
