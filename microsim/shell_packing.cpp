#include "microsim/shell_packing.h"

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/io/interrupt.h"
#include "common/packing/size_distribution.h"
#include "microsim/shell_placement.h"

namespace softgrain {

namespace {

std::vector<double> draw_radii(const SoftParticleSpec& spec, std::uint64_t seed, std::uint64_t index) {
  const double rmax = spec.rmax_over_shell;
  const PowerLawRadii law{spec.exponent, rmax / spec.polydispersity, rmax};
  RandomStream random(seed, RandomPurpose::radii, index);
  std::vector<double> radii;
  double volume = 0.0;  // in units of the shell's
  while (volume <= spec.beta) {
    radii.push_back(law.radius(random.uniform()));
    volume += radii.back() * radii.back() * radii.back();
  }
  std::sort(radii.begin(), radii.end(), std::greater<>());
  return radii;
}

/// Largest first, each grain grows until it touches its nearest neighbour or the shell.
void grow(ShellPacking& packing) {
  for (std::size_t i = 0; i < packing.radius.size(); ++i) {
    double room = 1.0 - norm(packing.position[i]);
    for (std::size_t j = 0; j < packing.radius.size(); ++j)
      if (j != i) room = std::min(room, norm(packing.position[i] - packing.position[j]) - packing.radius[j]);
    packing.radius[i] = std::max(packing.radius[i], room);
  }
}

}  // namespace

ShellPacking generate_shell_packing(const SoftParticleSpec& spec, std::uint64_t seed, std::uint64_t index) {
  ShellPacking packing;
  packing.seed = index;
  PlacedGrains grains(packing);
  VoidPlacement voids(spec.rmax_over_shell / spec.polydispersity);
  RandomStream random(seed, RandomPurpose::positions, index);
  for (const double r : draw_radii(spec, seed, index)) {
    stop_if_interrupted("packing");
    const std::optional<Vec3> x = spec.placement == Placement::voids ? voids.place(grains, r, spec.trials, random)
                                                                     : place_by_trials(grains, r, spec.trials, random);
    if (x) grains.add(*x, r);
  }
  if (packing.radius.empty())
    throw BadInput("packing: no grain could be placed in the shell; raise 'trials' or lower 'rmax_over_shell'");
  grow(packing);
  return packing;
}

PackingInfo describe(const ShellPacking& packing, const SoftParticleSpec& spec) {
  PackingInfo info;
  info.seed = packing.seed;
  info.grains = static_cast<std::int64_t>(packing.radius.size());
  info.solid_fraction = packing.solid_fraction();
  constexpr double kTouching = 1e-12;
  std::int64_t contacts = 0;
  for (std::size_t i = 0; i < packing.radius.size(); ++i) {
    if (1.0 - norm(packing.position[i]) - packing.radius[i] < kTouching) ++contacts;
    for (std::size_t j = i + 1; j < packing.radius.size(); ++j)
      if (norm(packing.position[i] - packing.position[j]) - packing.radius[i] - packing.radius[j] < kTouching)
        ++contacts;
  }
  info.contacts_per_grain = static_cast<double>(contacts) / static_cast<double>(info.grains);
  if (packing.radius.size() >= 3) {
    const ExponentFit fit = fit_exponent(packing.radius);
    info.exponent = fit.exponent;
    info.exponent_error = fit.standard_error;
  }
  for (const double r : packing.radius) info.radii.push_back(r * spec.shell_radius);
  return info;
}

}  // namespace softgrain
