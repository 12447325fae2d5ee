// States of a run: which of them are kept, and the HDF5 files that hold them.
#include "common/data/snapshot_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "common/core/error.h"
#include "common/data/attributes.h"
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

/// Units of a state, and which columns it has.
struct BodyForm {
  std::string length;
  std::string velocity;
  std::string spin;
  std::string mass;
  std::string force;
  bool moves = false;
  bool weighed = false;  ///< all masses are known
  bool shifted = false;  ///< contacts reach into images
};

BodyForm form_of(const Snapshot& s) {
  const bool si = s.length_unit == "m" && s.force_unit == "N" && s.time_unit == "s";
  return {s.length_unit, s.length_unit + "/" + s.time_unit, "rad/" + s.time_unit,
          si ? "kg" : s.force_unit + " " + s.time_unit + "^2/" + s.length_unit, s.force_unit};
}

}  // namespace

void fields(auto&& visit, Of<SnapshotParticle> auto& p, const BodyForm& form) {
  visit("position", p.position, form.length, kAsRows);
  visit("radius", p.radius, form.length, Limits::not_negative());
  if (form.moves) {
    visit("velocity", p.velocity, form.velocity, kAsRows);
    visit("spin", p.spin, form.spin, kAsRows, kLater);
  }
  if (form.weighed) visit("mass", p.mass, form.mass, Limits{.low = std::numeric_limits<double>::min()});
  visit("id", p.id, "1");
  visit("role", p.role, "1", UpTo{ParticleRole::inner, "unknown role"});
  visit("body", p.body, "1");
  visit("material", p.material, "1");
}

void fields(auto&& visit, Of<SnapshotWall> auto& w, const BodyForm& form) {
  visit("shape", w.shape, "1", UpTo{WallShape::sphere_inside, "unknown shape of a wall"});
  visit("point", w.point, form.length, kAsRows);
  visit("normal", w.normal, "1", kAsRows);
  visit("radius", w.radius, form.length, Limits::not_negative());
  visit("body", w.body, "1");
}

/// Without what it names and where its line ends.
void fields(auto&& visit, Of<SnapshotContact> auto& c, const BodyForm& form) {
  visit("point", c.point, form.length, kAsRows);
  visit("force", c.force, form.force, kAsRows);
  visit("normal_force", c.normal_force, form.force);
  if (form.shifted) visit("shift", c.shift, form.length, kAsRows);
}

/// Without its kind and its lists.
void fields(auto&& visit, Of<Snapshot> auto& s) {
  visit("series", s.series);
  visit("label", s.label);
  visit("frame", s.frame);
  visit("time", s.time, kIfAny, Limits{});
  visit("strain", s.strain, kIfAny, Limits{});
  visit("overlap", s.overlap, kIfAny, Limits{});
  visit("length_unit", s.length_unit);
  visit("force_unit", s.force_unit);
  visit("time_unit", s.time_unit);
  visit("dimension", s.dimension);
}

namespace {

void write_segments(const h5::Group& g, std::size_t count) {
  std::vector<std::int64_t> rows(2 * count);
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<std::int64_t>(k);
  g.write("segment", std::span<const std::int64_t>(rows), {count, 2});
}

void write_particles(const h5::Group& g, const Snapshot& s) {
  const auto& all = s.particles;
  BodyForm form = form_of(s);
  form.moves = s.has_velocity;
  form.weighed = std::ranges::all_of(all, [](const SnapshotParticle& p) { return std::isfinite(p.mass); });
  write_records(g, all, form);
  g.attribute_of("role", "values", "0 solid, 1 soft, 2 inner");
  // ParaView's vertices want their numbers named.
  write_column(g, "index", "1", all,
               [&](const SnapshotParticle& p) { return static_cast<std::int64_t>(&p - all.data()); });
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
  BodyForm form = form_of(s);
  form.moves = s.has_velocity = g.has("velocity");
  form.weighed = g.has("mass");
  s.particles.resize(column_length(g, "id"));
  read_records(g, s.particles, form);
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
  std::vector<std::int64_t> pairs;
  std::vector<double> ends;
  BodyForm form = form_of(units);
  for (const SnapshotContact& c : contacts) {
    pairs.insert(pairs.end(), {c.i, c.j});
    ends.insert(ends.end(), {c.from[0], c.from[1], c.from[2], c.to[0], c.to[1], c.to[2]});
    form.shifted = form.shifted || c.shift != Vec3{};
  }
  g.write("pair", std::span<const std::int64_t>(pairs), {contacts.size(), 2});
  g.write("ends", std::span<const double>(ends), {2 * contacts.size(), 3});
  g.attribute_of("ends", "unit", units.length_unit);
  write_records(g, contacts, form);
  write_segments(g, segments);
}

std::vector<SnapshotContact> read_snapshot_contacts(const h5::Group& g, const SnapshotBodies& bodies,
                                                    const Snapshot& units) {
  const std::vector<std::int64_t> pairs = g.integers("pair");
  std::vector<SnapshotContact> contacts(pairs.size() / 2);
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
  BodyForm form = form_of(units);
  form.shifted = g.has("shift");
  read_records(g, contacts, form);
  return contacts;
}

void write_snapshot(const h5::Group& g, const Snapshot& s) {
  g.attribute("kind", static_cast<std::int64_t>(s.kind));
  g.attribute("kind_name", to_string(s.kind));
  write_attributes(g, s);
  write_particles(g.create("particles"), s);
  const h5::Group walls = g.create("walls");
  write_records(walls, s.walls, form_of(s));
  walls.attribute_of("shape", "values", "0 plane, 1 inside of a sphere");
  write_cell(g, s);
  if (s.has_contacts) write_snapshot_contacts(g.create("contacts"), s.contacts, s, s.contacts.size());
}

Snapshot read_snapshot(const h5::Group& g) {
  Snapshot s;
  const std::int64_t kind = g.integer("kind");
  if (kind < 0 || kind > static_cast<std::int64_t>(SnapshotKind::grain_box)) throw IoError("unknown kind of a state");
  s.kind = static_cast<SnapshotKind>(kind);
  read_attributes(g, s);
  if (s.dimension != 2 && s.dimension != 3)
    throw IoError(fmt::format("a state has {} dimensions; allowed: 2, 3", s.dimension));
  read_particles(g.open("particles"), s);
  const h5::Group walls = g.open("walls");
  s.walls.resize(column_length(walls, "shape"));
  read_records(walls, s.walls, form_of(s));
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
