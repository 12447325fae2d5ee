// Bootstrap: refits to resampled ensembles (over packings) or to redrawn residuals, and quantiles of what they give.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "calibrate/curve_samples.h"
#include "calibrate/threshold_model.h"
#include "common/core/random.h"

namespace softgrain {

struct BootstrapInput {
  std::array<CurveSamples, kLawCurves> samples;  ///< curves that take no part are empty
  FitCurves curves;                              ///< the full ensemble: its sigma weights replicates of packings
  double delta_limit = 0.0;
  JointParameters start;                      ///< the fit to the full ensemble
  std::vector<double> threshold_shares = {};  ///< further starts: the threshold of `start` times these
  double scatter_floor = 0.0;                 ///< scatter floor of experiment_errors(), for redrawn residuals
  std::vector<double> zeroed_below = {};      ///< see FitOptions
};

struct BootstrapResult {
  std::vector<std::array<double, 7>> replicates;
  int failed = 0;
  int at_bound = 0;
};

/// Draws packings with replacement and refits. Replicate r depends on (seed, stream, r) alone, not on threads.
BootstrapResult bootstrap(const BootstrapInput& input, int replicates, std::uint64_t seed, std::uint64_t stream);

/// Bootstrap for fewer samples than can be drawn from: noise of the size of the residuals is added to the fit, and the
/// law is fitted again. The new fit is weighted by the errors that the new curve shows, because errors told from the
/// curve itself scatter, and with them the fit. The shape of the noise over Delta is that of sigma, and one normal
/// random number serves as many neighbouring points as residuals are correlated over. With given errors of the normal
/// force the noise is at least as large as these. Several samples differ besides by a factor of their normal force,
/// drawn for each of them with the scatter of the measured factors times Student's t over the normal quantile: the mean
/// of n samples is known as t with n - 1 degrees of freedom says. Of a single sample the result says nothing about
/// others.
BootstrapResult residual_bootstrap(const BootstrapInput& input, const std::vector<GivenError>& given, int replicates,
                                   std::uint64_t seed, std::uint64_t stream);

/// Covariance of the replicates, 7 x 7 row-major; zeros with fewer than two.
std::vector<double> replicate_covariance(const std::vector<std::array<double, 7>>& replicates);

/// Quantiles 2.5 % and 97.5 %; infinite when there are no values. Linear between order statistics x_1..x_n at p (n +
/// 1): one more value would be between them with a probability of 95 % from n = 39 on, with fewer the ends are the
/// extremes.
std::pair<double, double> interval95(const std::vector<double>& values);

/// Standard deviation of a sample; infinite with fewer than two values.
double scatter_of(const std::vector<double>& values);

// Curves whose residuals about a fit were drawn anew: a parametric bootstrap in blocks.

class ResidualDraws {
 public:
  /// Keeps a reference to `input`.
  ResidualDraws(const BootstrapInput& input, const std::vector<GivenError>& given);

  /// The fit plus residuals, one normal random number per block of neighbouring points of a sample, and the errors that
  /// experiment_errors() finds in that.
  [[nodiscard]] FitCurves draw(RandomStream& random) const;

 private:
  struct Curve {
    std::vector<double> fitted;     ///< per Delta
    std::vector<double> amplitude;  ///< samples x Delta; NaN where nothing was measured
    std::size_t block = 1;          ///< points
    double between = 0.0;           ///< scatter of the factor by which samples differ
  };
  void prepare(std::size_t curve);
  [[nodiscard]] std::vector<double> factors(std::size_t curve) const;
  void set_to_zero(CurveSamples& drawn) const;

  const BootstrapInput& input_;
  std::array<Curve, kLawCurves> curves_;
  std::array<std::vector<GivenError>, kLawCurves> given_;
};

}  // namespace softgrain
