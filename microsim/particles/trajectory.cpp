#include "microsim/particles/trajectory.h"

#include <array>
#include <span>

#include "common/core/in_space.h"
#include "common/data/columns.h"
#include "common/neighbours/spatial_order.h"

namespace softgrain {

namespace {

/// How a member is called in the file.
struct Column {
  const char* name;
  const char* unit;
  std::vector<double> Trajectory::*values;
  std::size_t width;  ///< numbers per body; 0: one number per frame
};

constexpr std::array<Column, 9> kColumns{{
    {"time", "s", &Trajectory::time, 0},
    {"position", "m", &Trajectory::position, 3},
    {"velocity", "m/s", &Trajectory::velocity, 3},
    {"spin", "rad/s", &Trajectory::spin, 3},
    {"wall_position", "m", &Trajectory::wall_position, 3},
    {"cell_edges", "m", &Trajectory::cell_edges, 3},
    {"translational_energy", "J", &Trajectory::translational_energy, 0},
    {"rotational_energy", "J", &Trajectory::rotational_energy, 0},
    {"gravitational_energy", "J", &Trajectory::gravitational_energy, 0},
}};

void append(std::vector<double>& to, const Vec3& v) { to.insert(to.end(), v.v.begin(), v.v.end()); }

Vec3 axis_in_space(const Vec3& spin) { return spin; }
Vec3 axis_in_space(const Vec<1>& spin) { return {{0.0, 0.0, spin[0]}}; }

/// Row-major; an axis that a plane cell does not have is open, of length 1.
template <int D>
void append_edges(std::vector<double>& to, const Matrix<D>& edges) {
  for (int k = 0; k < 3; ++k) append(to, k < D ? in_space<D>(edges[k]) : Vec3{{0.0, 0.0, 1.0}});
}

h5::Shape shape_of(const Column& c, std::size_t frames, std::size_t values) {
  if (c.width == 0) return {frames};
  return {frames, frames == 0 ? 0 : values / (frames * c.width), c.width};
}

}  // namespace

template <int D>
void record_frame(Trajectory& t, const System<D>& s) {
  const auto& p = s.particles;
  double translational = 0.0;
  double rotational = 0.0;
  double gravitational = 0.0;
  for (const Slot slot : slots_by_id(p)) {
    const auto u = static_cast<std::size_t>(slot);
    append(t.position, in_space<D>(p.sphere[u].x));
    append(t.velocity, in_space<D>(p.velocity[u]));
    append(t.spin, axis_in_space(p.spin[u]));
    translational += 0.5 * norm2(p.velocity[u]) / p.inverse_mass[u];
    rotational += 0.5 * norm2(p.spin[u]) / p.inverse_inertia[u];
    gravitational -= dot(s.gravity, p.sphere[u].x) / p.inverse_mass[u];
  }
  for (auto u = static_cast<std::size_t>(p.grains); u < p.sphere.size(); ++u)
    append(t.wall_position, in_space<D>(p.sphere[u].x));
  append_edges<D>(t.cell_edges, s.cell.edges);
  t.time.push_back(s.time);
  t.translational_energy.push_back(translational);
  t.rotational_energy.push_back(rotational);
  t.gravitational_energy.push_back(gravitational);
}

template void record_frame<2>(Trajectory&, const System<2>&);
template void record_frame<3>(Trajectory&, const System<3>&);

void write_trajectory(const h5::Group& group, const Trajectory& t) {
  const std::size_t frames = t.time.size();
  for (const Column& c : kColumns) {
    const std::vector<double>& values = t.*c.values;
    group.write(c.name, values, shape_of(c, frames, values.size()));
    group.attribute_of(c.name, "unit", c.unit);
  }
}

Trajectory read_trajectory(const h5::Group& group) {
  Trajectory t;
  for (const Column& c : kColumns) {
    std::vector<double>& values = t.*c.values;
    values = group.doubles(c.name);
    require_unit(group, c.name, c.unit);
    require_shape(group, c.name, shape_of(c, t.time.size(), values.size()));
  }
  return t;
}

}  // namespace softgrain
