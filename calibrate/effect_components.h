// Few numbers in place of many: along which combinations of its parameters a law differs, from draw to draw, in what it
// says. Parameters of a law are nearly degenerate; its forces are not.
#pragma once

#include <cstdint>
#include <vector>

namespace softgrain {

/// Components of the scatter of draws, the largest first.
struct EffectComponents {
  /// Change of the parameters by one standard deviation of each component.
  std::vector<std::vector<double>> direction;
  std::vector<std::vector<double>> scores;  ///< per draw and component, in standard deviations
  double explained = 0.0;                   ///< share of the variance of the effects that they hold
};

/// Principal components of `effects` (one row per draw: what the law says at some states), at most `most`, until they
/// hold `share` of the variance; the direction of a component is the regression of the parameters on its scores.
/// `parameters`: one row per draw. Throws InputError for fewer than three draws, or rows of unequal lengths.
EffectComponents effect_components(const std::vector<std::vector<double>>& parameters,
                                   const std::vector<std::vector<double>>& effects, std::size_t most, double share);

/// Draws from the normal distribution with this mean and covariance (n x n, row-major); parameters of variance zero
/// stay. Throws InputError where the covariance is not finite or not positive.
std::vector<std::vector<double>> normal_draws(const std::vector<double>& mean, const std::vector<double>& covariance,
                                              std::int64_t count, std::uint64_t seed);

}  // namespace softgrain
