#include "common/packing/grading.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/core/error.h"

namespace softgrain {

double PowerLawRadii::radius(double u) const {
  const double power = 1.0 - exponent;
  const double low = std::pow(rmin, power);
  const double high = std::pow(rmax, power);
  return std::clamp(std::pow(low + u * (high - low), 1.0 / power), rmin, rmax);
}

double PowerLawRadii::share_above(double r) const {
  const double power = 1.0 - exponent;
  if (r <= rmin) return 1.0;
  if (r >= rmax) return 0.0;
  return (std::pow(r, power) - std::pow(rmax, power)) / (std::pow(rmin, power) - std::pow(rmax, power));
}

namespace {

/// Moments of x = ln(r/rmin) under density ~ exp(-q x) on [0, length], q = b - 1.
struct LogMoments {
  double mean = 0.0;
  double variance = 0.0;
};

LogMoments log_moments(double q, double length) {
  const double y = q * length;
  if (std::abs(y) < 1e-3) return {length * (0.5 - y / 12.0), length * length / 12.0};
  const double e = std::expm1(y);
  const double half = 0.5 * y;
  return {length * (1.0 / y - 1.0 / e),
          length * length * (1.0 / (y * y) - 1.0 / (4.0 * std::sinh(half) * std::sinh(half)))};
}

struct Score {
  double mean = 0.0;
  double length = 0.0;
};

double score(double q, void* data) {
  const auto* s = static_cast<const Score*>(data);
  return log_moments(q, s->length).mean - s->mean;
}

double root_of_score(Score& s) {
  gsl_function f{&score, &s};
  const std::unique_ptr<gsl_root_fsolver, decltype(&gsl_root_fsolver_free)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), &gsl_root_fsolver_free);
  const double bound = 300.0 / s.length;
  gsl_root_fsolver_set(solver.get(), &f, -bound, bound);
  for (int k = 0; k < 200; ++k) {
    gsl_root_fsolver_iterate(solver.get());
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()), gsl_root_fsolver_x_upper(solver.get()), 0.0,
                               1e-12) == GSL_SUCCESS)
      break;
  }
  return gsl_root_fsolver_root(solver.get());
}

}  // namespace

ExponentFit fit_exponent(const std::vector<double>& radii) {
  if (radii.size() < 3) throw InputError("exponent of a size distribution: fewer than three radii");
  const auto [low, high] = std::minmax_element(radii.begin(), radii.end());
  Score s;
  s.length = std::log(*high / *low);
  if (!(s.length > 0.0)) throw InputError("exponent of a size distribution: all radii are equal");
  for (const double r : radii) s.mean += std::log(r / *low) / static_cast<double>(radii.size());
  const double q = root_of_score(s);
  const double variance = log_moments(q, s.length).variance;
  return {q + 1.0, 1.0 / std::sqrt(static_cast<double>(radii.size()) * variance)};
}

}  // namespace softgrain
