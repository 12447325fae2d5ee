#include "macrosim/macro_packing.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/data/attributes.h"
#include "common/data/fields.h"
#include "common/neighbours/spatial_order.h"
#include "macrosim/box.h"
#include "macrosim/grain_materials.h"
#include "macrosim/preparation.h"

namespace softgrain {

namespace {

Grading sizes_of(const std::optional<Grading>& sizes, double exponent, double rmax, double polydispersity) {
  return sizes ? *sizes : Grading::power_law(exponent, rmax / polydispersity, rmax);
}

/// Numbers of both kinds come from their mean volumes.
std::vector<MacroBody> draw_gradings(const MacroSpec& spec, double soft_share, RandomStream& random) {
  const Grading solid = sizes_of(spec.solid_sizes, spec.exponent, spec.solid_radius_max, spec.solid_polydispersity);
  const Grading soft = sizes_of(spec.soft_sizes, spec.exponent, spec.soft_radius_max, spec.soft_polydispersity);
  const double per_soft = soft_share / soft.mean_volume();
  const double per_solid = (1.0 - soft_share) / solid.mean_volume();
  std::int64_t softs = std::llround(static_cast<double>(spec.bodies) * per_soft / (per_soft + per_solid));
  if (soft_share > 0.0) softs = std::max<std::int64_t>(softs, 1);
  if (soft_share < 1.0 && spec.bodies > 1) softs = std::min(softs, spec.bodies - 1);
  std::vector<MacroBody> bodies;
  for (const DrawnGrain& g : solid.draw_grains(static_cast<std::size_t>(spec.bodies - softs), random))
    bodies.push_back({{}, g.radius, false, g.material});
  for (const double r : soft.draw(static_cast<std::size_t>(softs), random)) bodies.push_back({{}, r, true});
  return bodies;
}

std::vector<MacroBody> draw_power_laws(const MacroSpec& spec, double soft_share, RandomStream& random) {
  std::vector<MacroBody> bodies;
  double soft = 0.0;
  double all = 0.0;
  for (std::int64_t k = 0; k < spec.bodies; ++k) {
    MacroBody body;
    body.soft = soft_share > 0.0 && soft <= soft_share * all;
    body.r = body.soft
                 ? power_law_radius(spec.exponent, spec.soft_radius_max, spec.soft_polydispersity, random.uniform())
                 : power_law_radius(spec.exponent, spec.solid_radius_max, spec.solid_polydispersity, random.uniform());
    all += cube(body.r);
    if (body.soft) soft += cube(body.r);
    bodies.push_back(body);
  }
  return bodies;
}

}  // namespace

namespace {

/// Least number of bodies that are ordered in space.
constexpr std::size_t kOrderedBodies = 2000;

/// Bodies that will meet lie near each other in memory: compaction moves them less than their order does.
void order_in_space(const MacroSpec& spec, MacroPacking& packing) {
  if (packing.bodies.size() < kOrderedBodies) return;
  std::vector<MacroBody> ordered;
  for (const Slot k : spatial_order(HardBodies(spec, packing).system)) ordered.push_back(packing.bodies[at(k)]);
  packing.bodies = std::move(ordered);
}

}  // namespace

std::vector<MacroBody> drawn_bodies(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  RandomStream random(seed, kMacroRadii, sample);
  const double soft_share = spec.construction == Construction::voids ? 0.0 : spec.soft_share;
  std::vector<MacroBody> bodies = spec.solid_sizes || spec.soft_sizes ? draw_gradings(spec, soft_share, random)
                                                                      : draw_power_laws(spec, soft_share, random);
  std::stable_sort(bodies.begin(), bodies.end(), [](const MacroBody& a, const MacroBody& b) { return a.r > b.r; });
  return bodies;
}

double MacroPacking::body_volume() const {
  double sum = 0.0;
  for (const MacroBody& b : bodies) sum += kSphereVolume * cube(b.r);
  return sum;
}

double MacroPacking::solid_fraction() const {
  const Vec3 edge = size();
  return body_volume() / (edge[0] * edge[1] * edge[2]);
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

std::vector<BodySpring> springs_of_test(const MacroSpec& spec, const MacroPacking& packing) {
  const auto bodies = static_cast<std::int32_t>(packing.bodies.size());
  const auto solid = [&](std::int32_t b) { return !packing.bodies[static_cast<std::size_t>(b)].soft; };
  std::vector<BodySpring> out;
  for (const BodySpring& s : packing.springs) {
    const bool wall = s.j >= bodies;
    if (!solid(s.i) || !(wall || solid(s.j))) continue;
    const auto material = [&](std::int32_t b) { return packing.bodies[static_cast<std::size_t>(b)].material; };
    const double friction = wall ? spec.wall_friction : friction_between(spec, material(s.i), material(s.j));
    if (friction > 0.0) out.push_back(s);
  }
  return out;
}

bool any_rolls(const std::vector<BodySpring>& springs) {
  return std::ranges::any_of(springs, [](const BodySpring& s) { return s.roll != Vec3{}; });
}

MacroPacking make_macro_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample,
                                const PreparationWatch& watch) {
  return pack_bodies(spec, drawn_bodies(spec, seed, sample), seed, sample, watch);
}

MacroPacking pack_bodies(const MacroSpec& spec, std::vector<MacroBody> bodies, std::uint64_t seed, std::uint64_t sample,
                         const PreparationWatch& watch) {
  const double fraction = spec.protocol.start_fraction;
  if (spec.protocol.coarse_share < 1.0) return pack_densely(spec, std::move(bodies), seed, sample, watch);
  MacroPacking packing = place_loosely(std::move(bodies), seed, sample, fraction, spec.boundary);
  order_in_space(spec, packing);
  if (spec.preparation != Preparation::lammps) bring_into_touch(spec, packing, watch);
  return packing;
}

namespace {

constexpr auto kWalls = static_cast<std::int64_t>(std::tuple_size_v<decltype(Box::plane)>);

void write_springs(const h5::Group& group, const std::vector<BodySpring>& springs) {
  if (springs.empty()) return;
  std::vector<std::int64_t> pairs;
  std::vector<double> values;
  std::vector<double> rolls;
  for (const BodySpring& s : springs) {
    pairs.insert(pairs.end(), {s.i, s.j});
    values.insert(values.end(), {s.spring[0], s.spring[1], s.spring[2]});
    rolls.insert(rolls.end(), {s.roll[0], s.roll[1], s.roll[2]});
  }
  group.write("spring_bodies", pairs);
  group.write("springs", values, {springs.size(), 3});
  if (any_rolls(springs)) group.write("rolls", rolls, {springs.size(), 3});
}

void read_springs(const h5::Group& group, MacroPacking& packing) {
  if (!group.has("springs")) return;
  const auto pairs = group.integers("spring_bodies");
  const auto values = group.doubles("springs");
  const std::vector<double> rolls =
      group.has("rolls") ? group.doubles("rolls") : std::vector<double>(values.size(), 0.0);
  const auto bodies = static_cast<std::int64_t>(packing.bodies.size());
  if (2 * values.size() != 3 * pairs.size() || rolls.size() != values.size())
    throw IoError("macro packing: springs of wrong length");
  for (std::size_t k = 0; 2 * k < pairs.size(); ++k) {
    if (pairs[2 * k] < 0 || pairs[2 * k] >= bodies || pairs[2 * k + 1] < 0 || pairs[2 * k + 1] >= bodies + kWalls)
      throw IoError("macro packing: a spring of bodies that are not there");
    packing.springs.push_back({static_cast<std::int32_t>(pairs[2 * k]),
                               static_cast<std::int32_t>(pairs[2 * k + 1]),
                               {{values[3 * k], values[3 * k + 1], values[3 * k + 2]}},
                               {{rolls[3 * k], rolls[3 * k + 1], rolls[3 * k + 2]}}});
  }
}

}  // namespace

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
  if (std::ranges::any_of(packing.bodies, [](const MacroBody& b) { return b.material != 0; })) {
    std::vector<std::int64_t> material;
    for (const MacroBody& b : packing.bodies) material.push_back(b.material);
    group.write("material", material);
  }
  write_springs(group, packing.springs);
  write_attributes(group, packing.cost);
  write_density_search(group, packing.density);
}

