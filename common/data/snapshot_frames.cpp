#include "common/data/snapshot_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "common/core/error.h"
#include "common/data/columns.h"
#include "common/data/snapshot_io.h"

namespace softgrain {

namespace {

/// Which series have a column.
enum class Kept {
  always,
  moving,  ///< those that keep motion
  if_any   ///< no data set where it is empty
};

/// How a member is called in the file.
struct FrameColumn {
  const char* name;
  const char* unit;
  std::vector<double> Trajectory::*values;
  std::size_t width;  ///< numbers per body; 0: one number per frame
  Kept kept = Kept::moving;
};

constexpr std::array<FrameColumn, 12> kFrameColumns{{
    {"time", "s", &Trajectory::time, 0, Kept::always},
    {"position", "m", &Trajectory::position, 3, Kept::always},
    {"velocity", "m/s", &Trajectory::velocity, 3},
    {"spin", "rad/s", &Trajectory::spin, 3},
    {"wall_position", "m", &Trajectory::wall_position, 3},
    {"cell_edges", "m", &Trajectory::cell_edges, 3, Kept::always},
    {"translational_energy", "J", &Trajectory::translational_energy, 0},
    {"rotational_energy", "J", &Trajectory::rotational_energy, 0},
    {"gravitational_energy", "J", &Trajectory::gravitational_energy, 0},
    {"stress", "Pa", &Trajectory::stress, 3, Kept::if_any},
    {"fabric", "1", &Trajectory::fabric, 3, Kept::if_any},
    {"inertial_number", "1", &Trajectory::inertial_number, 0, Kept::if_any},
}};

/// Series in units of their own keep time and lengths alone.
std::string unit_of(const FrameColumn& c, const Snapshot& form) {
  const std::string si = c.unit;
  return si == "s" ? form.time_unit : si == "m" ? form.length_unit : si;
}

h5::Shape shape_of(const FrameColumn& c, std::size_t frames, std::size_t values) {
  if (c.width == 0) return {frames};
  return {frames, frames == 0 ? 0 : values / (frames * c.width), c.width};
}

void read_column(const h5::Group& group, const FrameColumn& c, const std::string& unit, Trajectory& t) {
  std::vector<double>& values = t.*c.values;
  values = group.doubles(c.name);
  require_unit(group, c.name, unit);
  require_shape(group, c.name, shape_of(c, t.time.size(), values.size()));
}

std::size_t most_of(const FrameContacts& c) {
  return static_cast<std::size_t>(c.count.empty() ? 0 : *std::ranges::max_element(c.count));
}

}  // namespace

Snapshot moving_frames() {
  Snapshot form;
  form.has_velocity = true;
  return form;
}

void write_trajectory(const h5::Group& group, const Trajectory& t, const Snapshot& form) {
  const std::size_t frames = t.time.size();
  for (const FrameColumn& c : kFrameColumns) {
    const std::vector<double>& values = t.*c.values;
    const bool kept = c.kept == Kept::if_any ? !values.empty() : c.kept == Kept::always || form.has_velocity;
    if (!kept) continue;
    group.write(c.name, values, shape_of(c, frames, values.size()));
    group.attribute_of(c.name, "unit", unit_of(c, form));
  }
}

Trajectory read_trajectory(const h5::Group& group, const Snapshot& form) {
  Trajectory t;
  for (const FrameColumn& c : kFrameColumns)
    if (c.kept == Kept::if_any ? group.has(c.name) : c.kept == Kept::always || form.has_velocity)
      read_column(group, c, unit_of(c, form), t);
  return t;
}

Trajectory read_columns(const h5::Group& group, std::initializer_list<std::vector<double> Trajectory::*> columns) {
  Trajectory t;
  for (const FrameColumn& c : kFrameColumns)
    if (c.values == &Trajectory::time || std::ranges::find(columns, c.values) != columns.end())
      if (c.kept != Kept::if_any || group.has(c.name)) read_column(group, c, c.unit, t);
  return t;
}

void write_frame_contacts(const h5::Group& group, const FrameContacts& c) {
  group.write("frame", std::span<const std::int64_t>(c.frame));
  group.write("count", std::span<const std::int64_t>(c.count));
  write_snapshot_contacts(group, c.contacts, Snapshot{}, most_of(c));
}

FrameContacts read_frame_contacts(const h5::Group& group, std::size_t particles, std::size_t bodies) {
  FrameContacts c;
  c.frame = group.integers("frame");
  c.count = group.integers("count");
  c.contacts = read_snapshot_contacts(group, {particles, bodies}, Snapshot{});
  std::int64_t total = 0;
  for (const std::int64_t n : c.count) {
    if (n < 0 || n > static_cast<std::int64_t>(c.contacts.size())) throw IoError("contacts of frames do not fit");
    total += n;
  }
  if (c.frame.size() != c.count.size() || total != static_cast<std::int64_t>(c.contacts.size()) ||
      !std::is_sorted(c.frame.begin(), c.frame.end()))
    throw IoError("contacts of frames do not fit");
  require_shape(group, "segment", {most_of(c), 2});
  return c;
}

namespace {

void require(bool fits, const char* what) {
  if (!fits) throw IoError(fmt::format("data set '{}' does not fit the rest of the file", what));
}

bool all_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

Vec3 vector_at(const std::vector<double>& flat, std::size_t row) {
  return {{flat[3 * row], flat[3 * row + 1], flat[3 * row + 2]}};
}

bool is_valid(const Snapshot& s) {
  return std::ranges::all_of(s.particles, [](const SnapshotParticle& p) {
    return std::isfinite(norm2(p.position)) && std::isfinite(norm2(p.velocity)) && std::isfinite(norm2(p.spin));
  });
}

}  // namespace

SnapshotSeries::SnapshotSeries(Snapshot bodies, Trajectory frames, FrameContacts contacts)
    : bodies_(std::move(bodies)), frames_(std::move(frames)), contacts_(std::move(contacts)), starts_{0} {
  const std::size_t count = frames_.time.size();
  const std::size_t numbers = 3 * count * bodies_.particles.size();
  require(frames_.position.size() == numbers, "position");
  require(frames_.velocity.size() == (bodies_.has_velocity ? numbers : 0), "velocity");
  require(frames_.spin.size() == frames_.velocity.size(), "spin");
  require(frames_.wall_position.size() == 3 * count * bodies_.walls.size(), "wall_position");
  require(frames_.cell_edges.size() == 9 * count && all_finite(frames_.cell_edges), "cell_edges");
  require(all_finite(frames_.wall_position), "wall_position");
  require(all_finite(frames_.time), "time");
  for (const std::int64_t n : contacts_.count) starts_.push_back(starts_.back() + static_cast<std::size_t>(n));
  bodies_.has_contacts = false;
  bodies_.contacts.clear();
}

std::optional<Snapshot> SnapshotSeries::at(std::size_t frame) const {
  const Trajectory& t = frames_;
  Snapshot s = bodies_;
  s.frame = static_cast<std::int64_t>(frame);
  s.time = t.time[frame];
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    const std::size_t row = frame * s.particles.size() + k;
    s.particles[k].position = vector_at(t.position, row);
    s.particles[k].velocity = s.has_velocity ? vector_at(t.velocity, row) : Vec3{};
    s.particles[k].spin = s.has_velocity ? vector_at(t.spin, row) : Vec3{};
  }
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    s.walls[k].point = vector_at(t.wall_position, frame * s.walls.size() + k);
  // The file has the matrix row by row; an edge is a column.
  for (std::size_t edge = 0; edge < 3; ++edge)
    for (std::size_t row = 0; row < 3; ++row) s.cell_edges[edge].v[row] = t.cell_edges[9 * frame + 3 * row + edge];
  if (!is_valid(s)) return std::nullopt;
  add_contacts(s);
  return s;
}

