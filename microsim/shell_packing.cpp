#include "microsim/shell_packing.h"

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/random.h"
#include "microsim/size_distribution.h"

namespace softgrain {

namespace {

/// Which grains may overlap a later (smaller or equal) grain centred in a voxel: lists per voxel, largest first.
class TrialGrid {
 public:
  TrialGrid() : lists_(static_cast<std::size_t>(kCells * kCells * kCells)) {}

  void insert(std::int32_t grain, const Vec3& x, double r) {
    // Later grains are no larger than this one, so their centres matter within 2 r.
    std::array<int, 3> low{};
    std::array<int, 3> high{};
    for (int k = 0; k < 3; ++k) {
      low[static_cast<std::size_t>(k)] = cell(x[k] - 2.0 * r);
      high[static_cast<std::size_t>(k)] = cell(x[k] + 2.0 * r);
    }
    for (int a = low[0]; a <= high[0]; ++a)
      for (int b = low[1]; b <= high[1]; ++b)
        for (int c = low[2]; c <= high[2]; ++c) lists_[index(a, b, c)].push_back(grain);
  }

  [[nodiscard]] const std::vector<std::int32_t>& near(const Vec3& x) const {
    return lists_[index(cell(x[0]), cell(x[1]), cell(x[2]))];
  }

 private:
  static constexpr int kCells = 24;
  static int cell(double x) { return std::clamp(static_cast<int>((x + 1.0) * (0.5 * kCells)), 0, kCells - 1); }
  static std::size_t index(int a, int b, int c) { return static_cast<std::size_t>((a * kCells + b) * kCells + c); }

  std::vector<std::vector<std::int32_t>> lists_;
};

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

Vec3 random_point_in_shell(RandomStream& random) {
  for (;;) {
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = 2.0 * random.uniform() - 1.0;
    if (norm2(x) < 1.0) return x;
  }
}

bool is_free(const ShellPacking& packing, const TrialGrid& grid, const Vec3& x, double r) {
  if (norm2(x) > (1.0 - r) * (1.0 - r)) return false;
  for (const std::int32_t g : grid.near(x)) {
    const auto u = static_cast<std::size_t>(g);
    const double reach = packing.radius[u] + r;
    if (norm2(packing.position[u] - x) < reach * reach) return false;
  }
  return true;
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
  TrialGrid grid;
  RandomStream random(seed, RandomPurpose::positions, index);
  for (const double r : draw_radii(spec, seed, index)) {
    for (std::int64_t trial = 0; trial < spec.trials; ++trial) {
      const Vec3 x = random_point_in_shell(random);
      if (!is_free(packing, grid, x, r)) continue;
      grid.insert(static_cast<std::int32_t>(packing.radius.size()), x, r);
      packing.position.push_back(x);
      packing.radius.push_back(r);
      break;
    }
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
