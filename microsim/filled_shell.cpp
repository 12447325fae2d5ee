#include "microsim/filled_shell.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/core/solid_sphere.h"
#include "common/packing/grading_parts.h"
#include "microsim/shell_compaction.h"
#include "microsim/shell_packing.h"

namespace softgrain {

namespace {

constexpr RandomPurpose kFilledShell{10};
constexpr int kDraws = 16;  ///< number of draws of grains; the one whose volume comes nearest is taken

double volume_of(const std::vector<double>& radii) {
  return std::accumulate(radii.begin(), radii.end(), 0.0, [](double sum, double r) { return sum + cube(r); });
}

/// Draws radii over that of the shell whose volume is about `volume`, also over that of the shell.
std::vector<double> draw_grains(const SoftParticleSpec& spec, double volume, RandomStream& random) {
  const Grading sizes =
      sizes_or_power_law(spec.sizes, spec.exponent, spec.rmax_over_shell * spec.shell_radius, spec.polydispersity);
  const double shell = cube(spec.shell_radius);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(volume * shell / sizes.mean_volume())));
  std::vector<double> best;
  for (int k = 0; k < kDraws; ++k) {
    std::vector<double> radii = sizes.draw(count, random);
    for (double& r : radii) r /= spec.shell_radius;
    if (best.empty() || std::abs(volume_of(radii) - volume) < std::abs(volume_of(best) - volume))
      best = std::move(radii);
  }
  return best;
}

}  // namespace

double next_volume(double exponent, double ratio) { return std::pow(ratio, exponent - 4.0); }

SoftContent fill_shell(const SoftParticleSpec& spec, const ShellFilling& filling, const ShellPacking& published,
                       std::uint64_t seed) {
  RandomStream random(seed, kFilledShell, published.seed);
  const double packed = 1.0 - filling.onset;  // radius of a soft particle as it is packed, over its own
  const double wanted = published.solid_fraction() / (1.0 + filling.soft_over_grains * cube(packed));
  std::vector<double> radii = draw_grains(spec, wanted, random);
  const double soft = volume_of(radii) * filling.soft_over_grains;
  const auto grains = radii.size();
  radii.resize(grains + static_cast<std::size_t>(std::llround(soft / cube(filling.inner_radius))),
               packed * filling.inner_radius);
  std::vector<std::size_t> order(radii.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });
  std::vector<double> largest_first;
  for (const std::size_t k : order) largest_first.push_back(radii[k]);
  ShellPacking all = compact_in_shell(largest_first, random).packing;
  grow_to_contact(all);
  SoftContent content;
  content.grains.seed = published.seed;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (order[k] >= grains) {
      content.inner.push_back({all.position[k], all.radius[k] / packed});
      continue;
    }
    content.grains.position.push_back(all.position[k]);
    content.grains.radius.push_back(all.radius[k]);
  }
  return content;
}

}  // namespace softgrain
