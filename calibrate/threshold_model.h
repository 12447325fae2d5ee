// The joint threshold power law of several curves that share one threshold, as a least-squares problem.
#pragma once

#include <array>
#include <cmath>
#include <span>
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

/// Bounds of every exponent b.
inline constexpr ParameterBounds kExponentBounds{0.05, 12.0};

/// Where each parameter of each curve sits in the vector of a fit: delta first, then (A, b) per present curve.
struct JointLayout {
  std::array<std::size_t, kLawCurves> first{};
  std::size_t size = 1;

  explicit JointLayout(const std::array<bool, kLawCurves>& present);
  [[nodiscard]] std::vector<double> pack(const JointParameters& p) const;
  /// `shape` says which curves are present and their references.
  [[nodiscard]] JointParameters unpack(const JointParameters& shape, std::span<const double> x) const;
};

/// d F_j / d (delta, A, b) at one Delta; zero below the threshold.
std::array<double, 3> law_gradient(const JointParameters& p, std::size_t curve, double overlap_ratio);

/// Weighted residuals of all curves, exact Jacobian, bounds; delta in [0, infinity). Keeps a reference to `curves`.
LeastSquaresProblem joint_problem(const FitCurves& curves, const JointParameters& shape);

/// Parameters that hold which curves are present, and their references D_j.
JointParameters joint_shape(const FitCurves& curves);

/// Weight of a mean in the fit: sqrt(n)/sigma.
inline double mean_weight(const FitCurve& curve, std::size_t k) {
  return std::sqrt(curve.means.count[k]) / curve.sigma[k];
}

/// Row of a in law_parameters() for each curve; b follows it, delta is row 2.
inline constexpr std::array<std::size_t, kLawCurves> kRowOfA{0, 3, 5};

// The exact joint fit of threshold laws, kink and all, and the covariance of what it finds.

struct JointFit {
  JointParameters parameters;
  LeastSquaresFit fit;          ///< fit over [delta, A_j, b_j of each present curve]; covariance in units of sigma
  bool delta_at_zero = false;   ///< the threshold ran to its lower bound
  bool delta_at_limit = false;  ///< the threshold ran to its upper bound
  std::array<bool, kLawCurves> exponent_at_bound{};
};

/// Minimises sum_j sum_k n_jk [(mean_jk - F_j(D_k))/sigma_jk]^2; by the constancy of sigma and F over packings this is
/// the fit to all single packings. The residual has a kink where delta passes a measured Delta, so each interval
/// between neighbouring Deltas is fitted as a smooth problem with delta bounded to it, and the best interval wins:
/// exact, and no start can miss it. `delta_limit` bounds delta from above; 0 fixes delta = 0, the plain power law.
JointFit fit_joint(const FitCurves& curves, double delta_limit);

/// Joint fit from a known neighbour: it starts in the interval of `from` and walks on while delta runs into the
/// interval's end. The bootstrap uses it.
JointFit refit_joint(const FitCurves& curves, double delta_limit, const JointParameters& from);

/// Cluster-robust covariance of law_parameters(), packings being the clusters: H^-1 [G/(G-1) sum_g s_g s_g^T] H^-1, s_g
/// the score of packing g. Points of one packing move together, which (J^T J)^-1 alone would ignore. 7 x 7 row-major.
std::vector<double> packing_covariance(const JointFit& joint, const FitCurves& curves,
                                       const std::array<const CurveSamples*, kLawCurves>& samples);

}  // namespace softgrain
