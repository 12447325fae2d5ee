// Preparation to a density that was measured: the friction between particles while they are compacted is searched, the
// parameter that sets the density of a packing (Agnolin and Roux 2007, Phys. Rev. E 76, 061302,
// doi 10.1103/PhysRevE.76.061302).
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/core/enum_names.h"
#include "common/core/error.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

/// How a density is said.
enum class DensityMeasure { solid_fraction, void_ratio, dry_density };

template <>
inline constexpr auto enum_names<DensityMeasure> =
    enum_name_list<DensityMeasure>({{DensityMeasure::solid_fraction, "solid_fraction"},
                                    {DensityMeasure::void_ratio, "void_ratio"},
                                    {DensityMeasure::dry_density, "dry_density"}});

/// The density that a preparation has to reach at the start pressure.
struct DensityTarget {
  DensityMeasure measure = DensityMeasure::solid_fraction;
  double value = 0.0;       ///< solid fraction or void ratio [1], or mass of grains per volume [kg/m^3]
  double tolerance = 2e-3;  ///< largest difference of solid fractions

  /// `density`: of the grains [kg/m^3].
  [[nodiscard]] double solid_fraction(double density) const;
  /// What a solid fraction is in this measure.
  [[nodiscard]] double measured(double solid_fraction, double density) const;
  /// "void_ratio = 0.6 (solid fraction 0.625 +- 0.001)".
  [[nodiscard]] std::string text(double density) const;
};

/// A target that the preparation does not reach: the message says what it reaches.
class DensityNotReached : public UnusableResult {
 public:
  using UnusableResult::UnusableResult;
};

/// Preparations of a sample in a search, at most. Where the solid fraction falls smoothly with friction, as of
/// thousands of particles, it takes 4 to 7; of 150 particles it jumps by a few 0.001, and a search takes 3 to 20, at
/// the default tolerance.
inline constexpr int kMostDensityTries = 30;
inline constexpr int kUsualDensityTries = 7;

/// The packing of a sample that `prepare` makes with a friction between particles, at the friction from 0 to
/// `largest_friction` with which it has the density that is asked for: both ends first, then regula falsi and bisection
/// in turn. The same tries for the same packings. Cost is that of all tries. Throws DensityNotReached: after two tries
/// when the target is outside of what the ends give.
MacroPacking pack_to_density(const DensityTarget& target, double grain_density, double largest_friction,
                             std::int64_t sample, const std::function<MacroPacking(double friction)>& prepare);

}  // namespace softgrain
