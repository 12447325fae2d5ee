// Curves whose residuals about a fit were drawn anew: a parametric bootstrap in blocks.
#pragma once

#include <array>
#include <vector>

#include "calibrate/bootstrap.h"
#include "common/core/random.h"

namespace softgrain {

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
  };
  void prepare(std::size_t curve);
  void set_to_zero(CurveSamples& drawn) const;

  const BootstrapInput& input_;
  std::array<Curve, kLawCurves> curves_;
  std::array<std::vector<GivenError>, kLawCurves> given_;
};

}  // namespace softgrain
