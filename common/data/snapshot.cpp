// States of a run: which of them are kept, and the HDF5 files that hold them.
#include "common/data/snapshot_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "common/core/error.h"
#include "common/data/columns.h"
#include "common/data/snapshot.h"

namespace softgrain {

double Snapshot::moment() const {
  for (const double x : {time, strain, overlap})
    if (!std::isnan(x)) return x;
  return 0.0;
}

Moment Snapshot::moment_name() const {
  if (!std::isnan(time)) return Moment::time;
  if (!std::isnan(strain)) return Moment::strain;
  return std::isnan(overlap) ? Moment::frame : Moment::overlap;
}

bool is_snapshot(std::int64_t point, std::int64_t points, std::int64_t wanted) {
  if (wanted <= 0 || point < 0 || point >= points) return false;
  if (wanted >= points || point == points - 1) return true;
  // The first of the points that share a number; the last one has the last number to itself.
  const auto number = [&](std::int64_t f) { return f * (wanted - 1) / (points - 1); };
  return wanted > 1 && (point == 0 || number(point) != number(point - 1));
}

namespace {

constexpr const char* kStatesFormat = "states";

template <class Enum>
Enum checked(std::int64_t value, Enum last, const char* what) {
  if (value < 0 || value > static_cast<std::int64_t>(last)) throw IoError(std::string("unknown ") + what);
  return static_cast<Enum>(value);
}

void write_segments(const h5::Group& g, std::size_t count) {
  std::vector<std::int64_t> rows(2 * count);
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<std::int64_t>(k);
  g.write("segment", std::span<const std::int64_t>(rows), {count, 2});
}

std::string mass_unit(const Snapshot& s) {
  const bool si = s.length_unit == "m" && s.force_unit == "N" && s.time_unit == "s";
  return si ? "kg" : s.force_unit + " " + s.time_unit + "^2/" + s.length_unit;
}

void write_particles(const h5::Group& g, const Snapshot& s) {
  using P = SnapshotParticle;
  const auto& all = s.particles;
  write_vectors(g, "position", s.length_unit, all, [](const P& p) { return p.position; });
  write_column(g, "radius", s.length_unit, all, [](const P& p) { return p.radius; });
  if (s.has_velocity) {
    write_vectors(g, "velocity", s.length_unit + "/" + s.time_unit, all, [](const P& p) { return p.velocity; });
    write_vectors(g, "spin", "rad/" + s.time_unit, all, [](const P& p) { return p.spin; });
  }
  if (std::ranges::all_of(all, [](const P& p) { return std::isfinite(p.mass); }))
    write_column(g, "mass", mass_unit(s), all, [](const P& p) { return p.mass; });
  write_column(g, "id", "1", all, [](const P& p) { return p.id; });
  write_column(g, "role", "1", all, [](const P& p) { return static_cast<std::int64_t>(p.role); });
  g.attribute_of("role", "values", "0 solid, 1 soft, 2 inner");
  write_column(g, "body", "1", all, [](const P& p) { return p.body; });
  write_column(g, "material", "1", all, [](const P& p) { return p.material; });
  // ParaView's vertices want their numbers named.
  write_column(g, "index", "1", all, [&](const P& p) { return static_cast<std::int64_t>(&p - all.data()); });
}

/// Line k joins the two ends of contact k, as far as there are contacts.
void require_segments(const h5::Group& g) {
  const std::vector<std::int64_t> rows = g.integers("segment");
  require_shape(g, "segment", {rows.size() / 2, 2});
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] != static_cast<std::int64_t>(k))
      throw IoError(fmt::format("data set 'segment' holds {} in row {}, where {} belongs", rows[k], k / 2, k));
}

void read_particles(const h5::Group& g, Snapshot& s) {
  using P = SnapshotParticle;
  s.particles.resize(column_length(g, "id"));
  auto& all = s.particles;
  read_vectors(g, "position", s.length_unit, all, [](P& p, const Vec3& v) { p.position = v; });
  read_finite(
      g, "radius", s.length_unit, all, [](P& p, double v) { p.radius = v; }, Limits::not_negative());
  s.has_velocity = g.has("velocity");
  if (s.has_velocity)
    read_vectors(g, "velocity", s.length_unit + "/" + s.time_unit, all, [](P& p, const Vec3& v) { p.velocity = v; });
  if (g.has("spin")) read_vectors(g, "spin", "rad/" + s.time_unit, all, [](P& p, const Vec3& v) { p.spin = v; });
  if (g.has("mass"))
    read_finite(
        g, "mass", mass_unit(s), all, [](P& p, double v) { p.mass = v; },
        Limits{.low = std::numeric_limits<double>::min()});
  read_integers(g, "id", all, [](P& p, std::int64_t v) { p.id = v; });
  read_integers(g, "role", all, [](P& p, std::int64_t v) { p.role = checked(v, ParticleRole::inner, "role"); });
  read_integers(g, "body", all, [](P& p, std::int64_t v) { p.body = v; });
  read_integers(g, "material", all, [](P& p, std::int64_t v) { p.material = v; });
}

