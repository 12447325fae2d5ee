// Numbers that stand for what is not known and for what has no limit.
#pragma once

#include <limits>

namespace softgrain {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace softgrain
