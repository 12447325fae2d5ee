#include "microsim/shell_packing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/io/interrupt.h"
#include "common/packing/grading.h"

namespace softgrain {

namespace {

constexpr int kLevels = 12;  // cubes of 2/2^11 are as small as it makes sense
/// Blind trials between two looks for a signal.
constexpr std::int64_t kTrialsPerLook = 4096;
constexpr double kShellVolume = 4.0 / 3.0 * std::numbers::pi;

Vec3 random_point_in_shell(RandomStream& random) {
  for (;;) {
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = 2.0 * random.uniform() - 1.0;
    if (norm2(x) < 1.0) return x;
  }
}

/// Number of trials up to and with the first success of probability p; at most `most` + 1.
std::int64_t trials_to_hit(double p, std::int64_t most, RandomStream& random) {
  if (p >= 1.0) return 1;
  const double many = std::floor(std::log(random.uniform()) / std::log1p(-p));
  return many >= static_cast<double>(most) ? most + 1 : static_cast<std::int64_t>(many) + 1;
}

}  // namespace

int PlacedGrains::cell(double x) { return std::clamp(static_cast<int>((x + 1.0) * (0.5 * kCells)), 0, kCells - 1); }

void PlacedGrains::add(const Vec3& x, double r) {
  const auto grain = static_cast<std::int32_t>(packing_.radius.size());
  packing_.position.push_back(x);
  packing_.radius.push_back(r);
  // Later grains are no larger than this one, so their centres matter within 2 r.
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  for (int k = 0; k < 3; ++k) {
    low[static_cast<std::size_t>(k)] = cell(x[k] - 2.0 * r);
    high[static_cast<std::size_t>(k)] = cell(x[k] + 2.0 * r);
  }
  for (int a = low[0]; a <= high[0]; ++a)
    for (int b = low[1]; b <= high[1]; ++b)
      for (int c = low[2]; c <= high[2]; ++c) log_lists_[index(a, b, c)].push_back(grain);
}

bool PlacedGrains::has_room(const Vec3& x, double r) const {
  if (norm2(x) > (1.0 - r) * (1.0 - r)) return false;
  for (const std::int32_t g : near(x)) {
    const auto u = static_cast<std::size_t>(g);
    const double reach = packing_.radius[u] + r;
    if (norm2(packing_.position[u] - x) < reach * reach) return false;
  }
  return true;
}

double PlacedGrains::clearance(const Vec3& x) const {
  double room = 1.0 - norm(x);
  for (const std::int32_t g : near(x)) {
    const auto u = static_cast<std::size_t>(g);
    room = std::min(room, norm(packing_.position[u] - x) - packing_.radius[u]);
  }
  return room;
}

std::optional<Vec3> place_by_trials(const PlacedGrains& grains, double r, std::int64_t trials, RandomStream& random) {
  for (std::int64_t trial = 0; trial < trials; ++trial) {
    if (trial % kTrialsPerLook == 0) stop_if_interrupted("packing");
    const Vec3 x = random_point_in_shell(random);
    if (grains.has_room(x, r)) return x;
  }
  return std::nullopt;
}

VoidPlacement::VoidPlacement(double smallest_radius) : smallest_radius_(smallest_radius), open_(kLevels) {
  waiting_.push_back({{{-1.0, -1.0, -1.0}}, std::numeric_limits<double>::infinity(), 0});
}

double VoidPlacement::edge(int level) { return std::ldexp(2.0, -level); }

double VoidPlacement::volume(int level) const {
  return std::ldexp(static_cast<double>(open_[static_cast<std::size_t>(level)].size()), 3 * (1 - level));
}

void VoidPlacement::wait(const Cube& cube) {
  if (cube.key < smallest_radius_) return;
  waiting_.push_back(cube);
  std::push_heap(waiting_.begin(), waiting_.end(), [](const Cube& a, const Cube& b) { return a.key < b.key; });
}

/// Clearance changes by no more than the distance moved: that of the centre bounds the whole cube. The volume of open
/// cubes must lie within the shell, or hits would not count as trials do.
void VoidPlacement::offer(const PlacedGrains& grains, Cube cube, double r) {
  const double half = 0.5 * edge(cube.level);
  const Vec3 centre = cube.low + Vec3{{half, half, half}};
  const double reach = half * std::numbers::sqrt3;
  cube.key = std::min(cube.key, grains.clearance(centre) + reach);
  if (cube.key < r)
    wait(cube);
  else if (norm(centre) + reach > 1.0)
    split(grains, cube, r);
  else
    open_[static_cast<std::size_t>(cube.level)].push_back(cube);
}

void VoidPlacement::split(const PlacedGrains& grains, const Cube& cube, double r) {
  const double half = 0.5 * edge(cube.level);
  for (int part = 0; part < 8; ++part) {
    Cube child{cube.low, cube.key, cube.level + 1};
    for (int k = 0; k < 3; ++k)
      if ((part >> k & 1) != 0) child.low[k] += half;
    // A cube at the last level that still crosses the shell is too near it for any grain.
    if (child.level < kLevels) offer(grains, child, r);
  }
}

void VoidPlacement::wake(const PlacedGrains& grains, double r) {
  while (!waiting_.empty() && waiting_.front().key >= r) {
    std::pop_heap(waiting_.begin(), waiting_.end(), [](const Cube& a, const Cube& b) { return a.key < b.key; });
    const Cube cube = waiting_.back();
    waiting_.pop_back();
    offer(grains, cube, r);
  }
}

/// A cube whose point had no room: put back to wait, or cut.
void VoidPlacement::dismiss(const PlacedGrains& grains, int level, std::size_t at, double r) {
  auto& cubes = open_[static_cast<std::size_t>(level)];
  const Cube cube = cubes[at];
  if (level + 1 == kLevels) {
    const double half = 0.5 * edge(level);
    const double key = grains.clearance(cube.low + Vec3{{half, half, half}}) + half * std::numbers::sqrt3;
    if (key >= r) return;  // stays as it is
  }
  cubes[at] = cubes.back();
  cubes.pop_back();
  if (level + 1 == kLevels)
    offer(grains, cube, r);
  else
    split(grains, cube, r);
}

std::optional<Vec3> VoidPlacement::place(const PlacedGrains& grains, double r, std::int64_t trials,
                                         RandomStream& random) {
  wake(grains, r);
  for (std::int64_t left = trials;;) {
    double total = 0.0;
    for (int level = 0; level < kLevels; ++level) total += volume(level);
    if (total <= 0.0) return std::nullopt;
    left -= trials_to_hit(total / kShellVolume, left, random);
    if (left < 0) return std::nullopt;
    double pick = random.uniform() * total;
    int level = 0;
    for (; level + 1 < kLevels && pick >= volume(level); ++level) pick -= volume(level);
    auto& cubes = open_[static_cast<std::size_t>(level)];
    if (cubes.empty()) continue;  // rounding at the end of the last level
    const std::size_t at = random.below(cubes.size());
    Vec3 x = cubes[at].low;
    for (int k = 0; k < 3; ++k) x[k] += edge(level) * random.uniform();
    if (grains.has_room(x, r)) return x;
    dismiss(grains, level, at, r);
  }
}

namespace {

/// Number of grains that together have the volume of beta shells.
std::size_t drawn_grains(const SoftParticleSpec& spec) {
  const double each = spec.sizes->mean_volume() / std::pow(spec.shell_radius, 3);
  return static_cast<std::size_t>(std::max(1.0, std::round(spec.beta / each)));
}

std::vector<double> draw_radii(const SoftParticleSpec& spec, std::uint64_t seed, std::uint64_t index) {
  const double rmax = spec.rmax_over_shell;
  const PowerLawRadii law{spec.exponent, rmax / spec.polydispersity, rmax};
  RandomStream random(seed, RandomPurpose::radii, index);
  std::vector<double> radii;
  if (spec.sizes) {
    radii = spec.sizes->draw(drawn_grains(spec), random);
    for (double& r : radii) r /= spec.shell_radius;
    std::sort(radii.begin(), radii.end(), std::greater<>());
    return radii;
  }
  double volume = 0.0;  // in units of the shell's
  while (volume <= spec.beta) {
    radii.push_back(law.radius(random.uniform()));
    volume += radii.back() * radii.back() * radii.back();
  }
  std::sort(radii.begin(), radii.end(), std::greater<>());
  return radii;
}

}  // namespace

void grow_to_contact(ShellPacking& packing) {
  for (std::size_t i = 0; i < packing.radius.size(); ++i) {
    double room = 1.0 - norm(packing.position[i]);
    for (std::size_t j = 0; j < packing.radius.size(); ++j)
      if (j != i) room = std::min(room, norm(packing.position[i] - packing.position[j]) - packing.radius[j]);
    packing.radius[i] = std::max(packing.radius[i], room);
  }
}

ShellPacking generate_shell_packing(const SoftParticleSpec& spec, std::uint64_t seed, std::uint64_t index) {
  ShellPacking packing;
  packing.seed = index;
  PlacedGrains grains(packing);
  VoidPlacement voids(spec.sizes ? spec.sizes->smallest() / spec.shell_radius
                                 : spec.rmax_over_shell / spec.polydispersity);
  RandomStream random(seed, RandomPurpose::positions, index);
  for (const double r : draw_radii(spec, seed, index)) {
    stop_if_interrupted("packing");
    const std::optional<Vec3> x = spec.placement == Placement::voids ? voids.place(grains, r, spec.trials, random)
                                                                     : place_by_trials(grains, r, spec.trials, random);
    if (x) grains.add(*x, r);
  }
  if (packing.radius.empty())
    throw InputError("packing: no grain could be placed in the shell; raise 'trials' or lower 'rmax_over_shell'");
  grow_to_contact(packing);
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