void write_walls(const h5::Group& g, const Snapshot& s) {
  using W = SnapshotWall;
  write_column(g, "shape", "1", s.walls, [](const W& w) { return static_cast<std::int64_t>(w.shape); });
  g.attribute_of("shape", "values", "0 plane, 1 inside of a sphere");
  write_vectors(g, "point", s.length_unit, s.walls, [](const W& w) { return w.point; });
  write_vectors(g, "normal", "1", s.walls, [](const W& w) { return w.normal; });
  write_column(g, "radius", s.length_unit, s.walls, [](const W& w) { return w.radius; });
  write_column(g, "body", "1", s.walls, [](const W& w) { return w.body; });
}

void read_walls(const h5::Group& g, Snapshot& s) {
  using W = SnapshotWall;
  s.walls.resize(column_length(g, "shape"));
  read_integers(g, "shape", s.walls,
                [](W& w, std::int64_t v) { w.shape = checked(v, WallShape::sphere_inside, "shape of a wall"); });
  read_vectors(g, "point", s.length_unit, s.walls, [](W& w, const Vec3& v) { w.point = v; });
  read_vectors(g, "normal", "1", s.walls, [](W& w, const Vec3& v) { w.normal = v; });
  read_finite(
      g, "radius", s.length_unit, s.walls, [](W& w, double v) { w.radius = v; }, Limits::not_negative());
  read_integers(g, "body", s.walls, [](W& w, std::int64_t v) { w.body = v; });
}

void write_number(const h5::Group& g, const char* name, double value) {
  if (!std::isnan(value)) g.attribute(name, value);
}
double read_number(const h5::Group& g, const char* name) {
  return g.has_attribute(name) ? read_attribute(g, name) : Snapshot::kNone;
}

void write_cell(const h5::Group& g, const Snapshot& s) {
  std::vector<double> edges;
  for (const Vec3& e : s.cell_edges) edges.insert(edges.end(), e.v.begin(), e.v.end());
  g.write("cell_edges", std::span<const double>(edges), {3, 3});
  g.attribute_of("cell_edges", "unit", s.length_unit);
  std::vector<std::int64_t> periodic;
  for (const bool p : s.periodic) periodic.push_back(p ? 1 : 0);
  g.write("cell_periodic", std::span<const std::int64_t>(periodic));
}

void read_cell(const h5::Group& g, Snapshot& s) {
  const std::vector<double> edges = read_numbers(g, "cell_edges", s.length_unit, {3, 3});
  require_shape(g, "cell_periodic", {3});
  const std::vector<std::int64_t> periodic = g.integers("cell_periodic");
  for (std::size_t k = 0; k < 3; ++k) {
    s.periodic[k] = periodic[k] != 0;
    for (std::size_t c = 0; c < 3; ++c) s.cell_edges[k].v[c] = edges[3 * k + c];
  }
}

}  // namespace

void write_snapshot_contacts(const h5::Group& g, const std::vector<SnapshotContact>& contacts, const Snapshot& units,
                             std::size_t segments) {
  using C = SnapshotContact;
  std::vector<std::int64_t> pairs;
  std::vector<double> ends;
  bool shifted = false;
  for (const C& c : contacts) {
    pairs.insert(pairs.end(), {c.i, c.j});
    ends.insert(ends.end(), {c.from[0], c.from[1], c.from[2], c.to[0], c.to[1], c.to[2]});
    shifted = shifted || c.shift != Vec3{};
  }
  g.write("pair", std::span<const std::int64_t>(pairs), {contacts.size(), 2});
  g.write("ends", std::span<const double>(ends), {2 * contacts.size(), 3});
  g.attribute_of("ends", "unit", units.length_unit);
  write_vectors(g, "point", units.length_unit, contacts, [](const C& c) { return c.point; });
  write_vectors(g, "force", units.force_unit, contacts, [](const C& c) { return c.force; });
  write_column(g, "normal_force", units.force_unit, contacts, [](const C& c) { return c.normal_force; });
  if (shifted) write_vectors(g, "shift", units.length_unit, contacts, [](const C& c) { return c.shift; });
  write_segments(g, segments);
}

