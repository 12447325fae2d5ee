#include "microsim/grain_box/grain_box_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "common/core/error.h"
#include "common/core/material.h"
#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/force_pass.h"
#include "common/io/interrupt.h"
#include "common/statics/least_work.h"
#include "microsim/grain_box/box_measure.h"

namespace softgrain {

namespace {

constexpr RandomPurpose kGrainRadii{20};
constexpr RandomPurpose kGrainElasticity{21};
constexpr RandomPurpose kGrainPositions{22};

constexpr std::int64_t kTrials = 20000;  // per grain
constexpr double kLowestDrawn = -0.99;   // of nu: scatter must not make a grain infinitely stiff in shear
constexpr double kFirstStep = 1e-2;      // strain of the loose box per step
constexpr double kDenserThanAny = 0.80;  // solid fraction at which a pack of these grains must long have jammed
// A box that has not reached equilibrium after so many passes is close to jamming; what is left is small, and the
// least-work solver finds the equilibrium of the box that is handed on.
constexpr std::int64_t kLoosePasses = 6000;
// Share of the first wanted pressure up to which the box is pressed here, in steps of kPressedStep. Barely jammed packs
// are nearly floppy: where they rearrange, a solver without inertia follows a long valley of energy and may not find
// its end. For the same reason pressed states are relaxed further than loose ones.
constexpr double kHandOver = 0.9;
constexpr double kPressedStep = 3e-4;
constexpr double kPressedTolerance = 1e-4;  // largest net force over mean contact force
constexpr std::int64_t kPressedPasses = 60000;

/// Normal numbers by Box and Muller, cut at three deviations.
double cut_normal(RandomStream& random) {
  for (;;) {
    const double r = std::sqrt(-2.0 * std::log(random.uniform()));
    const double z = r * std::cos(2.0 * std::numbers::pi * random.uniform());
    if (std::abs(z) <= 3.0) return z;
  }
}

}  // namespace

std::vector<double> drawn_radii(const GrainBoxSpec& spec, std::uint64_t seed) {
  const GrainBoxMaterial& m = spec.material;
  RandomStream random(seed, kGrainRadii, spec.arrangement);
  std::vector<double> radii;
  if (m.sizes) radii = m.sizes->draw(static_cast<std::size_t>(spec.grains), random);
  while (radii.size() < static_cast<std::size_t>(spec.grains))
    radii.push_back(m.radius_min + (m.radius_max - m.radius_min) * random.uniform());
  std::sort(radii.begin(), radii.end(), std::greater<>());
  return radii;
}

namespace {

void draw_grains(GrainPack& pack, const GrainBoxSpec& spec, std::uint64_t seed) {
  const GrainBoxMaterial& m = spec.material;
  RandomStream elasticity(seed, kGrainElasticity, spec.arrangement);
  pack.radius = drawn_radii(spec, seed);  // the largest first: late grains then find places
  for (std::int64_t n = 0; n < spec.grains; ++n) {
    const double e = m.youngs_modulus * (1.0 + m.youngs_modulus_scatter * cut_normal(elasticity));
    pack.youngs_modulus.push_back(std::max(e, 0.05 * m.youngs_modulus));
    const double nu = m.poisson_ratio * (1.0 + m.poisson_ratio_scatter * cut_normal(elasticity));
    pack.poisson_ratio.push_back(std::clamp(nu, std::min(kLowestDrawn, m.poisson_ratio), kPoissonHighest));
  }
}

Vec3 loose_lengths(const GrainPack& pack, const GrainBoxSpec& spec) {
  double volume = 0.0;
  for (const double r : pack.radius) volume += kSphereVolume * r * r * r;
  const double aspect = spec.aspect[0] * spec.aspect[1] * spec.aspect[2];
  return spec.aspect * std::cbrt(volume / (spec.solid_fraction * aspect));
}

/// Cells of one largest diameter: only the 27 around a place can hold an overlapping grain.
class PlacedGrains {
 public:
  PlacedGrains(const GrainPack& pack, const Vec3& lengths) : pack_(pack) {
    for (int k = 0; k < 3; ++k) {
      count_[k] = std::max<std::int64_t>(1, static_cast<std::int64_t>(lengths[k] / (2.0 * pack.radius.front())));
      width_[k] = lengths[k] / static_cast<double>(count_[k]);
    }
    cells_.resize(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]));
  }

