// How much a number depends on each of several inputs: rank correlation, regression, Sobol indices, each with its 95 %
// interval.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/core/limits.h"

namespace softgrain {

/// A measure of dependence [1] with its 95 % interval.
struct EffectSize {
  double value = kNaN;
  double low = kNaN;
  double high = kNaN;
};

inline constexpr std::size_t kLeastRanked = 8;        ///< points for a rank correlation
inline constexpr std::size_t kLeastRegressed = 10;    ///< points for a regression, and three for each coefficient
inline constexpr std::size_t kLeastBasePoints = 16;   ///< base points for Sobol indices
inline constexpr std::size_t kMostSobolColumns = 40;  ///< columns of a Sobol sequence

/// Whether not all values are equal.
bool varies(std::span<const double> values);

/// Points that a regression on so many columns needs.
std::size_t least_regressed(std::size_t columns);

/// Spearman's rank correlation; equal values share the mean of their ranks. Interval by Fisher's transformation
/// z = atanh r with the standard error sqrt((1 + r^2/2)/(n - 3)) (Bonett and Wright 2000, doi:10.1007/BF02294183); an
/// r of 1 or -1 is known to half of its smallest step, 6/(n^3 - n), at best. None for fewer than kLeastRanked points,
/// or where all x or all y are equal. x and y are of one length and finite.
std::optional<EffectSize> rank_correlation(std::span<const double> x, std::span<const double> y);

/// Standardised coefficients of a linear regression.
struct Regression {
  std::vector<EffectSize> coefficients;  ///< b_k s(x_k)/s(y) with intervals by Student's t, one per column
  double determination = kNaN;           ///< share of the variance of y that it explains (R^2)
};

/// Regression of y on the columns x. None for fewer than kLeastRegressed points or three for each coefficient, or where
/// y or a column does not vary, or columns depend linearly on each other.
std::optional<Regression> standardised_regression(const std::vector<std::vector<double>>& columns,
                                                  std::span<const double> y);

/// What a function gives at the points of two independent samples A and B, and at those of A with one input from B.
struct SobolSample {
  std::vector<double> a;
  std::vector<double> b;
  std::vector<std::vector<double>> mixed;  ///< per input
};

struct SobolIndices {
  std::vector<EffectSize> first;  ///< S_i: share of the variance that the input causes alone
  std::vector<EffectSize> total;  ///< T_i: share that it takes part in, with all others
};

/// S_i = 1 - sum (b - ab_i)^2/(2 N V), T_i = sum (a - ab_i)^2/(2 N V), V the variance over a and b: the estimators of
/// Jansen (1999, doi:10.1016/S0010-4655(98)00154-4) as Saltelli et al. (2010, doi:10.1016/j.cpc.2009.09.018) recommend
/// them. Intervals by bootstrap over the N base points, drawn from `seed` and `stream`. None for fewer than
/// kLeastBasePoints of them or without variance.
std::optional<SobolIndices> sobol_indices(const SobolSample& sample, std::uint64_t seed, std::uint64_t stream);

}  // namespace softgrain