std::vector<SnapshotContact> read_snapshot_contacts(const h5::Group& g, const SnapshotBodies& bodies,
                                                    const Snapshot& units) {
  using C = SnapshotContact;
  const std::vector<std::int64_t> pairs = g.integers("pair");
  std::vector<C> contacts(pairs.size() / 2);
  require_shape(g, "pair", {contacts.size(), 2});
  const std::vector<double> ends = read_numbers(g, "ends", units.length_unit, {2 * contacts.size(), 3});
  require_segments(g);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const std::int64_t i = pairs[2 * k];
    const std::int64_t j = pairs[2 * k + 1];
    if (i < 0 || j < 0 || i >= static_cast<std::int64_t>(bodies.particles) ||
        j >= static_cast<std::int64_t>(bodies.all))
      throw IoError("a contact names a body that is not there");
    contacts[k].i = static_cast<std::int32_t>(i);
    contacts[k].j = static_cast<std::int32_t>(j);
    for (std::size_t c = 0; c < 3; ++c) {
      contacts[k].from.v[c] = ends[6 * k + c];
      contacts[k].to.v[c] = ends[6 * k + 3 + c];
    }
  }
  read_vectors(g, "point", units.length_unit, contacts, [](C& c, const Vec3& v) { c.point = v; });
  read_vectors(g, "force", units.force_unit, contacts, [](C& c, const Vec3& v) { c.force = v; });
  read_finite(g, "normal_force", units.force_unit, contacts, [](C& c, double v) { c.normal_force = v; });
  if (g.has("shift")) read_vectors(g, "shift", units.length_unit, contacts, [](C& c, const Vec3& v) { c.shift = v; });
  return contacts;
}

void write_snapshot(const h5::Group& g, const Snapshot& s) {
  g.attribute("kind", static_cast<std::int64_t>(s.kind));
  g.attribute("kind_name", to_string(s.kind));
  g.attribute("series", s.series);
  g.attribute("label", s.label);
  g.attribute("frame", s.frame);
  write_number(g, "time", s.time);
  write_number(g, "strain", s.strain);
  write_number(g, "overlap", s.overlap);
  g.attribute("length_unit", s.length_unit);
  g.attribute("force_unit", s.force_unit);
  g.attribute("time_unit", s.time_unit);
  g.attribute("dimension", static_cast<std::int64_t>(s.dimension));
  write_particles(g.create("particles"), s);
  write_walls(g.create("walls"), s);
  write_cell(g, s);
  if (s.has_contacts) write_snapshot_contacts(g.create("contacts"), s.contacts, s, s.contacts.size());
}

Snapshot read_snapshot(const h5::Group& g) {
  Snapshot s;
  s.kind = checked(g.integer("kind"), SnapshotKind::grain_box, "kind of a state");
  s.series = g.text("series");
  s.label = g.text("label");
  s.frame = g.integer("frame");
  s.time = read_number(g, "time");
  s.strain = read_number(g, "strain");
  s.overlap = read_number(g, "overlap");
  s.length_unit = g.text("length_unit");
  s.force_unit = g.text("force_unit");
  s.time_unit = g.text("time_unit");
  const std::int64_t dimension = g.integer("dimension");
  if (dimension != 2 && dimension != 3)
    throw IoError(fmt::format("a state has {} dimensions; allowed: 2, 3", dimension));
  s.dimension = static_cast<int>(dimension);
  read_particles(g.open("particles"), s);
  read_walls(g.open("walls"), s);
  read_cell(g, s);
  s.has_contacts = g.has("contacts");
  if (!s.has_contacts) return s;
  const h5::Group contacts = g.open("contacts");
  s.contacts = read_snapshot_contacts(contacts, {s.particles.size(), s.particles.size() + s.walls.size()}, s);
  require_shape(contacts, "segment", {s.contacts.size(), 2});
  return s;
}

void write_snapshot_list(const h5::Group& group, const std::vector<Snapshot>& snapshots) {
  const h5::Group states = group.create("states");
  for (std::size_t k = 0; k < snapshots.size(); ++k)
    write_snapshot(states.create(fmt::format("{:06}", k)), snapshots[k]);
}

std::vector<Snapshot> read_snapshot_list(const h5::Group& group) {
  const h5::Group states = group.open("states");
  std::vector<Snapshot> out;
  for (const std::string& name : states.children()) out.push_back(read_snapshot(states.open(name)));
  return out;
}

void save_snapshots(const std::vector<Snapshot>& snapshots, const std::string& path, const Provenance& provenance) {
  h5::AtomicFile file(path);
  write_format(file.root(), kStatesFormat);
  write_snapshot_list(file.root(), snapshots);
  write_provenance(file.root(), provenance);
  file.commit();
}

h5::Group open_snapshots(const std::string& path) {
  h5::Group root = h5::open_file(path);
  require_format(root, kStatesFormat, path);
  return root;
}

}  // namespace softgrain
