#include "microsim/particles/scene_walls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/error.h"
#include "common/data/snapshot.h"
#include "common/io/scene.h"
#include "common/neighbours/skin.h"

namespace softgrain {

namespace {

enum class WallMotion { fixed, velocity, force };

}  // namespace

template <>
inline constexpr auto enum_names<WallMotion> = enum_name_list<WallMotion>({{WallMotion::fixed, "fixed"},
                                                                           {WallMotion::velocity, "velocity"},
                                                                           {WallMotion::force, "force"}});

namespace {

template <int D>
Vec<D> read_normal(const SceneTable& t) {
  const Vec<D> n = read_vector<D>(
      t,
      {"normal",
       "normal of the plane, towards the particles; a particle that starts behind a plane is refused, unless "
       "`guards.escape` does not stop"},
      Unit::none);
  const double length = norm(n);
  if (!(length > 0.0) || !std::isfinite(1.0 / length)) {
    t.add_error("normal", "must not be the zero vector");
    return n;
  }
  return length == 1.0 ? n : n * (1.0 / length);
}

template <int D>
void read_shape(const SceneTable& t, SceneWall<D>& wall) {
  wall.plane = t.choice<WallShape>({"shape", "shape of the wall; for disks a line or the inside of a circle"}) ==
               WallShape::plane;
  if (wall.plane) {
    wall.body.x = read_vector<D>(t, {"point", "point of the plane"}, Unit::length);
    wall.normal = read_normal<D>(t);
  } else {
    wall.body.x = read_vector<D>(t, {"center", "centre of the sphere"}, Unit::length);
    wall.body.r = t.number({"radius", "radius of the sphere"}, Unit::length, Range::positive());
  }
}

template <int D>
void read_motion(const SceneTable& t, SceneWall<D>& wall) {
  const auto motion = t.choice<WallMotion>(
      {"motion", "what moves the wall; `\"force\"`: planes only, along the normal"}, WallMotion::fixed);
  if (motion == WallMotion::velocity)
    wall.body.velocity =
        read_vector<D>(t, {"velocity", "velocity of a wall with motion `\"velocity\"`"}, Unit::velocity);
  if (motion != WallMotion::force) return;
  if (!wall.plane)
    t.add_error("motion", "\"force\" is for planes: the inside of a sphere is fixed or moves with a velocity");
  wall.load = t.number({"force", "load on a wall with motion `\"force\"`"}, Unit::force);
  wall.needs_mass = !t.has("mass");
  if (!wall.needs_mass)
    wall.body.mass = t.number({"mass", "mass of a wall with motion `\"force\"`, at least that of the heaviest particle",
                               "mass of all particles"},
                              Unit::mass, Range::positive());
}

template <int D>
void require_new_name(const SceneTable& t, const std::vector<SceneWall<D>>& walls, const std::string& name) {
  const auto same = std::find_if(walls.begin(), walls.end(), [&](const auto& w) { return w.name == name; });
  if (same != walls.end()) t.add_error("name", "another wall is called '" + name + "' (" + same->where + ")");
  if (name == kNoWall)
    t.add_error("name", "must be another: inside = \"none\" of a particle says that no wall holds it");
}

}  // namespace

template <int D>
std::vector<SceneWall<D>> read_walls(const SceneTable& root, const std::vector<Material>& materials) {
  std::vector<SceneWall<D>> walls;
  for (const SceneTable& t : root.tables({"wall", "one wall"})) {
    SceneWall<D> wall;
    read_shape(t, wall);
    read_motion(t, wall);
    wall.name = t.line_text({"name", "name of the wall", "\"wall-1\", \"wall-2\" and so on"},
                            "wall-" + std::to_string(walls.size() + 1));
    require_new_name(t, walls, wall.name);
    wall.where = t.where("shape");
    t.check([&] { wall.body.material = material_index(materials, t, {"material", "material of the wall"}); });
    walls.push_back(wall);
  }
  return walls;
}

template std::vector<SceneWall<2>> read_walls<2>(const SceneTable&, const std::vector<Material>&);
template std::vector<SceneWall<3>> read_walls<3>(const SceneTable&, const std::vector<Material>&);

namespace {

/// The box on the first line of the file with the particles; `known`: that could be read.
template <int D>
Vec<D> size_in_file(const SceneTable& t, const SceneBodies<D>& bodies, bool known) {
  if (bodies.many_file.empty())
    t.throw_error("size", "\"file\" needs [particles] file, whose first line gives the box");
  Vec<D> size;
  for (int k = 0; k < D; ++k) {
    if (known && !(bodies.many_box[k] > 0.0))
      throw InputError(bodies.many_file + ":1: " + (D == 3 ? "Lx Ly Lz" : "Lx Ly") +
                       " must be above 0 for a cell with size = \"file\"");
    size[k] = bodies.many_box[k];
  }
  return size;
}

template <int D>
Vec<D> read_size(const SceneTable& t, const SceneBodies<D>& bodies, bool known) {
  const Key key{"size", "edge lengths, or `\"file\"`: those of the particle file"};
  if (t.is_text("size")) {
    (void)t.choice(key, {"file"});
    return size_in_file(t, bodies, known);
  }
  const Vec<D> size = read_vector<D>(t, key, Unit::length);
  for (int k = 0; k < D; ++k)
    if (!(size[k] > 0.0)) t.throw_error("size", "every component must be above 0");
  return size;
}

}  // namespace

template <int D>
Cell<D> read_cell(const SceneTable& root, const SceneBodies<D>& bodies) {
  if (!root.has("cell")) return open_cell<D>();
  const SceneTable t = root.table("cell");
  Vec<D> size;
  for (int k = 0; k < D; ++k) size[k] = 1.0;
  t.check([&] { size = read_size(t, bodies, !root.table_or_empty("particles").has_errors()); });
  const std::vector<bool> periodic = t.flags({"periodic", "which axes are periodic, one flag per axis"});
  if (periodic.size() != static_cast<std::size_t>(D))
    t.throw_error("periodic", D == 3 ? "must have three flags" : "must have two flags, as the scene has dimension = 2");
  std::array<bool, D> along{};
  std::copy(periodic.begin(), periodic.end(), along.begin());
  Cell<D> cell = box_cell<D>(size, along);
  constexpr double kFastest = 1e9;  // no step of such a cell is one of particles
  const double rate = t.number({"shear_rate", "shear rate of a cell that is periodic along x and y"}, Unit::frequency,
                               Range::closed(-kFastest, kFastest), 0.0);
  if (rate != 0.0 && !(periodic[0] && periodic[1]))
    t.add_error("shear_rate", "needs a cell that is periodic along x and y");
  cell.velocity_gradient[0][1] = rate;
  return cell;
}

template <int D>
void require_wide_cell(const SceneTable& root, const System<D>& s) {
  const Particles<D>& p = s.particles;
  const Cell<D>& cell = s.cell;
  if (!cell.any_periodic()) return;
  double largest = 0.0;
  for (Slot i = 0; i < p.grains; ++i) largest = std::max(largest, p.sphere[static_cast<std::size_t>(i)].r);
  const double half = half_reach(s.laws);
  const double least = (largest + half) / kShareOfPeriod;
  // Shear does not bring images nearer: beyond half an edge the cell is replaced by the one that leans the other way.
  for (int k = 0; k < D; ++k) {
    if (!cell.periodic[static_cast<std::size_t>(k)]) continue;
    const double width = cell.edges[k][k];
    if (width > least) continue;
    root.table("cell").add_error(
        "size", fmt::format("the periodic axis {} is {:.6g} m wide; allowed: above {:.6g} m, {:.3g} radii of the "
                            "largest particle{}",
                            "xyz"[k], width, least, 1.0 / kShareOfPeriod, half > 0.0 ? " with half its reach" : ""));
  }
}

template Cell<2> read_cell<2>(const SceneTable&, const SceneBodies<2>&);
template Cell<3> read_cell<3>(const SceneTable&, const SceneBodies<3>&);
template void require_wide_cell<2>(const SceneTable&, const System<2>&);
template void require_wide_cell<3>(const SceneTable&, const System<3>&);

}  // namespace softgrain
