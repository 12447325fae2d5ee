// Elastic materials, and the range of Poisson's ratio: once for scenes, cards, files and tables.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

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

/// Friction of a contact between grains of two materials: the smaller of both. It is the default of YADE
/// (Ip2_FrictMat_FrictMat_FrictPhys), and a bound that holds whatever the surfaces are: the contact slides where its
/// weaker side does. LAMMPS takes the geometric mean unless pair_coeff says otherwise.
inline double pair_friction(double mu1, double mu2) { return std::min(mu1, mu2); }

/// One of several materials that the solid grains of a packing are made of.
struct GrainMaterial {
  std::string name;
  double youngs_modulus = 0.0;  ///< E [Pa]
  double poisson_ratio = 0.0;   ///< nu
  double friction = 0.0;        ///< mu against its like; pair_friction() of two
  double density = 0.0;         ///< [kg/m^3]

  friend bool operator==(const GrainMaterial&, const GrainMaterial&) = default;
};

/// What grains are made of, by SizePiece::material; empty: all grains are alike, and no piece names a material.
struct GrainMaterials {
  std::vector<GrainMaterial> each;

  /// Every pair of materials has a law of its own, and a system has room for 64 of them.
  static constexpr std::size_t kMost = 9;

  [[nodiscard]] bool empty() const { return each.empty(); }
};

/// How the contacts of two spheres, or of a sphere and a wall, resist rolling (rolling_spring.h). All without
/// dimension.
struct RollingResistance {
  double friction = 0.0;   ///< mu_r: the moment is at most mu_r R12 Fn; 0: contacts roll freely
  double stiffness = 1.0;  ///< stiffness of the rolling spring over that of the tangential spring
  double damping = 1.0;    ///< dashpot constant of rolling over that of the contact

  /// Contacts that roll freely are alike.
  friend bool operator==(const RollingResistance& a, const RollingResistance& b) {
    return a.friction == b.friction && (a.friction == 0.0 || (a.stiffness == b.stiffness && a.damping == b.damping));
  }
};

/// Isotropic elasticity is stable for -1 < nu <= 1/2 (Landau and Lifshitz, Theory of Elasticity, section 5), and the
/// contact laws of Hertz and Mindlin hold there: E* = E/(1 - nu^2) and G* = G/(2 - nu) are finite and positive.
inline constexpr double kPoissonAbove = -1.0;
inline constexpr double kPoissonHighest = 0.5;
/// The smallest number above -1, for limits that include their ends.
inline constexpr double kPoissonLowest = kPoissonAbove + 0.5 * std::numeric_limits<double>::epsilon();

constexpr bool is_poisson_ratio(double nu) { return nu > kPoissonAbove && nu <= kPoissonHighest; }

}  // namespace softgrain