void SnapshotSeries::add_contacts(Snapshot& s) const {
  const auto at = std::ranges::lower_bound(contacts_.frame, s.frame);
  if (at == contacts_.frame.end() || *at != s.frame) return;
  const auto k = static_cast<std::size_t>(at - contacts_.frame.begin());
  s.has_contacts = true;
  s.contacts.assign(contacts_.contacts.begin() + static_cast<std::ptrdiff_t>(starts_[k]),
                    contacts_.contacts.begin() + static_cast<std::ptrdiff_t>(starts_[k + 1]));
}

namespace {

std::vector<SnapshotParticle> read_particles(const h5::Group& bodies) {
  const std::vector<double> radius = bodies.doubles("radius");
  const std::vector<std::int64_t> material = bodies.integers("material");
  require(material.size() == radius.size(), "material");
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  require(std::ranges::all_of(radius, positive), "radius");
  std::vector<double> mass(radius.size(), Snapshot::kNone);
  if (bodies.has("mass")) mass = bodies.doubles("mass");
  require(mass.size() == radius.size(), "mass");
  require(!bodies.has("mass") || std::ranges::all_of(mass, positive), "mass");
  std::vector<std::int64_t> soft;
  if (bodies.has("material_is_soft")) soft = bodies.integers("material_is_soft");
  std::vector<SnapshotParticle> particles(radius.size());
  for (std::size_t k = 0; k < particles.size(); ++k) {
    SnapshotParticle& p = particles[k];
    p.radius = radius[k];
    p.mass = mass[k];
    p.material = material[k];
    p.id = p.body = static_cast<std::int64_t>(k);
    const auto m = static_cast<std::size_t>(material[k]);
    if (material[k] >= 0 && m < soft.size() && soft[m] != 0) p.role = ParticleRole::soft;
  }
  return particles;
}

/// Walls of a full state. They have as many coordinates as the run has dimensions.
std::vector<SnapshotWall> read_walls(const h5::Group& bodies, std::size_t particles, std::size_t dimension) {
  const std::vector<std::int64_t> counts = bodies.integers("counts");
  const std::vector<double> spheres = bodies.doubles("sphere");
  const std::vector<double> normals = bodies.doubles("plane_normal");
  require(counts.size() == 3 && counts[0] == static_cast<std::int64_t>(particles) && counts[1] >= 0 && counts[2] >= 0,
          "counts");
  const auto shells = static_cast<std::size_t>(counts[1]);
  const auto planes = static_cast<std::size_t>(counts[2]);
  require(spheres.size() == (dimension + 1) * (particles + shells + planes), "sphere");
  require(normals.size() == dimension * planes && all_finite(normals), "plane_normal");
  std::vector<SnapshotWall> walls(shells + planes);
  for (std::size_t k = 0; k < walls.size(); ++k) {
    if (k < shells) {
      walls[k].shape = WallShape::sphere_inside;
      walls[k].radius = spheres[(dimension + 1) * (particles + k) + dimension];
      require(std::isfinite(walls[k].radius), "sphere");
    } else {
      for (std::size_t c = 0; c < dimension; ++c) walls[k].normal.v[c] = normals[dimension * (k - shells) + c];
    }
  }
  return walls;
}

}  // namespace

SnapshotSeries read_series(const h5::Group& group, const std::string& state, Snapshot form) {
  form.particles = read_particles(group.open("bodies"));
  const h5::Group full = group.open(state);
  if (group.has_attribute("dimension")) form.dimension = static_cast<int>(group.integer("dimension"));
  require(form.dimension == 2 || form.dimension == 3, "dimension");
  const auto dimension = static_cast<std::size_t>(form.dimension);
  form.walls = read_walls(full.open("bodies"), form.particles.size(), dimension);
  const std::vector<std::int64_t> periodic = full.open("cell").integers("periodic");
  require(periodic.size() == dimension, "periodic");
  for (std::size_t k = 0; k < dimension; ++k) form.periodic[k] = periodic[k] != 0;
  Trajectory frames = read_trajectory(group.open("trajectory"), form);
  FrameContacts contacts;
  if (group.has("frame_contacts"))
    contacts = read_frame_contacts(group.open("frame_contacts"), form.particles.size(),
                                   form.particles.size() + form.walls.size());
  return {std::move(form), std::move(frames), std::move(contacts)};
}

}  // namespace softgrain
