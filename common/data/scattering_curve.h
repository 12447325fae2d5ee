// Scattered intensity over wave number, averaged over directions: what an experiment or a transform measures and a fit
// takes.
#pragma once

#include <cstddef>
#include <vector>

namespace softgrain {

/// Bins of wave number without empty ones, in ascending order. Lengths in any unit, here the largest diameter a.
struct ScatteringCurve {
  std::vector<double> k;          ///< mean |k| over the modes of a bin [1/length]
  std::vector<double> intensity;  ///< mean of |chi_hat|^2/A over them [length^2]
  std::vector<double> modes;      ///< independent ones: k and -k of a real field count as one

  [[nodiscard]] std::size_t size() const { return k.size(); }
};

}  // namespace softgrain
