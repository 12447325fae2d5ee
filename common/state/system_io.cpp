#include "common/state/system_io.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/error.h"
#include "common/data/attributes.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {

namespace {

using Count = std::int64_t;

template <class V>
std::vector<double> flat(const std::vector<V>& vectors) {
  std::vector<double> out;
  out.reserve(vectors.size() * V{}.v.size());
  for (const V& v : vectors) out.insert(out.end(), v.v.begin(), v.v.end());
  return out;
}

template <class V>
void write_vectors(const h5::Group& g, const std::string& name, const std::vector<V>& vectors) {
  g.write(name, flat(vectors), {vectors.size(), V{}.v.size()});
}

void write_slots(const h5::Group& g, const std::string& name, const std::vector<std::int32_t>& values) {
  g.write(name, std::vector<Count>(values.begin(), values.end()));
}

[[noreturn]] void damaged(const std::string& name) {
  throw IoError("saved state: '" + name + "' does not fit the rest of the file");
}

std::vector<double> read_numbers(const h5::Group& g, const std::string& name, std::size_t size) {
  std::vector<double> values = g.doubles(name);
  if (values.size() != size) damaged(name);
  return values;
}

template <int N, class V = Vec<N>>
std::vector<V> read_vectors(const h5::Group& g, const std::string& name, std::size_t size) {
  const std::vector<double> values = read_numbers(g, name, size * N);
  std::vector<V> out(size);
  for (std::size_t u = 0; u < size; ++u)
    for (std::size_t k = 0; k < N; ++k) out[u].v[k] = values[u * N + k];
  return out;
}

/// Indices within [low, high).
std::vector<std::int32_t> read_slots(const h5::Group& g, const std::string& name, std::size_t size, Count low,
                                     Count high) {
  const std::vector<Count> values = g.integers(name);
  if (values.size() != size) damaged(name);
  std::vector<std::int32_t> out;
  out.reserve(size);
  for (const Count v : values) {
    if (v < low || v >= high) damaged(name);
    out.push_back(static_cast<std::int32_t>(v));
  }
  return out;
}

template <int D>
void write_bodies(const h5::Group& g, const Particles<D>& p) {
  std::vector<Vec<D + 1>> spheres(p.sphere.size());
  for (std::size_t u = 0; u < spheres.size(); ++u) {
    for (int k = 0; k < D; ++k) spheres[u][k] = p.sphere[u].x[k];
    spheres[u][D] = p.sphere[u].r;
  }
  g.write("counts", std::vector<Count>{p.grains, p.shells, p.planes});
  write_vectors(g, "sphere", spheres);
  write_vectors(g, "velocity", p.velocity);
  write_vectors(g, "spin", p.spin);
  write_vectors(g, "force", p.force);
  write_vectors(g, "torque", p.torque);
  g.write("inverse_mass", p.inverse_mass);
  g.write("inverse_inertia", p.inverse_inertia);
  write_slots(g, "material", p.material);
  write_slots(g, "shell", p.shell);
  write_slots(g, "id", p.id);
  write_vectors(g, "plane_normal", p.plane_normal);
  g.write("plane_load", p.plane_load);
  if (!p.largest_volume.empty()) g.write("largest_volume", p.largest_volume);
}

template <int D>
void read_counts(const h5::Group& g, Particles<D>& p) {
  const std::vector<std::int32_t> counts = read_slots(g, "counts", 3, 0, Count{1} << 28);
  p.grains = counts[0];
  p.shells = counts[1];
  p.planes = counts[2];
}

/// Empty, or every number below `grains` once.
std::vector<std::int32_t> read_ids(const h5::Group& g, std::int32_t grains) {
  const std::size_t many = g.integers("id").size();
  if (many == 0) return {};
  std::vector<std::int32_t> id = read_slots(g, "id", static_cast<std::size_t>(grains), 0, grains);
  std::vector<bool> seen(id.size());
  for (const std::int32_t k : id) seen[static_cast<std::size_t>(k)] = true;
  if (std::find(seen.begin(), seen.end(), false) != seen.end()) damaged("id");
  return id;
}

/// Lengths that the neighbour search can work with; what a run saved always is.
constexpr double kLeastLength = 1e-30;
constexpr double kMostLength = 1e30;

bool is_length(double x) { return x >= kLeastLength && x <= kMostLength; }

template <int D>
void require_places(const Particles<D>& p) {
  for (Slot k = 0; k < p.size(); ++k) {
    const Sphere<D>& sphere = p.sphere[static_cast<std::size_t>(k)];
    for (const double x : sphere.x.v)
      if (!(std::abs(x) <= kMostLength)) damaged("sphere");
    if (k < p.first_plane() && !is_length(sphere.r)) damaged("sphere");
  }
}

/// A grain lies in a shell or in none; a shell that lies in itself, by whatever way round, would be followed for ever.
template <int D>
void require_shells(const Particles<D>& p) {
  for (const std::int32_t first : p.shell) {
    Slot k = first;
    for (Slot depth = 0; k >= 0; ++depth) {
      if (k < p.grains || k >= p.first_plane() || depth > p.shells) damaged("shell");
      k = p.shell[static_cast<std::size_t>(k)];
    }
  }
}

template <int D>
void read_bodies(const h5::Group& g, Particles<D>& p, Count materials) {
  constexpr int kTurns = static_cast<int>(sizeof(Rot<D>) / sizeof(double));
  read_counts(g, p);
  const auto n = static_cast<std::size_t>(p.size());
  const auto spheres = read_vectors<D + 1>(g, "sphere", n);
  p.sphere.resize(n);
  for (std::size_t u = 0; u < n; ++u) {
    for (int k = 0; k < D; ++k) p.sphere[u].x[k] = spheres[u][k];
    p.sphere[u].r = spheres[u][D];
  }
  require_places(p);
  p.velocity = read_vectors<D, Stored<D>>(g, "velocity", n);
  p.spin = read_vectors<kTurns, Stored<kTurns>>(g, "spin", n);
  p.force = read_vectors<D, Stored<D>>(g, "force", n);
  p.torque = read_vectors<kTurns, Stored<kTurns>>(g, "torque", n);
  p.inverse_mass = read_numbers(g, "inverse_mass", n);
  p.inverse_inertia = read_numbers(g, "inverse_inertia", n);
  p.material = read_slots(g, "material", n, 0, materials);
  p.shell = read_slots(g, "shell", n, -1, p.size());
  require_shells(p);
  p.id = read_ids(g, p.grains);
  p.plane_normal = read_vectors<D>(g, "plane_normal", static_cast<std::size_t>(p.planes));
  p.plane_load = read_numbers(g, "plane_load", static_cast<std::size_t>(p.planes));
  p.largest_volume = g.has("largest_volume") ? read_numbers(g, "largest_volume", n) : std::vector<double>{};
  const auto is_volume = [](double volume) { return volume >= 0.0 && volume <= kMostLength; };
  if (!std::all_of(p.largest_volume.begin(), p.largest_volume.end(), is_volume)) damaged("largest_volume");
}

template <int D>
std::vector<Vec<D>> rows(const Matrix<D>& m) {
  return {m.row.begin(), m.row.end()};
}

template <int D>
Matrix<D> read_matrix(const h5::Group& g, const std::string& name) {
  const auto values = read_vectors<D>(g, name, D);
  Matrix<D> m;
  for (std::size_t k = 0; k < D; ++k) m.row[k] = values[k];
  return m;
}

template <int D>
void write_cell(const h5::Group& g, const Cell<D>& cell) {
  write_vectors(g, "edges", rows(cell.edges));
  write_vectors(g, "velocity_gradient", rows(cell.velocity_gradient));
  g.write("periodic", std::vector<Count>(cell.periodic.begin(), cell.periodic.end()));
}

template <int D>
void read_cell(const h5::Group& g, Cell<D>& cell) {
  cell.edges = read_matrix<D>(g, "edges");
  for (int r = 0; r < D; ++r)
    for (int c = 0; c < D; ++c)
      if (r == c ? !is_length(cell.edges[r][c]) : !(std::abs(cell.edges[r][c]) <= kMostLength)) damaged("edges");
  cell.velocity_gradient = read_matrix<D>(g, "velocity_gradient");
  const auto periodic = read_slots(g, "periodic", D, 0, 2);
  for (std::size_t k = 0; k < D; ++k) cell.periodic[k] = periodic[k] != 0;
}

void neighbour_counts(auto&& visit, auto& n) {
  visit("rebuilds", n.rebuilds);
  visit("passes_at_build", n.passes_at_build);
  visit("hasty", n.short_lived, kLater);
}

template <int D>
void write_neighbours(const h5::Group& g, const NeighbourState<D>& n) {
  write_vectors(g, "reference", n.reference);
  g.write("skin", n.skin);
  write_vectors(g, "reference_edges", rows(n.reference_edges));
  neighbour_counts(AttributeWriter{g}, n);
}

template <int D>
void read_neighbours(const h5::Group& g, NeighbourState<D>& n, std::size_t bodies) {
  const std::size_t listed = g.doubles("skin").size();  // none before the first build
  if (listed != 0 && listed != bodies) damaged("skin");
  n.reference = read_vectors<D>(g, "reference", listed);
  n.skin = read_numbers(g, "skin", listed);
  if (!std::all_of(n.skin.begin(), n.skin.end(), is_length)) damaged("skin");
  n.reference_edges = read_matrix<D>(g, "reference_edges");
  n.short_lived = 0;
  neighbour_counts(AttributeReader{g}, n);
}

template <int D>
void write_contacts(const h5::Group& g, const ContactList<D>& list) {
  write_slots(g, "i", list.i);
  write_slots(g, "j", list.j);
  write_slots(g, "image", list.image);
  std::vector<Count> sections;
  for (const ContactSection& s : list.sections)
    sections.insert(sections.end(), {s.begin, s.end, static_cast<Count>(s.geometry), s.law});
  g.write("sections", sections, {list.sections.size(), 4});
  write_vectors(g, "spring", list.spring);
  g.write("memory", list.memory);
  if (list.has_roll) write_vectors(g, "roll", list.roll);
}

void read_sections(const h5::Group& g, std::vector<ContactSection>& sections, Count pairs, Count laws) {
  const std::vector<Count> values = g.integers("sections");
  if (values.size() % 4 != 0) damaged("sections");
  Count end = 0;
  sections.clear();
  for (std::size_t k = 0; k < values.size(); k += 4) {
    const bool valid = values[k] == end && values[k + 1] > end && values[k + 2] >= 0 && values[k + 2] < 3 &&
                       values[k + 3] >= 0 && values[k + 3] < laws;
    if (!valid) damaged("sections");
    end = values[k + 1];
    sections.push_back({static_cast<std::int32_t>(values[k]), static_cast<std::int32_t>(end),
                        static_cast<Geometry>(values[k + 2]), static_cast<std::int32_t>(values[k + 3])});
  }
  if (end != pairs) damaged("sections");
}

/// The second body of every pair is of the kind that its section says.
template <int D>
void require_partners(const ContactList<D>& list, const Particles<D>& p) {
  for (const ContactSection& s : list.sections)
    for (auto c = static_cast<std::size_t>(s.begin); c < static_cast<std::size_t>(s.end); ++c) {
      const Slot j = list.j[c];
      const Geometry found = j < p.grains          ? Geometry::sphere_sphere
                             : j < p.first_plane() ? Geometry::sphere_shell
                                                   : Geometry::sphere_plane;
      if (found != s.geometry || list.i[c] == j) damaged("sections");
    }
}

template <int D>
void read_contacts(const h5::Group& g, System<D>& s) {
  ContactList<D>& list = s.contacts;
  const std::size_t pairs = g.integers("i").size();
  list.i = read_slots(g, "i", pairs, 0, s.particles.grains);
  list.j = read_slots(g, "j", pairs, 0, s.particles.size());
  list.image = read_slots(g, "image", pairs, 0, image_count<D>());
  read_sections(g, list.sections, list.size(), s.laws.size());
  require_partners(list, s.particles);
  adopt_list(s);
  list.spring = read_vectors<D, Stored<D>>(g, "spring", list.has_spring ? pairs : 0);
  list.memory = read_numbers(g, "memory", list.has_memory ? pairs : 0);
  if (list.has_roll) list.roll = read_vectors<D, Stored<D>>(g, "roll", pairs);
}

void clock_and_counters(auto&& visit, auto& s) {
  visit("time", s.time);
  visit("step", s.step);
  visit("loop_passes", s.cost.loop_passes);
  visit("contact_evaluations", s.cost.contact_evaluations);
  visit("seconds", s.cost.seconds);
}

}  // namespace

