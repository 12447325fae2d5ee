// Moduli from stress and strain increments, the effective-medium estimate, and growth exponents.
#pragma once

#include <vector>

#include "common/core/enum_names.h"
#include "common/core/vec.h"

namespace softgrain {

struct Moduli {
  double bulk = 0.0;   ///< K [Pa]; NaN where the loading does not define it
  double shear = 0.0;  ///< G [Pa]; NaN where the loading does not define it
};

/// Hooke's law solved for K and G from an increment of the three normal stresses [Pa] over three normal strains
/// (compression positive): K = d sigma_c / d eps_v, G = (ds' : de') / (2 de' : de'), primes: deviators. For uniaxial
/// strain this is K = (ds_a + 2 ds_l)/(3 de), G = (ds_a - ds_l)/(2 de) [QS 2.3]. K is NaN without change of volume, G
/// without change of shape (below a thousandth of the strain).
[[nodiscard]] Moduli hooke_moduli(const Vec3& stress_increment, const Vec3& strain_increment);

/// A pack as an effective medium sees it.
struct MediumState {
  double pressure = 0.0;        ///< sigma_c [Pa]
  double solid_fraction = 0.0;  ///< phi
  double coordination = 0.0;    ///< C
  double shear_modulus = 0.0;   ///< G of the grains [Pa]
  double poisson_ratio = 0.0;   ///< nu of the grains
};

/// Hertz-Mindlin contacts, affine motion (Walton 1987; Mavko, Mukerji, Dvorkin, Rock Physics Handbook, 5.4):
/// K = [C^2 phi^2 G^2 P / (18 pi^2 (1-nu)^2)]^(1/3),
/// G = (5-4nu)/(5(2-nu)) [3 C^2 phi^2 G^2 P / (2 pi^2 (1-nu)^2)]^(1/3).
[[nodiscard]] Moduli effective_medium(const MediumState& state);

/// y = prefactor x^exponent by least squares of the logarithms.
struct PowerFit {
  double exponent = 0.0;        ///< NaN with fewer than 3 points
  double standard_error = 0.0;  ///< standard error of the exponent, from the scatter about the line
  double prefactor = 0.0;
  std::size_t points = 0;
};

void fields(auto&& visit, Of<PowerFit> auto& f) {
  visit("exponent", f.exponent, Means{"growth exponent; null with fewer than 3 points", "1"});
  visit("standard_error", f.standard_error, Means{"standard error of it, from the scatter about the line", "1"});
  visit("prefactor", f.prefactor);
  visit("points", f.points, Means{"number of points", "1"});
}

/// Fits the points with low <= x <= high and finite positive y.
[[nodiscard]] PowerFit fit_power(const std::vector<double>& x, const std::vector<double>& y, double low, double high);

}  // namespace softgrain
