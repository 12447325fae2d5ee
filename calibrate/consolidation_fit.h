// How a cohesive powder gives way under growing pressure: slope of plastic consolidation and approach to the densest
// state [PRE 78, 031305].
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace softgrain {

/// Solid fraction of one sample at each pressure of a loading, pressures rising, the same for all samples.
struct ConsolidationCurves {
  std::vector<double> pressure;               ///< P* = P a/F0
  std::vector<std::vector<double>> fraction;  ///< Phi, per sample and pressure
};

struct ConsolidationNumber {
  double value = 0.0;
  double error = 0.0;  ///< standard error; each number says of what
};

/// Regime II: 1/Phi falls by lambda per unit of ln P*. Before it (I) the structure of the assembly holds, beyond it
/// (III) Phi_max - Phi ~ P*^-alpha.
struct ConsolidationFit {
  bool usable = false;        ///< there is a steepest stretch
  std::string reason;         ///< what could not be determined, and why; empty: all of it
  ConsolidationNumber slope;  ///< lambda; its error is that over samples, of one sample that of the regression
  double low = 0.0;           ///< P* between which the slope was taken
  double high = 0.0;
  double begin = 0.0;  ///< P* at which that line meets the solid fraction of the lowest pressure: end of regime I
  std::optional<ConsolidationNumber> exponent{};  ///< alpha; errors of both are those of the fit to the mean curve
  std::optional<ConsolidationNumber> densest{};   ///< Phi_max
};

/// The slope is that of the steepest stretch of the mean curve with at least kSlopePoints points over at least a factor
/// kSlopeSpan in pressure; of samples each on its own over the same stretch. alpha and Phi_max by least squares over
/// the points of the mean curve from its end on, at least kApproachPoints; neither where one of them ends at a limit of
/// the search. Throws InputError where curves and pressures do not fit
/// together.
ConsolidationFit fit_consolidation(const ConsolidationCurves& curves);

inline constexpr std::size_t kSlopePoints = 4;
inline constexpr double kSlopeSpan = 4.0;
inline constexpr std::size_t kApproachPoints = 4;

}  // namespace softgrain
