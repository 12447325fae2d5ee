#include "calibrate/tangential_stiffness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softgrain {

namespace {

/// Angles are equal when they differ by less than this share of the larger one [-], plus rounding.
constexpr double kAngleTolerance = 1e-6;

bool usable(const TangentialPoint& p) { return p.converged && std::isfinite(p.force_parallel); }

bool same_angle(double a, double b) {
  return std::abs(a - b) <= kAngleTolerance * std::max(std::abs(a), std::abs(b)) + 1e-12;
}

std::optional<double> force_at(const std::vector<TangentialPoint>& points, double angle_deg) {
  for (const TangentialPoint& p : points)
    if (usable(p) && same_angle(p.angle_deg, angle_deg)) return p.force_parallel;
  return std::nullopt;
}

}  // namespace

double tangential_displacement(double angle_deg, double shell_radius) {
  return std::numbers::pi * shell_radius * angle_deg / 180.0;
}

std::optional<double> initial_slope(const std::vector<TangentialPoint>& points, double angle_deg, double shell_radius) {
  double n = 0.0;
  double sum_h = 0.0;
  double sum_f = 0.0;
  const auto used = [&](const TangentialPoint& p) {
    return usable(p) && std::abs(p.angle_deg) <= angle_deg * (1.0 + kAngleTolerance);
  };
  for (const TangentialPoint& p : points) {
    if (!used(p)) continue;
    n += 1.0;
    sum_h += tangential_displacement(p.angle_deg, shell_radius);
    sum_f += p.force_parallel;
  }
  if (n < 2.0) return std::nullopt;
  double hh = 0.0;
  double hf = 0.0;
  for (const TangentialPoint& p : points) {
    if (!used(p)) continue;
    const double h = tangential_displacement(p.angle_deg, shell_radius) - sum_h / n;
    hh += h * h;
    hf += h * (p.force_parallel - sum_f / n);
  }
  const double resolution = kAngleTolerance * tangential_displacement(angle_deg, shell_radius);
  if (hh <= resolution * resolution) return std::nullopt;
  return hf / hh;
}

std::optional<double> secant(const std::vector<TangentialPoint>& points, double angle_deg, double shell_radius) {
  const double ht = tangential_displacement(angle_deg, shell_radius);
  const auto plus = force_at(points, angle_deg);
  const auto minus = force_at(points, -angle_deg);
  if (plus && minus) return (*plus - *minus) / (2.0 * ht);
  const auto before = force_at(points, 0.0);
  if (plus && before) return (*plus - *before) / ht;
  if (minus && before) return (*before - *minus) / ht;
  return std::nullopt;
}

}  // namespace softgrain
