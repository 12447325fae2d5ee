#include "common/packing/grading_indices.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace softgrain {

namespace {

constexpr int kFullerPoints = 200;  // evenly over ln D

/// Passing of Fuller's curve where ln(D/Dmin) is the part x of ln(Dmax/Dmin) = `span`.
double fuller_passing(double q, double span, double x) { return std::expm1(q * span * x) / std::expm1(q * span); }

struct FullerFit {
  std::vector<double> passing{};
  double span = 0.0;

  [[nodiscard]] double part(std::size_t k) const {
    return (static_cast<double>(k) + 0.5) / static_cast<double>(passing.size());
  }
  [[nodiscard]] double squares(double q) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < passing.size(); ++k) {
      const double difference = passing[k] - fuller_passing(q, span, part(k));
      sum += difference * difference;
    }
    return sum;
  }
  [[nodiscard]] double largest_difference(double q) const {
    double most = 0.0;
    for (std::size_t k = 0; k < passing.size(); ++k)
      most = std::max(most, std::abs(passing[k] - fuller_passing(q, span, part(k))));
    return most;
  }
  /// Golden sections between the neighbours of the best of many exponents.
  [[nodiscard]] double best() const {
    constexpr double kStep = 0.01;
    constexpr int kSteps = 300;
    int at = 1;
    for (int k = 2; k <= kSteps; ++k)
      if (squares(kStep * k) < squares(kStep * at)) at = k;
    double low = kStep * std::max(at - 1, 1);
    double high = kStep * std::min(at + 1, kSteps);
    while (high - low > 1e-9) {
      const double part = (high - low) / std::numbers::phi;
      (squares(high - part) < squares(low + part) ? high : low) =
          squares(high - part) < squares(low + part) ? low + part : high - part;
    }
    return 0.5 * (low + high);
  }
};

}  // namespace

double diameter_passing(const Grading& grading, double share) {
  double low = std::log(grading.smallest());
  double high = std::log(grading.largest());
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (grading.passing(std::exp(middle)) < share ? low : high) = middle;
  }
  return 2.0 * std::exp(high);
}

GradingIndices grading_indices(const Grading& grading) {
  GradingIndices out;
  out.d10 = diameter_passing(grading, 0.1);
  out.d30 = diameter_passing(grading, 0.3);
  out.d50 = diameter_passing(grading, 0.5);
  out.d60 = diameter_passing(grading, 0.6);
  out.cu = out.d60 / out.d10;
  out.cc = out.d30 * out.d30 / (out.d60 * out.d10);
  FullerFit fit;
  fit.span = std::log(grading.largest() / grading.smallest());
  if (!(fit.span > 0.0)) return out;
  fit.passing.resize(kFullerPoints);
  for (std::size_t k = 0; k < fit.passing.size(); ++k)
    fit.passing[k] = grading.passing(grading.smallest() * std::exp(fit.span * fit.part(k)));
  out.fuller = fit.best();
  out.fuller_difference = fit.largest_difference(out.fuller);
  return out;
}

}  // namespace softgrain
