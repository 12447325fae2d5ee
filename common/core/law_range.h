// What a fitted law does beyond the range it was measured in.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <limits>
#include <string>

namespace softgrain {

/// Either way the contacts beyond are counted and the run says so.
enum class Beyond {
  error,        ///< the run ends there, not usable
  clamp,        ///< force and stiffness stay as they are at the end of the range
  extrapolate,  ///< the formula goes on
};

inline std::string to_string(Beyond beyond) {
  if (beyond == Beyond::error) return "error";
  return beyond == Beyond::clamp ? "clamp" : "extrapolate";
}

/// End of the measured range in the variable of the law (Delta of a pair law, lost volume of a crowd law).
struct LawRange {
  double end = std::numeric_limits<double>::infinity();
  Beyond beyond = Beyond::extrapolate;

  /// Where the loop cuts the variable off; infinite unless the law is clamped.
  [[nodiscard]] double clamp_at() const {
    return beyond == Beyond::clamp ? end : std::numeric_limits<double>::infinity();
  }
};

}  // namespace softgrain
