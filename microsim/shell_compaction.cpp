#include "microsim/shell_compaction.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/error.h"
#include "common/core/solid_sphere.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/io/interrupt.h"
#include "common/neighbours/verlet_list.h"
#include "microsim/shell_packing.h"

namespace softgrain {

namespace {

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

}  // namespace

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

}  // namespace softgrain
