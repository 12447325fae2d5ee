// Truncated power-law radii P(r) ~ r^-b, rmin < r < rmax [SP 1.1].
#pragma once

#include <vector>

namespace softgrain {

struct PowerLawRadii {
  double exponent = 3.5;  ///< b, not 1
  double rmin = 0.0;
  double rmax = 0.0;

  /// Inverse of the cumulative distribution at u in [0, 1]:
  /// r = [rmin^(1-b) + u (rmax^(1-b) - rmin^(1-b))]^(1/(1-b)).
  [[nodiscard]] double radius(double u) const;

  /// Share of grains with radius above r (complementary cumulative distribution).
  [[nodiscard]] double share_above(double r) const;
};

/// Maximum-likelihood exponent of radii, truncated at the smallest and largest of them, with its standard error
/// (Fisher information). Throws InputError with fewer than 3 different radii.
struct ExponentFit {
  double exponent = 0.0;
  double standard_error = 0.0;
};
ExponentFit fit_exponent(const std::vector<double>& radii);

}  // namespace softgrain