template <int D>
void write_system(const h5::Group& group, const System<D>& s) {
  write_bodies(group.create("bodies"), s.particles);
  write_cell(group.create("cell"), s.cell);
  write_neighbours(group.create("neighbours"), s.neighbours);
  write_contacts(group.create("contacts"), s.contacts);
  write_vectors(group, "gravity", std::vector<Vec<D>>{s.gravity});
  group.attribute("dimension", Count{D});
  clock_and_counters(AttributeWriter{group}, s);
}

template <int D>
void read_system(const h5::Group& group, System<D>& s) {
  if (group.integer("dimension") != D) damaged("dimension");
  read_bodies(group.open("bodies"), s.particles, s.laws.materials());
  read_cell(group.open("cell"), s.cell);
  read_neighbours(group.open("neighbours"), s.neighbours, static_cast<std::size_t>(s.particles.size()));
  read_contacts(group.open("contacts"), s);
  s.gravity = read_vectors<D>(group, "gravity", 1).front();
  clock_and_counters(AttributeReader{group}, s);
}

template void write_system<2>(const h5::Group&, const System<2>&);
template void write_system<3>(const h5::Group&, const System<3>&);
template void read_system<2>(const h5::Group&, System<2>&);
template void read_system<3>(const h5::Group&, System<3>&);

}  // namespace softgrain
