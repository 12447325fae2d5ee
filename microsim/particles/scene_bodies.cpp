#include "microsim/particles/scene_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/text.h"
#include "common/io/scene.h"
#include "microsim/particles/scene_memory.h"
#include "microsim/particles/scene_walls.h"

namespace softgrain {

namespace {

/// Everything that turns tables into bodies.
template <int D>
struct Builder {
  const Scene& scene;
  const std::vector<Material>& materials;
  std::vector<SceneWall<D>> walls;
  bool valid;  ///< materials and walls are those of the scene
  SceneBodies<D> out;
  std::vector<NewBody<D>> grains;
  std::vector<std::ptrdiff_t> wall_of;  ///< per grain: index of its sphere-inside, -1 none
};

NewBody<2> solid_grain(const Vec2& x, double r, double density, std::int32_t material) {
  return solid_disk(x, r, density, material);
}
NewBody<3> solid_grain(const Vec3& x, double r, double density, std::int32_t material) {
  return solid_sphere(x, r, density, material);
}

/// About the axis out of the plane in two dimensions.
template <int D>
Rot<D> read_spin(const SceneTable& t) {
  const Key key{"spin", "initial angular velocity; that of a disk is a number"};
  if constexpr (D == 3)
    return t.vector3(key, Unit::angular_velocity, {});
  else
    return {{t.number(key, Unit::angular_velocity, Range::any(), 0.0)}};
}

template <int D>
double density_of(const Builder<D>& b, const SceneTable& t, std::int32_t material) {
  const Material& m = b.materials[static_cast<std::size_t>(material)];
  if (b.valid && !(m.density > 0.0)) t.add_error("material", "has no density, which particles need");
  return m.density;
}

/// Notes the last particle when no sphere-inside of the scene holds its centre.
template <int D>
void note_outside(Builder<D>& b) {
  const bool spheres = std::any_of(b.walls.begin(), b.walls.end(), [](const auto& w) { return !w.plane; });
  if (spheres && b.wall_of.back() < 0) b.out.outside_spheres.push_back(static_cast<Slot>(b.grains.size()) - 1);
}

template <int D>
std::ptrdiff_t chosen_wall(const Builder<D>& b, const SceneTable& t, const Vec<D>& x) {
  if (!t.has("inside")) return wall_around(b.walls, x);
  const std::string name =
      t.text({"inside",
              "name of the sphere wall around the particle; `\"none\"`: outside all spheres, without the usual warning",
              "the first sphere that contains its centre"});
  if (name == kNoWall || !b.valid) return -1;
  const auto found = std::find_if(b.walls.begin(), b.walls.end(), [&](const auto& w) { return w.name == name; });
  if (found == b.walls.end()) t.throw_error("inside", "no wall of this name");
  if (found->plane) t.throw_error("inside", "this wall is a plane, not a \"sphere-inside\"");
  if (!found->holds(x)) t.throw_error("inside", "the particle's centre is outside this sphere");
  return found - b.walls.begin();
}

template <int D>
void add_table(Builder<D>& b, const SceneTable& t) {
  const std::int32_t material = material_index(b.materials, t, {"material", "material of the particle"});
  const double r = t.number({"radius", "radius of the particle"}, Unit::length, Range::positive());
  NewBody<D> body = solid_grain(read_vector<D>(t, {"position", "centre of the particle"}, Unit::length), r,
                                density_of(b, t, material), material);
  body.velocity = read_vector<D>(t, {"velocity", "initial velocity", "0"}, Unit::velocity, {});
  body.spin = read_spin<D>(t);
  b.grains.push_back(body);
  b.wall_of.push_back(chosen_wall(b, t, body.x));
  if (!t.has("inside")) note_outside(b);
  b.out.where.push_back(t.where("position"));
}

const Key kMaterialOfManyKey{"material", "material of all particles of `file` or `count`"};

/// A file has three coordinates always; disks lie in z = 0.
template <int D>
Vec<D> flat(const Vec3& x, const std::string& path, std::size_t k) {
  if constexpr (D == 3) {
    return x;
  } else {
    if (x[2] != 0.0)
      throw InputError(path + ":" + std::to_string(xyzr_line(k)) + ": z must be 0, as the scene has dimension = 2");
    return {{x[0], x[1]}};
  }
}

template <int D>
void add_file(Builder<D>& b, const SceneTable& t) {
  if (!t.has("file")) return;
  if (t.has("sizes")) t.throw_error("file", "goes without sizes, which says all sizes");
  b.out.many_file = b.scene.resolve(t.filled_text(
      {"file", "many particles: `N Lx Ly Lz`, then N lines `x y z r`; plain text or gzip; disks have z = 0"}));
  const std::int32_t material = material_index(b.materials, t, kMaterialOfManyKey);
  const double density = density_of(b, t, material);
  if (t.has_errors()) return;
  const XyzrFile file = read_xyzr(b.out.many_file, [&](std::int64_t n) {
    const std::string problem = memory_problem(n, available_memory());
    if (!problem.empty()) throw InputError(b.out.many_file + ":1: N = " + std::to_string(n) + ": " + problem);
  });
  b.out.many_box = file.box;
  for (std::size_t k = 0; k < file.radius.size(); ++k) {
    const Vec<D> x = flat<D>(file.position[k], b.out.many_file, k);
    b.grains.push_back(solid_grain(x, file.radius[k], density, material));
    b.wall_of.push_back(wall_around(b.walls, x));
    note_outside(b);
  }
}

template <int D>
void add_drawn(Builder<D>& b, const SceneTable& root, const SceneTable& t, const std::optional<std::uint64_t>& seed) {
  if (!t.has("count") && !t.has("sizes")) {
    const std::string nothing =
        "nothing is drawn at random in this scene ([particles] count and sizes are); leave it out";
    root.refuse({"seed"}, nothing);
    if (seed) throw InputError("--seed: " + nothing);
    return;
  }
  const std::int32_t material = material_index(b.materials, t, kMaterialOfManyKey);
  const double density = density_of(b, t, material);
  DrawnParticles<D> drawn = read_drawn<D>(root, t, b.walls, b.grains, b.out.many_box, seed);
  for (std::size_t k = 0; k < drawn.position.size(); ++k) {
    b.grains.push_back(solid_grain(drawn.position[k], drawn.radius[k], density, material));
    b.wall_of.push_back(wall_around(b.walls, drawn.position[k]));
    note_outside(b);
  }
  b.out.sizes = std::move(drawn.sizes);
  b.out.drawn = std::move(drawn.radius);
  b.out.drawn_where = t.where("count");
  b.out.seed = drawn.seed;
}

template <int D>
void require_fits(const Builder<D>& b, Slot k) {
  const NewBody<D>& grain = b.grains[static_cast<std::size_t>(k)];
  const SceneWall<D>& wall = b.walls[static_cast<std::size_t>(b.wall_of[static_cast<std::size_t>(k)])];
  if (grain.r < wall.body.r) return;
  throw InputError(b.out.where_of(k) + ": radius = " + rounded_text(grain.r, {6}) + ": must be below " +
                   rounded_text(wall.body.r, {6}) + ", the radius of the sphere around it, '" + wall.name + "' (" +
                   wall.where + ")");
}

/// Radii and densities so extreme that the mass is no number.
template <int D>
void require_mass(const Builder<D>& b, Slot k) {
  const NewBody<D>& grain = b.grains[static_cast<std::size_t>(k)];
  if (grain.inertia > 0.0 && std::isfinite(grain.mass) && std::isfinite(1.0 / grain.inertia)) return;
  throw InputError(b.out.where_of(k) + ": radius = " + rounded_text(grain.r, {6}) +
                   ": the mass of this particle is out of the range of numbers");
}

/// Slots of the walls: sphere-insides follow the particles, planes come last.
template <int D>
std::vector<Slot> wall_slots(const Builder<D>& b) {
  std::vector<Slot> slots(b.walls.size());
  auto next = static_cast<Slot>(b.grains.size());
  for (const bool plane : {false, true})
    for (std::size_t w = 0; w < b.walls.size(); ++w)
      if (b.walls[w].plane == plane) slots[w] = next++;
  return slots;
}

template <int D>
void place_grains(Builder<D>& b, const std::vector<Slot>& slots) {
  for (std::size_t k = 0; k < b.grains.size(); ++k) {
    require_mass(b, static_cast<Slot>(k));
    if (b.wall_of[k] >= 0) {
      require_fits(b, static_cast<Slot>(k));
      b.grains[k].shell = slots[static_cast<std::size_t>(b.wall_of[k])];
    }
    add_grain(b.out.particles, b.grains[k]);
  }
}

template <int D>
void place_walls(Builder<D>& b) {
  double total = 0.0;
  double heaviest = 0.0;
  for (const NewBody<D>& grain : b.grains) {
    total += grain.mass;
    heaviest = std::max(heaviest, grain.mass);
  }
  for (SceneWall<D>& w : b.walls) {
    if (w.plane) continue;
    add_shell(b.out.particles, w.body);
    b.out.wall_name.push_back(w.name);
  }
  for (SceneWall<D>& w : b.walls) {
    if (!w.plane) continue;
    if (w.needs_mass) w.body.mass = total;
    if (w.body.mass > 0.0 && w.body.mass < heaviest)
      throw InputError(w.where + ": mass = " + rounded_text(w.body.mass, {6}) +
                       ": a wall moved by a force must weigh at least as much as the heaviest particle, " +
                       rounded_text(heaviest, {6}) + " kg (left out: the mass of all particles, " +
                       rounded_text(total, {6}) + " kg)");
    const Slot slot = add_plane(b.out.particles, w.body, w.normal);
    b.out.particles.plane_load[static_cast<std::size_t>(slot - b.out.particles.first_plane())] = w.load;
    b.out.wall_name.push_back(w.name);
  }
}

template <int D>
void place_all(Builder<D>& b) {
  if (b.grains.empty())
    throw InputError(b.scene.path() +
                     ":1: the scene has no particle: give [[particle]] tables or [particles] file, or "
                     "count and sizes");
  place_grains(b, wall_slots(b));
  place_walls(b);
}

template <int D>
void read_grains(Builder<D>& b, const SceneTable& root, const std::optional<std::uint64_t>& seed) {
  for (const SceneTable& t : root.tables({"particle", "one particle"})) t.section([&] { add_table(b, t); });
  const SceneTable many = root.table_or_empty({"particles", "many particles, from a file or placed at random"});
  many.section([&] { add_file(b, many); });
  many.section([&] { add_drawn(b, root, many, seed); });
  if (!root.has_errors()) root.check([&] { place_all(b); });
}

}  // namespace

template <int D>
std::string SceneBodies<D>::where_of(Slot particle) const {
  const auto k = static_cast<std::size_t>(particle);
  if (k >= where.size() && many_file.empty()) return drawn_where;
  return k < where.size() ? where[k] : many_file + ":" + std::to_string(xyzr_line(k - where.size()));
}

template <int D>
SceneBodies<D> read_bodies(const Scene& scene, const std::vector<Material>& materials,
                           const std::optional<std::uint64_t>& seed) {
  const SceneTable root = scene.root();
  Builder<D> b{scene, materials, read_walls<D>(root, materials), !root.has_errors(), {}, {}, {}};
  read_grains(b, root, seed);
  return std::move(b.out);
}

template <int D>
void require_distinct_centres(const SceneBodies<D>& bodies, const Cell<D>& cell) {
  std::vector<Vec<D>> centre;
  for (Slot i = 0; i < bodies.particles.grains; ++i) {
    Vec<D> x = bodies.particles.sphere[static_cast<std::size_t>(i)].x;
    for (int k = 0; k < D; ++k)
      if (cell.periodic[static_cast<std::size_t>(k)]) x[k] -= cell.edges[k][k] * std::floor(x[k] / cell.edges[k][k]);
    centre.push_back(x);
  }
  std::vector<std::size_t> order(centre.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t c) {
    return centre[a].v != centre[c].v ? centre[a].v < centre[c].v : a < c;
  });
  for (std::size_t k = 1; k < order.size(); ++k) {
    const auto first = static_cast<Slot>(order[k - 1]);
    const auto second = static_cast<Slot>(order[k]);
    if (centre[order[k - 1]].v == centre[order[k]].v)
      throw InputError(fmt::format("{}: position: particle {} has the same centre as particle {} ({})",
                                   bodies.where_of(second), second, first, bodies.where_of(first)));
  }
}

template void require_distinct_centres<2>(const SceneBodies<2>&, const Cell<2>&);
template void require_distinct_centres<3>(const SceneBodies<3>&, const Cell<3>&);
template struct SceneBodies<2>;
template struct SceneBodies<3>;
template SceneBodies<2> read_bodies<2>(const Scene&, const std::vector<Material>&, const std::optional<std::uint64_t>&);
template SceneBodies<3> read_bodies<3>(const Scene&, const std::vector<Material>&, const std::optional<std::uint64_t>&);

}  // namespace softgrain
