// The frames that run.h5 holds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "microsim/particles/trajectory.h"
#include "pipelines/kinds/particles/scene.h"

namespace softgrain {

namespace {

/// All that run.h5 says of bodies; positions come with every frame.
struct Bodies {
  std::vector<SnapshotParticle> particles;
  std::vector<SnapshotWall> walls;
  std::array<bool, 3> periodic{};
  int dimension = 3;
};

void require(bool fits, const char* what) {
  if (!fits) throw IoError(fmt::format("data set '{}' does not fit the rest of the file", what));
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

std::vector<SnapshotParticle> read_particles(const h5::Group& bodies) {
  const std::vector<double> radius = bodies.doubles("radius");
  const std::vector<std::int64_t> material = bodies.integers("material");
  require(material.size() == radius.size(), "material");
  require(std::all_of(radius.begin(), radius.end(), [](double r) { return std::isfinite(r) && r > 0.0; }), "radius");
  std::vector<std::int64_t> soft;
  if (bodies.has("material_is_soft")) soft = bodies.integers("material_is_soft");
  std::vector<SnapshotParticle> particles(radius.size());
  for (std::size_t k = 0; k < particles.size(); ++k) {
    SnapshotParticle& p = particles[k];
    p.radius = radius[k];
    p.material = material[k];
    p.id = p.body = static_cast<std::int64_t>(k);
    const auto m = static_cast<std::size_t>(material[k]);
    if (material[k] >= 0 && m < soft.size() && soft[m] != 0) p.role = ParticleRole::soft;
  }
  return particles;
}

/// Walls of the full state that ends the file. They have as many coordinates as the run has dimensions.
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

Bodies read_bodies(const h5::Group& root) {
  Bodies out;
  out.particles = read_particles(root.open("bodies"));
  const h5::Group last = root.open("final");
  if (root.has_attribute("dimension")) out.dimension = static_cast<int>(root.integer("dimension"));
  require(out.dimension == 2 || out.dimension == 3, "dimension");
  const auto dimension = static_cast<std::size_t>(out.dimension);
  out.walls = read_walls(last.open("bodies"), out.particles.size(), dimension);
  const std::vector<std::int64_t> periodic = last.open("cell").integers("periodic");
  require(periodic.size() == dimension, "periodic");
  for (std::size_t k = 0; k < dimension; ++k) out.periodic[k] = periodic[k] != 0;
  return out;
}

Vec3 vector_at(const std::vector<double>& flat, std::size_t row) {
  return {{flat[3 * row], flat[3 * row + 1], flat[3 * row + 2]}};
}

void require_fits(const Trajectory& t, const Bodies& bodies) {
  const std::size_t frames = t.time.size();
  require(t.position.size() == 3 * frames * bodies.particles.size(), "position");
  require(t.velocity.size() == t.position.size(), "velocity");
  require(t.wall_position.size() == 3 * frames * bodies.walls.size(), "wall_position");
  require(t.cell_edges.size() == 9 * frames && all_finite(t.cell_edges), "cell_edges");
  require(all_finite(t.wall_position), "wall_position");
  require(all_finite(t.time), "time");
}

Snapshot frame_of(const Trajectory& t, const Bodies& bodies, std::size_t frame) {
  Snapshot s;
  s.series = "particles";
  s.frame = static_cast<std::int64_t>(frame);
  s.time = t.time[frame];
  s.label = fmt::format("particles at {:.4g} s", s.time);
  s.has_velocity = true;
  s.dimension = bodies.dimension;
  s.particles = bodies.particles;
  s.walls = bodies.walls;
  s.periodic = bodies.periodic;
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    s.particles[k].position = vector_at(t.position, frame * s.particles.size() + k);
    s.particles[k].velocity = vector_at(t.velocity, frame * s.particles.size() + k);
  }
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    s.walls[k].point = vector_at(t.wall_position, frame * s.walls.size() + k);
  // The file has the matrix row by row; an edge is a column.
  for (std::size_t edge = 0; edge < 3; ++edge)
    for (std::size_t row = 0; row < 3; ++row) s.cell_edges[edge].v[row] = t.cell_edges[9 * frame + 3 * row + edge];
  return s;
}

bool is_valid(const Snapshot& s) {
  return std::all_of(s.particles.begin(), s.particles.end(), [](const SnapshotParticle& p) {
    return std::isfinite(norm2(p.position)) && std::isfinite(norm2(p.velocity));
  });
}

/// First contact of every recorded frame.
std::vector<std::size_t> starts_of(const FrameContacts& contacts) {
  std::vector<std::size_t> starts{0};
  for (const std::int64_t n : contacts.count) starts.push_back(starts.back() + static_cast<std::size_t>(n));
  return starts;
}

void add_contacts(Snapshot& s, const FrameContacts& all, const std::vector<std::size_t>& starts) {
  const auto at = std::lower_bound(all.frame.begin(), all.frame.end(), s.frame);
  if (at == all.frame.end() || *at != s.frame) return;
  const auto k = static_cast<std::size_t>(at - all.frame.begin());
  s.has_contacts = true;
  s.contacts.assign(all.contacts.begin() + static_cast<std::ptrdiff_t>(starts[k]),
                    all.contacts.begin() + static_cast<std::ptrdiff_t>(starts[k + 1]));
}

}  // namespace

void visit_particles(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit) {
  const h5::Group root = h5::open_file(path);
  if (!root.has_attribute("kind") || parse_enum<SnapshotKind>(root.text("kind")) != SnapshotKind::particles)
    throw IoError(path + ": holds no particles");
  const Bodies bodies = read_bodies(root);
  const Trajectory t = read_trajectory(root.open("trajectory"));
  require_fits(t, bodies);
  FrameContacts contacts;
  if (root.has("frame_contacts"))
    contacts = read_frame_contacts(root.open("frame_contacts"), bodies.particles.size(),
                                   bodies.particles.size() + bodies.walls.size());
  const std::vector<std::size_t> starts = starts_of(contacts);
  const std::size_t frames = t.time.size();
  for (std::size_t k = choice == SnapshotChoice::last && frames > 0 ? frames - 1 : 0; k < frames; ++k) {
    Snapshot s = frame_of(t, bodies, k);
    if (!is_valid(s)) continue;
    add_contacts(s, contacts, starts);
    visit(s);
  }
}

}  // namespace softgrain
