// What a fit might have been instead: replicates of a bootstrap, in parallel, each with random numbers of its own;
// normal draws; and few numbers in place of many.
#pragma once

#include <cstdint>
#include <functional>
#include <type_traits>
#include <vector>

#include "common/core/random.h"
#include "common/io/interrupt.h"

namespace softgrain {

/// What `replicate(random)` returns for replicates 0 .. count - 1. The random numbers of replicate r are those of
/// (seed, RandomPurpose::bootstrap, first + r), so results do not depend on threads. After a signal it starts no
/// further replicate and throws Interrupted ("stopped by a signal while `doing`"). `replicate` must not throw.
template <class Replicate>
auto bootstrap_replicates(int count, std::uint64_t seed, std::uint64_t first, const char* doing,
                          const Replicate& replicate) {
  using Result = std::invoke_result_t<const Replicate&, RandomStream&>;
  std::vector<Result> all(static_cast<std::size_t>(count));
#pragma omp parallel for schedule(dynamic)
  for (int r = 0; r < count; ++r) {
    if (interrupt_requested()) continue;  // an exception must not leave the region
    RandomStream random(seed, RandomPurpose::bootstrap, first + static_cast<std::uint64_t>(r));
    all[static_cast<std::size_t>(r)] = replicate(random);
  }
  stop_if_interrupted(doing);
  return all;
}

// Few numbers in place of many: along which combinations of its parameters a law differs, from draw to draw, in what
// it says. Parameters of a law are nearly degenerate; its forces are not.

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

/// Correlations of `size` numbers from their covariance, or from any multiple of it, both size x size and row-major: 1
/// on the diagonal, 0 where a number does not scatter or its scatter is not known.
std::vector<double> correlations_of(const std::vector<double>& covariance, std::size_t size);

/// The same from draws of the numbers, one a row.
std::vector<double> correlations(const std::vector<std::vector<double>>& draws, std::size_t size);

/// Mean and covariance (row-major) of numbers of a normal distribution.
struct NormalNumbers {
  std::vector<double> mean;
  std::vector<double> covariance;
};

/// What is known of the numbers once some of them, `which`, have been measured: m + C_w (C_ww + S)^-1 (y - m_w), and C
/// less C_w (C_ww + S)^-1 C_w^T (Rasmussen and Williams 2006, Gaussian Processes for Machine Learning, ISBN 026218253X,
/// eq. A.6). y and S: all numbers as measured, and their covariance; those not in `which` are not looked at.
NormalNumbers updated(const NormalNumbers& before, const std::vector<std::size_t>& which,
                      const NormalNumbers& measured);

/// Draws from the normal distribution with this mean and covariance (n x n, row-major); parameters of variance zero
/// stay. Throws InputError where the covariance is not finite or not positive.
std::vector<std::vector<double>> normal_draws(const std::vector<double>& mean, const std::vector<double>& covariance,
                                              std::int64_t count, std::uint64_t seed);

}  // namespace softgrain