MacroPacking read_macro_packing(const h5::Group& group) {
  const auto corners = group.doubles("box");
  const auto rows = group.doubles("bodies");
  const auto soft = group.integers("soft");
  if (corners.size() != 6 || rows.size() != 4 * soft.size()) throw IoError("macro packing: arrays of wrong length");
  MacroPacking packing{{{corners[0], corners[1], corners[2]}}, {{corners[3], corners[4], corners[5]}}, {}};
  for (std::size_t k = 0; k < soft.size(); ++k)
    packing.bodies.push_back({{{rows[4 * k], rows[4 * k + 1], rows[4 * k + 2]}}, rows[4 * k + 3], soft[k] != 0});
  if (group.has("material")) {
    const auto material = group.integers("material");
    if (material.size() != packing.bodies.size()) throw IoError("macro packing: arrays of wrong length");
    for (std::size_t k = 0; k < material.size(); ++k) {
      if (material[k] < 0 || material[k] >= static_cast<std::int64_t>(GrainMaterials::kMost))
        throw IoError("macro packing: no such material");
      packing.bodies[k].material = static_cast<std::int32_t>(material[k]);
    }
  }
  read_springs(group, packing);
  if (group.has_attribute("loop_passes")) read_attributes(group, packing.cost);
  packing.density = read_density_search(group);
  return packing;
}

}  // namespace softgrain
