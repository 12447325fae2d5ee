#include "macrosim/macro_packing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/core/solid_sphere.h"
#include "common/dynamics/damped_relaxation.h"
#include "macrosim/box.h"

namespace softgrain {

namespace {

double cube(double x) { return x * x * x; }

/// Inverse cumulative distribution of P(r) ~ r^-b on [rmax/polydispersity, rmax].
double power_law_radius(double exponent, double rmax, double polydispersity, double u) {
  const double power = 1.0 - exponent;
  const double low = std::pow(rmax / polydispersity, power);
  const double high = std::pow(rmax, power);
  return std::pow(low + u * (high - low), 1.0 / power);
}

/// Draws bodies one by one, always of the kind that is behind its share of the volume.
std::vector<MacroBody> draw_bodies(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  RandomStream random(seed, RandomPurpose::macro_radii, sample);
  std::vector<MacroBody> bodies;
  double soft = 0.0;
  double all = 0.0;
  for (std::int64_t k = 0; k < spec.bodies; ++k) {
    MacroBody body;
    body.soft = spec.soft_share > 0.0 && soft <= spec.soft_share * all;
    body.r = body.soft
                 ? power_law_radius(spec.exponent, spec.soft_radius_max, spec.soft_polydispersity, random.uniform())
                 : power_law_radius(spec.exponent, spec.solid_radius_max, spec.solid_polydispersity, random.uniform());
    all += cube(body.r);
    if (body.soft) soft += cube(body.r);
    bodies.push_back(body);
  }
  std::stable_sort(bodies.begin(), bodies.end(), [](const MacroBody& a, const MacroBody& b) { return a.r > b.r; });
  return bodies;
}

bool collides(const std::vector<MacroBody>& bodies, std::size_t placed, const Vec3& x, double r) {
  for (std::size_t j = 0; j < placed; ++j) {
    const double reach = bodies[j].r + r;
    if (norm2(bodies[j].x - x) < reach * reach) return true;
  }
  return false;
}

/// Largest first at random places of a cube; false when one finds none.
bool place(std::vector<MacroBody>& bodies, double edge, RandomStream& random) {
  constexpr int kTrials = 100000;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const double r = bodies[k].r;
    int trial = 0;
    do {
      for (int a = 0; a < 3; ++a) bodies[k].x[a] = r + random.uniform() * (edge - 2.0 * r);
    } while (collides(bodies, k, bodies[k].x, r) && ++trial < kTrials);
    if (trial == kTrials) return false;
  }
  return true;
}

/// In a cube that they fill to 30 %; when so few bodies that walls are near find no place, in a larger one.
MacroPacking place_loosely(std::vector<MacroBody> bodies, std::uint64_t seed, std::uint64_t sample) {
  double volume = 0.0;
  for (const MacroBody& b : bodies) volume += kSphereVolume * cube(b.r);
  RandomStream random(seed, RandomPurpose::macro_positions, sample);
  for (double fraction = 0.30; fraction > 0.05; fraction *= 0.8) {
    const double edge = std::cbrt(volume / fraction);
    if (place(bodies, edge, random)) return {{}, {{edge, edge, edge}}, std::move(bodies)};
  }
  throw NotUsable("macro: could not place all bodies without overlap");
}

System3 hard_system(const MacroSpec& spec, const MacroPacking& packing, Box& box) {
  System3 s;
  s.materials = {{"hard", spec.density, spec.youngs_modulus, spec.poisson_ratio, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 0.0, 1.0), false));
  for (const MacroBody& b : packing.bodies) {
    NewBody<3> grain;
    grain.x = b.x;
    grain.r = b.r;
    grain.mass = spec.density * kSphereVolume * cube(b.r);
    add_grain(s.particles, grain);
  }
  box = add_box(s, packing.low, packing.high, 0);
  return s;
}

/// Shrinks the box in ever smaller steps: a step that overshoots the pressure is taken back and halved.
void compact(System3& s, const Box& box, double pressure, double youngs_modulus) {
  DampedOptions options;
  options.tolerance = 1e-3;
  options.max_passes = 50000;
  const Vec3 size = box_high(s, box) - box_low(s, box);
  options.force_floor = 1e-2 * pressure * size[0] * size[1] / static_cast<double>(s.particles.grains);
  double step = 0.02;
  for (int round = 0; round < 400; ++round) {
    const System3 before = s;
    strain_box(s, box, {{step, step, step}});
    DampedRelaxation<3>(options).relax(s);
    const Vec3 stress = wall_stress(s, box);
    const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
    if (mean < pressure) continue;
    if (mean < 1.5 * pressure) return;
    s = before;
    step *= 0.5;
    if (step < 1e-7) break;
  }
  throw NotUsable("macro: the preparation did not reach a pressure of " + std::to_string(pressure / youngs_modulus) +
                  " E");
}

}  // namespace

double MacroPacking::solid_fraction() const {
  const Vec3 edge = size();
  double sum = 0.0;
  for (const MacroBody& b : bodies) sum += kSphereVolume * cube(b.r);
  return sum / (edge[0] * edge[1] * edge[2]);
}

double MacroPacking::soft_volume_share() const {
  double soft = 0.0;
  double all = 0.0;
  for (const MacroBody& b : bodies) {
    all += cube(b.r);
    if (b.soft) soft += cube(b.r);
  }
  return all > 0.0 ? soft / all : 0.0;
}

std::int64_t MacroPacking::soft_count() const {
  return std::count_if(bodies.begin(), bodies.end(), [](const MacroBody& b) { return b.soft; });
}

MacroPacking make_macro_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  MacroPacking packing = place_loosely(draw_bodies(spec, seed, sample), seed, sample);
  Box box;
  System3 s = hard_system(spec, packing, box);
  compact(s, box, spec.start_pressure * spec.youngs_modulus, spec.youngs_modulus);
  packing.low = box_low(s, box);
  packing.high = box_high(s, box);
  for (std::size_t k = 0; k < packing.bodies.size(); ++k) packing.bodies[k].x = s.particles.sphere[k].x;
  return packing;
}

void write_macro_packing(const h5::Group& group, const MacroPacking& packing) {
  std::vector<double> rows;
  std::vector<std::int64_t> soft;
  for (const MacroBody& b : packing.bodies) {
    rows.insert(rows.end(), {b.x[0], b.x[1], b.x[2], b.r});
    soft.push_back(b.soft ? 1 : 0);
  }
  const std::vector<double> corners{packing.low[0],  packing.low[1],  packing.low[2],
                                    packing.high[0], packing.high[1], packing.high[2]};
  group.write("box", corners);
  group.write("bodies", rows, {packing.bodies.size(), 4});
  group.write("soft", soft);
}

MacroPacking read_macro_packing(const h5::Group& group) {
  const auto corners = group.doubles("box");
  const auto rows = group.doubles("bodies");
  const auto soft = group.integers("soft");
  if (corners.size() != 6 || rows.size() != 4 * soft.size()) throw FileTrouble("macro packing: arrays of wrong length");
  MacroPacking packing{{{corners[0], corners[1], corners[2]}}, {{corners[3], corners[4], corners[5]}}, {}};
  for (std::size_t k = 0; k < soft.size(); ++k)
    packing.bodies.push_back({{{rows[4 * k], rows[4 * k + 1], rows[4 * k + 2]}}, rows[4 * k + 3], soft[k] != 0});
  return packing;
}

}  // namespace softgrain
