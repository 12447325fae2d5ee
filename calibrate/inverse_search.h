// The reverse problem: which parameters of a simulation give a target curve? A search with few, noisy evaluations.
//
// Every evaluation gives curves F_k(D_j) of the same numbered packings k. Points spread over the box (Halton) come
// first; then quadratic surfaces are laid through g(mean F) of all of them, g(F) = asinh(F/c_j), weighted towards the
// best point, and further points are put around the place where the surfaces come nearest to the target. The interval
// of the answer comes from drawing packings, evaluations and the target anew and repeating the last step.
#pragma once

#include <cstdint>
#include <vector>

namespace softgrain {

/// The curve that is wanted, and how well it is known.
struct InverseTarget {
  std::vector<double> delta;
  std::vector<double> force;
  std::vector<double> error;  ///< standard error of each force, 0: not known
  double discrepancy = 0.05;  ///< what a simulation with the right parameters may be off, as a share of the force
};

/// One point of the box that was simulated.
struct InverseEvaluation {
  std::vector<double> u;  ///< coordinates in [0, 1]^d
  std::size_t packings = 0;
  std::vector<double> force;  ///< packings x delta, row-major; NaN where a packing gave none

  [[nodiscard]] bool usable(std::size_t deltas) const;  ///< every Delta has a force of some packing
};

/// A point of a low-discrepancy sequence in [0, 1]^d (d up to 8), shifted by a random number of the seed.
std::vector<double> spread_point(std::uint64_t seed, std::size_t index, std::size_t dimensions);

/// The next `count` points: the best guess first, then points around it, as far as it is uncertain.
std::vector<std::vector<double>> next_points(const std::vector<InverseEvaluation>& done, const InverseTarget& target,
                                             std::uint64_t seed, std::size_t count);

/// sum_j ((mean F_j - target_j)/error_j)^2 over the number of Deltas; errors of target, of the mean over packings, and
/// the discrepancy. Infinite when not usable.
double misfit_of(const InverseEvaluation& evaluation, const InverseTarget& target);

struct InverseAnswer {
  std::vector<double> u;    ///< best point
  std::vector<double> low;  ///< 95 % interval of each coordinate
  std::vector<double> high;
  std::vector<double> standard_error;  ///< standard errors from the curvature of the surface at the best point
  std::vector<bool> open;              ///< the interval reaches an end of the range: it is not closed by the target
  std::vector<double> correlation;     ///< d x d of the replicates
  std::vector<double> predicted;       ///< curve by the surface at the best point
  double misfit = 0.0;                 ///< chi^2 of the surface at the best point, per Delta
  double lack_of_fit = 0.0;  ///< rms distance of means near the best point from the surface, over their errors
  int replicates = 0;
};

/// The answer and its interval: `replicates` draws, widened for the small number of packings (Student), and every
/// evaluated point that is as good as the best one (chi^2 within 3.84). Throws UnusableResult when fewer evaluations
/// are usable than the surface has coefficients.
InverseAnswer answer(const std::vector<InverseEvaluation>& done, const InverseTarget& target, std::uint64_t seed,
                     int replicates);

}  // namespace softgrain