  [[nodiscard]] bool free(const Vec3& x, double r) const {
    std::array<std::int64_t, 3> low{};
    std::array<std::int64_t, 3> high{};
    for (int k = 0; k < 3; ++k) {
      const std::int64_t c = cell(x, k);
      low[static_cast<std::size_t>(k)] = std::max<std::int64_t>(0, c - 1);
      high[static_cast<std::size_t>(k)] = std::min(count_[static_cast<std::size_t>(k)] - 1, c + 1);
    }
    for (std::int64_t a = low[0]; a <= high[0]; ++a)
      for (std::int64_t b = low[1]; b <= high[1]; ++b)
        for (std::int64_t c = low[2]; c <= high[2]; ++c)
          for (const std::size_t other : cells_[index(a, b, c)]) {
            const double reach = r + pack_.radius[other];
            if (norm2(x - pack_.position[other]) < reach * reach) return false;
          }
    return true;
  }
  void add(std::size_t grain, const Vec3& x) { cells_[index(cell(x, 0), cell(x, 1), cell(x, 2))].push_back(grain); }

 private:
  [[nodiscard]] std::int64_t cell(const Vec3& x, int k) const {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(x[k] / width_[k]), 0,
                                    count_[static_cast<std::size_t>(k)] - 1);
  }
  [[nodiscard]] std::size_t index(std::int64_t a, std::int64_t b, std::int64_t c) const {
    return static_cast<std::size_t>((a * count_[1] + b) * count_[2] + c);
  }

  const GrainPack& pack_;
  std::array<std::int64_t, 3> count_{};
  Vec3 width_{};
  std::vector<std::vector<std::size_t>> cells_;
};

void place_grains(GrainPack& pack, const Vec3& lengths, std::uint64_t seed, std::uint64_t arrangement) {
  RandomStream random(seed, kGrainPositions, arrangement);
  PlacedGrains placed(pack, lengths);
  for (std::size_t n = 0; n < pack.radius.size(); ++n) {
    const double r = pack.radius[n];
    Vec3 x{};
    bool found = false;
    for (std::int64_t trial = 0; trial < kTrials && !found; ++trial) {
      for (int k = 0; k < 3; ++k) x[k] = r + (lengths[k] - 2.0 * r) * random.uniform();
      found = placed.free(x, r);
    }
    if (!found)
      throw InputError(fmt::format(
          "box: grain {} of {} finds no free place in {} trials; a smaller solid_fraction (below about 0.35) is needed",
          n + 1, pack.radius.size(), kTrials));
    pack.position.push_back(x);
    placed.add(n, x);
  }
}

void add_walls(GrainPack& pack, const Vec3& lengths, const GrainBoxWalls& walls) {
  for (int k = 0; k < 3; ++k)
    for (const bool high : {false, true}) {
      PackWall wall;
      wall.point = lengths * 0.5;
      wall.point[k] = high ? lengths[k] : 0.0;
      wall.normal[k] = high ? -1.0 : 1.0;
      wall.youngs_modulus = walls.youngs_modulus;
      wall.poisson_ratio = walls.poisson_ratio;
      pack.walls.push_back(wall);
    }
}

/// The grains and the six walls of the pack as a system for the dynamic relaxation, with one mean elasticity.
System3 loose_system(const GrainBoxSpec& spec, const GrainPack& pack) {
  System3 s;
  s.materials = {{"grain", spec.material.density, spec.material.youngs_modulus, spec.material.poisson_ratio, false},
                 {"wall", spec.material.density, spec.walls.youngs_modulus, spec.walls.poisson_ratio, false}};
  s.laws = LawSet(2);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 0.0, 1.0), false));
  s.laws.set(0, 1, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[1], 0.0, 1.0), false));
  for (std::size_t n = 0; n < pack.radius.size(); ++n)
    add_grain(s.particles, solid_sphere(pack.position[n], pack.radius[n], spec.material.density, 0));
  for (const PackWall& wall : pack.walls) {
    NewBody<3> plane;
    plane.x = wall.point;
    plane.material = 1;
    add_plane(s.particles, plane, wall.normal);
  }
  return s;
}

