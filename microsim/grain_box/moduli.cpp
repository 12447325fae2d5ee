#include "microsim/grain_box/moduli.h"
#include "common/core/limits.h"

#include <gsl/gsl_fit.h>

#include <cmath>
#include <numbers>

namespace softgrain {

namespace {

constexpr double kUndefinedBelow = 1e-3;

Vec3 deviator(const Vec3& a) {
  const double mean = (a[0] + a[1] + a[2]) / 3.0;
  return {{a[0] - mean, a[1] - mean, a[2] - mean}};
}

}  // namespace

Moduli hooke_moduli(const Vec3& ds, const Vec3& de) {
  const double size = norm(de);
  const double volume = de[0] + de[1] + de[2];
  const Vec3 shape = deviator(de);
  Moduli out{kNaN, kNaN};
  if (std::abs(volume) > kUndefinedBelow * size) out.bulk = (ds[0] + ds[1] + ds[2]) / (3.0 * volume);
  if (norm(shape) > kUndefinedBelow * size) out.shear = dot(deviator(ds), shape) / (2.0 * norm2(shape));
  return out;
}

Moduli effective_medium(const MediumState& s) {
  const double c = s.coordination * s.solid_fraction * s.shear_modulus / (std::numbers::pi * (1.0 - s.poisson_ratio));
  const double base = std::cbrt(c * c * s.pressure);
  const double nu = s.poisson_ratio;
  return {base * std::cbrt(1.0 / 18.0), (5.0 - 4.0 * nu) / (5.0 * (2.0 - nu)) * base * std::cbrt(1.5)};
}

PowerFit fit_power(const std::vector<double>& x, const std::vector<double>& y, double low, double high) {
  std::vector<double> u;
  std::vector<double> v;
  for (std::size_t k = 0; k < x.size() && k < y.size(); ++k) {
    if (!(x[k] >= low) || !(x[k] <= high) || !std::isfinite(y[k]) || !(y[k] > 0.0)) continue;
    u.push_back(std::log(x[k]));
    v.push_back(std::log(y[k]));
  }
  PowerFit fit{kNaN, kNaN, kNaN, u.size()};
  if (u.size() < 3 || u.front() == u.back()) return fit;
  double intercept = 0.0;
  double cov00 = 0.0;
  double cov01 = 0.0;
  double cov11 = 0.0;
  double sum = 0.0;
  gsl_fit_linear(u.data(), 1, v.data(), 1, u.size(), &intercept, &fit.exponent, &cov00, &cov01, &cov11, &sum);
  fit.standard_error = std::sqrt(cov11);
  fit.prefactor = std::exp(intercept);
  return fit;
}

}  // namespace softgrain
