#include "macrosim/test_protocol.h"

#include <cmath>

namespace softgrain {

namespace {

/// Step k of `total` equal ones to the nominal strain `end`, as a share of the length before it.
double nominal_step(double end, std::int64_t k, std::int64_t total) {
  const auto at = [&](std::int64_t n) { return end * static_cast<double>(n) / static_cast<double>(total); };
  return 1.0 - (1.0 - at(k)) / (1.0 - at(k - 1));
}

}  // namespace

std::int64_t recorded_points(const MacroSpec& spec) { return preload_points(spec) + spec.steps + 1; }

std::int64_t preload_points(const MacroSpec& spec) {
  return spec.test == MacroTest::shear && spec.preload > 0.0 ? spec.preload_steps : 0;
}

double strain_at(const MacroSpec& spec, std::int64_t point) {
  const std::int64_t before = preload_points(spec);
  if (point < before) return -spec.preload * static_cast<double>(before - point) / static_cast<double>(before);
  return spec.strain_end * static_cast<double>(point - before) / static_cast<double>(spec.steps);
}

Vec3 strain_increment(const MacroSpec& spec, std::int64_t point, std::int64_t k) {
  const std::int64_t n = (point - 1) * spec.increments_per_step + k;
  const std::int64_t preloading = preload_points(spec) * spec.increments_per_step;
  const std::int64_t total = spec.steps * spec.increments_per_step;
  if (spec.test == MacroTest::shear) {
    if (n <= preloading) {
      const double factor = nominal_step(spec.preload, n, preloading);
      return {{factor, factor, factor}};
    }
    const double logarithmic = spec.strain_end / static_cast<double>(total);
    return {{-std::expm1(logarithmic), 0.0, -std::expm1(-logarithmic)}};
  }
  const double factor = nominal_step(spec.strain_end, n, total);
  if (spec.test == MacroTest::isotropic) return {{factor, factor, factor}};
  return {{0.0, 0.0, factor}};
}

double test_force_floor(const MacroSpec& spec, double largest_radius) {
  return spec.force_floor * spec.youngs_modulus * largest_radius * largest_radius;
}

}  // namespace softgrain
