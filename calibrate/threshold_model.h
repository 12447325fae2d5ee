// The joint threshold power law of several curves that share one threshold, and its exact fit.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibrate/curve_samples.h"
#include "calibrate/least_squares.h"

namespace softgrain {

/// The curves of a joint fit, in the order of kLawParameterNames.
enum class LawCurve : std::size_t { normal = 0, tangential_initial = 1, tangential_secant = 2 };
inline constexpr std::size_t kLawCurves = 3;

/// Means with their single-packing errors sigma. A curve without points takes no part.
struct FitCurve {
  CurveMeans means;
  std::vector<double> sigma;
  [[nodiscard]] bool present() const { return !means.delta.empty(); }
};
using FitCurves = std::array<FitCurve, kLawCurves>;

/// F_j(D) = A_j [(D/D_j)^b_j - (delta/D_j)^b_j] above delta, 0 below; D_j is the largest Delta of the curve.
/// In these variables A and b are far less correlated than a = A D_j^-b and b.
struct JointParameters {
  double delta = 0.0;
  std::array<double, kLawCurves> scale{};      ///< A_j
  std::array<double, kLawCurves> exponent{};   ///< b_j
  std::array<double, kLawCurves> reference{};  ///< D_j
  std::array<bool, kLawCurves> present{};

  [[nodiscard]] double value(std::size_t curve, double overlap_ratio) const;
  /// (a_n, b_n, delta, a_i, b_i, a_s, b_s) of the law a D^b + c; zeros for curves that are not present.
  [[nodiscard]] std::array<double, 7> law_parameters() const;
};

struct JointFit {
  JointParameters parameters;
  LeastSquaresFit fit;               ///< over [delta, A_j, b_j of each present curve]; covariance in units of sigma
  bool delta_at_zero = false;        ///< the threshold ran to its lower bound
  bool delta_at_limit = false;       ///< the threshold ran to its upper bound
  std::array<bool, kLawCurves> exponent_at_bound{};
};

/// Bounds of every exponent b.
inline constexpr ParameterBounds kExponentBounds{0.05, 12.0};

/// Minimises sum_j sum_k n_jk [(mean_jk - F_j(D_k))/sigma_jk]^2; by the constancy of sigma and F over packings this is the fit to
/// all single packings. The residual has a kink where delta passes a measured Delta, so each interval between neighbouring Deltas
/// is fitted as a smooth problem with delta bounded to it, and the best interval wins: exact, and no start can miss it.
/// `delta_limit` bounds delta from above; 0 fixes delta = 0, the plain power law.
JointFit fit_joint(const FitCurves& curves, double delta_limit);

/// The same from a known neighbour: starts in its interval and walks on while delta runs into the interval's end.
/// What the bootstrap uses.
JointFit refit_joint(const FitCurves& curves, double delta_limit, const JointParameters& from);

/// Cluster-robust covariance of law_parameters(), packings being the clusters: H^-1 [G/(G-1) sum_g s_g s_g^T] H^-1, s_g the
/// score of packing g. Points of one packing move together, which (J^T J)^-1 alone would ignore. 7 x 7 row-major.
std::vector<double> packing_covariance(const JointFit& joint, const FitCurves& curves,
                                       const std::array<const CurveSamples*, kLawCurves>& samples);

}  // namespace softgrain
