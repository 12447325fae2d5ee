#include "microsim/powder/powder_forces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softgrain {

namespace {

/// A straight pull is 180 degrees exactly, and belongs to the last bin.
double angle_of(const PowderInteraction& pair) {
  const double angle = std::atan2(std::abs(pair.tangential_force), pair.normal_force) * 180.0 / std::numbers::pi;
  return std::min(angle, std::nextafter(180.0, 0.0));
}

void add_normals(const std::vector<PowderInteraction>& pairs, double zero, PowderForces& out) {
  double mean = 0.0;
  for (const auto& pair : pairs) {
    out.normal.add(pair.normal_force);
    mean += pair.normal_force / static_cast<double>(pairs.size());
  }
  if (mean < zero) return;
  for (const auto& pair : pairs) out.normal_over_mean.add(pair.normal_force / mean);
}

}  // namespace

PowderForces powder_forces(const std::vector<PowderInteraction>& pairs, double zero) {
  PowderForces out;
  add_normals(pairs, zero, out);
  std::int64_t contacts = 0;
  std::int64_t idle = 0;
  for (const auto& pair : pairs) {
    if (pair.distant) continue;
    ++contacts;
    if (pair.force() < zero) {
      ++idle;
      continue;
    }
    out.ratio.add(std::abs(pair.tangential_force / pair.normal_force));
    out.angle.add(angle_of(pair));
  }
  if (contacts > 0) out.zero_share = static_cast<double>(idle) / static_cast<double>(contacts);
  return out;
}

}  // namespace softgrain
