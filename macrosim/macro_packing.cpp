#include "macrosim/macro_packing.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/data/attributes.h"
#include "common/data/fields.h"
#include "common/data/rows.h"
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

// What stands in a row of each data set.

constexpr auto kBox = [](auto&& visit, auto& packing) {
  visit(packing.low);
  visit(packing.high);
};
constexpr auto kBody = [](auto&& visit, auto& b) {
  visit(b.x);
  visit(b.r);
};
constexpr auto kSoft = [](auto&& visit, auto& b) { visit(b.soft); };
constexpr auto kMaterial = [](auto&& visit, auto& b) { visit(b.material); };
constexpr auto kSpringBodies = [](auto&& visit, auto& s) {
  visit(s.i);
  visit(s.j);
};
constexpr auto kSpring = [](auto&& visit, auto& s) { visit(s.spring); };
constexpr auto kRoll = [](auto&& visit, auto& s) { visit(s.roll); };

void write_springs(const h5::Group& group, const std::vector<BodySpring>& springs) {
  if (springs.empty()) return;
  group.write("spring_bodies", flat_rows<std::int64_t>(springs, kSpringBodies));
  write_rows(group, "springs", springs, kSpring);
  if (any_rolls(springs)) write_rows(group, "rolls", springs, kRoll);
}

void read_springs(const h5::Group& group, MacroPacking& packing) {
  if (!group.has("springs")) return;
  packing.springs = records_in_rows<BodySpring>(group, "spring_bodies", kSpringBodies);
  read_rows(group, "springs", packing.springs, kSpring);
  if (group.has("rolls")) read_rows(group, "rolls", packing.springs, kRoll);
  const auto bodies = static_cast<std::int64_t>(packing.bodies.size());
  for (const BodySpring& s : packing.springs)
    if (s.i < 0 || s.i >= bodies || s.j < 0 || s.j >= bodies + kWalls)
      throw IoError("macro packing: a spring of bodies that are not there");
  for (const BodySpring& s : packing.springs)
    if (!std::isfinite(norm2(s.spring)) || !std::isfinite(norm2(s.roll)))
      throw IoError("macro packing: 'springs' or 'rolls' holds a number that is not finite");
}

void require_places(const MacroPacking& packing) {
  if (!std::isfinite(norm2(packing.low)) || !std::isfinite(norm2(packing.high)))
    throw IoError("macro packing: 'box' holds a number that is not finite");
  for (const MacroBody& b : packing.bodies)
    if (!std::isfinite(norm2(b.x)) || !std::isfinite(b.r) || !(b.r > 0.0))
      throw IoError("macro packing: 'bodies' holds a place that is not finite, or a radius that is not above 0");
}

}  // namespace

void write_macro_packing(const h5::Group& group, const MacroPacking& packing) {
  write_row(group, "box", packing, kBox);
  write_rows(group, "bodies", packing.bodies, kBody);
  write_rows(group, "soft", packing.bodies, kSoft);
  if (std::ranges::any_of(packing.bodies, [](const MacroBody& b) { return b.material != 0; }))
    write_rows(group, "material", packing.bodies, kMaterial);
  write_springs(group, packing.springs);
  write_attributes(group, packing.cost);
  write_density_search(group, packing.density);
}

MacroPacking read_macro_packing(const h5::Group& group) {
  MacroPacking packing;
  read_row(group, "box", packing, kBox);
  packing.bodies = records_in_rows<MacroBody>(group, "soft", kSoft);
  read_rows(group, "bodies", packing.bodies, kBody);
  if (group.has("material")) {
    read_rows(group, "material", packing.bodies, kMaterial);
    for (const MacroBody& b : packing.bodies)
      if (b.material < 0 || b.material >= static_cast<std::int64_t>(GrainMaterials::kMost))
        throw IoError("macro packing: no such material");
  }
  require_places(packing);
  read_springs(group, packing);
  if (group.has_attribute("loop_passes")) read_attributes(group, packing.cost);
  packing.density = read_density_search(group);
  return packing;
}

}  // namespace softgrain
