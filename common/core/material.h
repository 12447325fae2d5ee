// Elastic materials.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <string>

namespace softgrain {

struct Material {
  std::string name;
  double density = 0.0;         ///< [kg/m^3]
  double youngs_modulus = 0.0;  ///< E [Pa]; infinite when rigid
  double poisson_ratio = 0.0;   ///< nu
  bool rigid = false;           ///< takes no part in the deformation of a contact

  /// (1 - nu^2)/E, the compliance in Hertz' theory [1/Pa].
  [[nodiscard]] double normal_compliance() const {
    return rigid ? 0.0 : (1.0 - poisson_ratio * poisson_ratio) / youngs_modulus;
  }
  /// (2 - nu)/(8 G), G = E/(2 (1 + nu)), the compliance in Mindlin's theory [1/Pa].
  [[nodiscard]] double tangential_compliance() const {
    return rigid ? 0.0 : (2.0 - poisson_ratio) * (1.0 + poisson_ratio) / (4.0 * youngs_modulus);
  }
};

}  // namespace softgrain