Vec3 plane_lengths(const System3& s) {
  Vec3 lengths;
  for (int k = 0; k < 3; ++k) {
    const auto low = static_cast<std::size_t>(s.particles.first_plane() + 2 * k);
    lengths[k] = s.particles.sphere[low + 1].x[k] - s.particles.sphere[low].x[k];
  }
  return lengths;
}

/// Shrinks the box by `strain` of its present lengths about its centre, all grains along.
void shrink(System3& s, double strain) {
  const auto first = static_cast<std::size_t>(s.particles.first_plane());
  Vec3 centre;
  for (int k = 0; k < 3; ++k) {
    const std::size_t low = first + 2 * static_cast<std::size_t>(k);
    centre[k] = 0.5 * (s.particles.sphere[low].x[k] + s.particles.sphere[low + 1].x[k]);
  }
  std::vector<Vec3> moves;
  for (const auto& body : s.particles.sphere) moves.push_back((body.x - centre) * -strain);
  displace(s, moves);
}

double mean_wall_stress(const System3& s) {
  const Vec3 lengths = plane_lengths(s);
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const auto low = static_cast<std::size_t>(s.particles.first_plane() + 2 * k);
    const double force = s.particles.force[low + 1][k] - s.particles.force[low][k];
    sum += 0.5 * force * lengths[k];
  }
  return sum / (3.0 * lengths[0] * lengths[1] * lengths[2]);
}

void take_over(GrainPack& pack, const System3& s) {
  for (std::size_t n = 0; n < pack.position.size(); ++n) pack.position[n] = s.particles.sphere[n].x;
  for (std::size_t w = 0; w < pack.walls.size(); ++w)
    pack.walls[w].point = s.particles.sphere[static_cast<std::size_t>(s.particles.first_plane()) + w].x;
}

}  // namespace

GrainPack make_loose_pack(const GrainBoxSpec& spec, std::uint64_t seed) {
  GrainPack pack;
  draw_grains(pack, spec, seed);
  const Vec3 lengths = loose_lengths(pack, spec);
  for (int k = 0; k < 3; ++k)
    if (lengths[k] <= 2.0 * pack.radius.front())
      throw InputError(fmt::format("box: side {} of {:.3g} m is too short for a grain of radius {:.3g} m", "xyz"[k],
                                   lengths[k], pack.radius.front()));
  place_grains(pack, lengths, seed, spec.arrangement);
  add_walls(pack, lengths, spec.walls);
  return pack;
}

CompactedPack compact_until_stress(const GrainBoxSpec& spec, GrainPack loose) {
  System3 s = loose_system(spec, loose);
  const double first_stress = kFirstStress * spec.material.youngs_modulus;
  const double r = spec.material.radius_max;
  DampedOptions options;
  options.force_floor = 1e-8 * spec.material.youngs_modulus * r * r;
  options.max_passes = kLoosePasses;
  DampedRelaxation<3> relaxation(options);
  CompactedPack out;
  double step = kFirstStep;
  const double solid = solid_volume(loose);
  for (;;) {
    if (interrupt_requested()) throw Interrupted("interrupted while compacting; go on with --resume");
    const System3 before = s;
    shrink(s, step);
    relaxation.relax(s);
    ++out.steps;
    const Vec3 lengths = plane_lengths(s);
    const double fraction = solid / (lengths[0] * lengths[1] * lengths[2]);
    if (!(fraction < kDenserThanAny))
      throw UnusableResult(
          fmt::format("{}: the pack does not jam: no stress at a solid fraction of {:.2f}", spec.name, fraction));
    if (mean_wall_stress(s) <= first_stress) continue;
    out.stress_free_lengths = plane_lengths(before);
    if (step <= kLastStep) break;
    s = before;
    step *= 0.5;
  }
  const double enough = std::max(first_stress, kHandOver * spec.generation.pressures().front());
  options.tolerance = kPressedTolerance;
  options.max_passes = kPressedPasses;
  DampedRelaxation<3> pressed(options);
  while (mean_wall_stress(s) < enough) {
    if (interrupt_requested()) throw Interrupted("interrupted while compacting; go on with --resume");
    shrink(s, kPressedStep);
    pressed.relax(s);
    ++out.steps;
  }
  out.loop_passes = s.cost.loop_passes;
  take_over(loose, s);
  out.pack = std::move(loose);
  refresh_contacts(out.pack);
  return out;
}

}  // namespace softgrain
