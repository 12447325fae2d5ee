#include "macrosim/twin_motion.h"

#include <algorithm>
#include <cmath>

#include "common/dynamics/slow_dynamics.h"
#include "common/dynamics/verlet.h"

namespace softgrain {

namespace {

/// The motion of a box whose edges shrink at these rates [1/s]: of its walls or cell, and of all bodies with it. What
/// is taken off at the end is that of the places where bodies are then.
Drive shrinking(const MacroSystem& macro, const Vec3& rate) {
  return [&macro, rate](System3& s, double share) {
    const Vec3 centre = box_centre(s, macro.box);
    auto& p = s.particles;
    for (std::size_t u = 0; u < at(p.size()); ++u) {
      const Vec3 place = carried_place(s, u);
      for (int k = 0; k < 3; ++k) p.velocity[u][k] -= share * rate[k] * (place[k] - centre[k]);
    }
    if (!macro.box.periodic) return;
    for (int k = 0; k < 3; ++k) s.cell.velocity_gradient[k][k] = share > 0.0 ? -rate[k] : 0.0;
  };
}

/// Planes go straight to where they have to be; the cell's edges, whose rate is one of what they are, as a logarithm.
Vec3 rates_of(const Vec3& strain, double duration, bool periodic) {
  Vec3 rate{};
  for (int k = 0; k < 3; ++k) rate[k] = (periodic ? -std::log1p(-strain[k]) : strain[k]) / duration;
  return rate;
}

/// Planes are driven and nothing else moves them: no velocity of theirs is left behind by rounding.
void stop_walls(System3& s) {
  for (Slot i = s.particles.first_plane(); i < s.particles.size(); ++i) s.particles.velocity[at(i)] = {};
}

}  // namespace

void strain_in_motion(MacroSystem& macro, const MacroSpec& spec, const Vec3& strain) {
  const double wave_speed = std::sqrt(spec.youngs_modulus / spec.density);
  const double largest = std::max({std::abs(strain[0]), std::abs(strain[1]), std::abs(strain[2])});
  if (largest > 0.0) {
    const double duration = largest * 2.0 * macro.largest_radius / (spec.twin.speed * wave_speed);
    run_slow(macro, shrinking(macro, rates_of(strain, duration, macro.box.periodic)), duration, spec.twin.step_factor);
    stop_walls(macro.system);
  }
  const double settle = spec.twin.settle_time * spec.soft_radius_max / wave_speed;
  if (settle > 0.0) run_slow(macro, {}, settle, spec.twin.step_factor);
  stop_motion(macro.system.particles);
}

}  // namespace softgrain
