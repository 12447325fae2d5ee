// The range of Poisson's ratio, once for scenes, cards, files and tables.
#pragma once

#include <limits>

namespace softgrain {

/// Isotropic elasticity is stable for -1 < nu <= 1/2 (Landau and Lifshitz, Theory of Elasticity, section 5), and the
/// contact laws of Hertz and Mindlin hold there: E* = E/(1 - nu^2) and G* = G/(2 - nu) are finite and positive.
inline constexpr double kPoissonAbove = -1.0;
inline constexpr double kPoissonHighest = 0.5;
/// The smallest number above -1, for limits that include their ends.
inline constexpr double kPoissonLowest = kPoissonAbove + 0.5 * std::numeric_limits<double>::epsilon();

constexpr bool is_poisson_ratio(double nu) { return nu > kPoissonAbove && nu <= kPoissonHighest; }

}  // namespace softgrain
