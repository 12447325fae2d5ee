#include "microsim/particles/scene_walls.h"

#include <algorithm>
#include <cmath>

#include "microsim/particles/scene_vector.h"

namespace softgrain {

namespace {

enum class WallMotion { fixed, velocity, force };

}  // namespace

template <>
inline constexpr auto words<WallMotion> = word_list<WallMotion>({{WallMotion::fixed, "fixed"},
                                                                 {WallMotion::velocity, "velocity"},
                                                                 {WallMotion::force, "force"}});

namespace {

template <int D>
Vec<D> read_normal(const SceneTable& t) {
  const Vec<D> n = read_vector<D>(t, "normal", Unit::none);
  const double length = norm(n);
  if (!(length > 0.0) || !std::isfinite(1.0 / length)) {
    t.mistake("normal", "must not be the zero vector");
    return n;
  }
  return length == 1.0 ? n : n * (1.0 / length);
}

template <int D>
void read_shape(const SceneTable& t, SceneWall<D>& wall) {
  wall.plane = t.choice<WallShape>("shape") == WallShape::plane;
  if (wall.plane) {
    wall.body.x = read_vector<D>(t, "point", Unit::length);
    wall.normal = read_normal<D>(t);
  } else {
    wall.body.x = read_vector<D>(t, "center", Unit::length);
    wall.body.r = t.number("radius", Unit::length, Range::positive());
  }
}

template <int D>
void read_motion(const SceneTable& t, SceneWall<D>& wall) {
  const auto motion = t.choice<WallMotion>("motion", WallMotion::fixed);
  if (motion == WallMotion::velocity) wall.body.velocity = read_vector<D>(t, "velocity", Unit::velocity);
  if (motion != WallMotion::force) return;
  if (!wall.plane)
    t.mistake("motion", "\"force\" is for planes: the inside of a sphere is fixed or moves with a velocity");
  wall.load = t.number("force", Unit::force);
  wall.needs_mass = !t.has("mass");
  if (!wall.needs_mass) wall.body.mass = t.number("mass", Unit::mass, Range::positive());
}

template <int D>
void require_new_name(const SceneTable& t, const std::vector<SceneWall<D>>& walls, const std::string& name) {
  const auto same = std::find_if(walls.begin(), walls.end(), [&](const auto& w) { return w.name == name; });
  if (same != walls.end()) t.mistake("name", "another wall is called '" + name + "' (" + same->where + ")");
}

}  // namespace

template <int D>
std::vector<SceneWall<D>> read_walls(const SceneTable& root, const std::vector<Material>& materials) {
  std::vector<SceneWall<D>> walls;
  for (const SceneTable& t : root.tables("wall")) {
    SceneWall<D> wall;
    read_shape(t, wall);
    read_motion(t, wall);
    wall.name = t.text("name", "wall-" + std::to_string(walls.size() + 1));
    require_new_name(t, walls, wall.name);
    wall.where = t.where("shape");
    t.check([&] { wall.body.material = material_index(materials, t, "material"); });
    walls.push_back(wall);
  }
  return walls;
}

template std::vector<SceneWall<2>> read_walls<2>(const SceneTable&, const std::vector<Material>&);
template std::vector<SceneWall<3>> read_walls<3>(const SceneTable&, const std::vector<Material>&);

}  // namespace softgrain
