#include "microsim/filled_shell.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/io/interrupt.h"
#include "common/neighbours/verlet_list.h"
#include "common/packing/grading.h"
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

constexpr double kFirstFill = 0.25;       ///< share of the shell that the spheres fill when they are placed
constexpr double kGrowth = 0.01;          ///< relative growth of the radii in a step
constexpr double kLeastGrowth = 0.001;    ///< smaller steps gain nothing
constexpr double kOverlap = 1e-3;         ///< overlap over the smaller radius that still counts as none
constexpr std::int64_t kPasses = 200;     ///< passes between two looks at the overlaps
constexpr int kLooks = 100;               ///< number of looks after which the spheres count as jammed
constexpr std::int64_t kTrials = 100000;  ///< trials per sphere

/// Spheres of modulus 1 in a shell of radius 1 that stands still.
class GrowingSpheres {
 public:
  GrowingSpheres(const ShellPacking& placed, const std::vector<double>& radius) : radius_(radius) {
    const Material material{"sphere", 1.0, 1.0, 0.3, false};
    system_.materials = {material};
    system_.laws = LawSet(1);
    system_.laws.set(0, 0, hertz_law(HertzCoefficients::of(material, material, 0.0, 1.0), false));
    const auto shell = static_cast<Slot>(placed.radius.size());
    for (std::size_t k = 0; k < placed.radius.size(); ++k) {
      NewBody<3> sphere = solid_sphere(placed.position[k], placed.radius[k], material.density, 0);
      sphere.inertia = 0.0;
      sphere.shell = shell;
      add_grain(system_.particles, sphere);
    }
    NewBody<3> wall;
    wall.r = 1.0;
    add_shell(system_.particles, wall);
  }

  /// Grows to this share of the radii; false, and back where they were, when overlaps stay.
  bool grow_to(double share) {
    const auto before = system_.particles.sphere;
    for (std::size_t k = 0; k < radius_.size(); ++k) system_.particles.sphere[k].r = share * radius_[k];
    rebuild_neighbours(system_);
    DampedOptions options;
    options.max_passes = kPasses;
    options.least_stiffness = 0.05;
    for (int look = 0; look < kLooks; ++look) {
      stop_if_interrupted("packing");
      DampedRelaxation<3>(options).relax(system_);
      if (largest_overlap() < kOverlap) return true;
    }
    system_.particles.sphere = before;
    return false;
  }

  /// Places, and radii small enough that none overlaps.
  [[nodiscard]] ShellPacking packing() const {
    const double room = 1.0 - largest_overlap();
    ShellPacking out;
    for (std::size_t k = 0; k < radius_.size(); ++k) {
      out.position.push_back(system_.particles.sphere[k].x);
      out.radius.push_back(room * system_.particles.sphere[k].r);
    }
    return out;
  }

 private:
  /// Largest overlap, over the smaller radius.
  [[nodiscard]] double largest_overlap() const {
    double most = 0.0;
    const auto& sphere = system_.particles.sphere;
    for (std::size_t i = 0; i < radius_.size(); ++i) {
      most = std::max(most, (norm(sphere[i].x) + sphere[i].r - 1.0) / sphere[i].r);
      for (std::size_t j = 0; j < i; ++j) {
        const double reach = sphere[i].r + sphere[j].r;
        const double apart2 = norm2(sphere[i].x - sphere[j].x);
        if (apart2 < reach * reach)
          most = std::max(most, (reach - std::sqrt(apart2)) / std::min(sphere[i].r, sphere[j].r));
      }
    }
    return most;
  }

  const std::vector<double>& radius_;
  System3 system_;
};

/// Nothing when a sphere finds no place.
std::optional<ShellPacking> placed(const std::vector<double>& radius, double share, RandomStream& random) {
  ShellPacking packing;
  PlacedGrains grains(packing);
  for (const double r : radius) {
    const std::optional<Vec3> x = place_by_trials(grains, share * r, kTrials, random);
    if (!x) return std::nullopt;
    grains.add(*x, share * r);
  }
  return packing;
}

constexpr std::uint64_t kOrientations = 1000000;  ///< largest number of orientations of one packing

/// A unit quaternion, evenly on the sphere of four dimensions: four normal numbers over their length.
struct Turn {
  Vec3 axis{};
  double angle = 0.0;
};

Turn draw(RandomStream random) {
  const double w = random.normal();
  Vec3 v;
  for (int k = 0; k < 3; ++k) v[k] = random.normal();
  const double length = norm(v);
  if (!(length > 0.0)) return {{{1.0, 0.0, 0.0}}, 0.0};
  return {v * (1.0 / length), 2.0 * std::atan2(length, w)};
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

CompactedShell compact_in_shell(const std::vector<double>& radius, RandomStream& random) {
  double volume = 0.0;
  for (const double r : radius) volume += cube(r);
  if (radius.empty() || !(radius.front() < 1.0)) throw InputError("packing: no spheres that a shell could hold");
  double share = std::min(1.0, std::cbrt(kFirstFill / volume));
  std::optional<ShellPacking> start;
  for (; !(start = placed(radius, share, random)); share *= 0.9) {
  }
  GrowingSpheres spheres(*start, radius);
  for (double growth = kGrowth; share < 1.0 && growth > kLeastGrowth;) {
    const double next = std::min(1.0, share * (1.0 + growth));
    if (spheres.grow_to(next))
      share = next;
    else
      growth *= 0.5;
  }
  return {spheres.packing(), share};
}

SoftContent turned(const SoftContent& content, std::uint64_t seed, std::int64_t packing, std::int64_t orientation) {
  SoftContent out = content;
  if (orientation == 0) return out;
  const auto index = static_cast<std::uint64_t>(packing) * kOrientations + static_cast<std::uint64_t>(orientation);
  const Turn turn = draw(RandomStream(seed, RandomPurpose::rotation, index));
  const auto apply = [&](Vec3& x) { x = rotate(x, turn.axis, turn.angle); };
  for (Vec3& x : out.grains.position) apply(x);
  for (InnerSoft& inner : out.inner) apply(inner.x);
  for (ShellPacking& packing_inside : out.inner_packings)
    for (Vec3& x : packing_inside.position) apply(x);
  return out;
}

}  // namespace softgrain
