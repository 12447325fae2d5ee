#include "common/state/system_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "common/core/error.h"
#include "common/data/attributes.h"
#include "common/data/rows.h"
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

[[noreturn]] void damaged(const h5::Group& g, const std::string& name) {
  g.refuse(name, "saved state: '" + name + "' does not fit the rest of the file");
}

std::vector<double> read_numbers(const h5::Group& g, const std::string& name, std::size_t size) {
  std::vector<double> values = g.doubles(name);
  if (values.size() != size) damaged(g, name);
  if (!std::ranges::all_of(values, [](double x) { return std::isfinite(x); }))
    g.refuse(name, "saved state: '" + name + "' holds a number that is not finite");
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
  if (values.size() != size) damaged(g, name);
  std::vector<std::int32_t> out;
  out.reserve(size);
  for (const Count v : values) {
    if (v < low || v >= high) damaged(g, name);
    out.push_back(static_cast<std::int32_t>(v));
  }
  return out;
}

/// Size of the list of ids: that of the grains, or none where ids equal slots.
struct Ids {
  std::int32_t grains = 0;
};

/// Size of an array that some systems have.
struct SomeHave {
  std::size_t size = 0;
};

/// Writes the arrays of a state; what says how they are read back follows them.
struct StateWriter {
  const h5::Group& g;

  void operator()(const std::string& name, const std::vector<double>& values, const auto&...) const {
    g.write(name, values);
  }
  void operator()(const std::string& name, const std::vector<double>& values, const SomeHave&) const {
    if (!values.empty()) g.write(name, values);
  }
  void operator()(const std::string& name, const std::vector<std::int32_t>& values, const auto&...) const {
    write_slots(g, name, values);
  }
  template <int D>
  void operator()(const std::string& name, const std::vector<Sphere<D>>& values, const auto&...) const {
    std::vector<Vec<D + 1>> spheres(values.size());
    for (std::size_t u = 0; u < spheres.size(); ++u) {
      for (int k = 0; k < D; ++k) spheres[u][k] = values[u].x[k];
      spheres[u][D] = values[u].r;
    }
    write_vectors(g, name, spheres);
  }
  template <class V>
  requires requires(V one) { one.v; }
  void operator()(const std::string& name, const std::vector<V>& values, const auto&...) const {
    write_vectors(g, name, values);
  }
  template <int D>
  void operator()(const std::string& name, const Matrix<D>& matrix) const {
    write_vectors(g, name, std::vector<Vec<D>>{matrix.row.begin(), matrix.row.end()});
  }
  template <std::size_t kLength>
  void operator()(const std::string& name, const std::array<bool, kLength>& flags) const {
    g.write(name, std::vector<Count>(flags.begin(), flags.end()));
  }
};

/// The arrays of bodies, in the order of the file: how many there are of each, and within which limits indices lie.
template <int D>
void body_arrays(auto&& visit, auto& p, Count materials) {
  const auto bodies = static_cast<std::size_t>(p.size());
  const auto planes = static_cast<std::size_t>(p.planes);
  visit("sphere", p.sphere, bodies);
  visit("velocity", p.velocity, bodies);
  visit("spin", p.spin, bodies);
  visit("force", p.force, bodies);
  visit("torque", p.torque, bodies);
  visit("inverse_mass", p.inverse_mass, bodies);
  visit("inverse_inertia", p.inverse_inertia, bodies);
  visit("material", p.material, bodies, Count{0}, materials);
  visit("shell", p.shell, bodies, Count{-1}, Count{p.size()});
  visit("id", p.id, Ids{p.grains});
  visit("plane_normal", p.plane_normal, planes);
  visit("plane_load", p.plane_load, planes);
  visit("largest_volume", p.largest_volume, SomeHave{bodies});
}

template <int D>
void write_bodies(const h5::Group& g, const Particles<D>& p) {
  g.write("counts", std::vector<Count>{p.grains, p.shells, p.planes});
  body_arrays<D>(StateWriter{g}, p, 0);
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
  if (std::find(seen.begin(), seen.end(), false) != seen.end()) damaged(g, "id");
  return id;
}

/// Lengths that the neighbour search can work with; what a run saved always is.
constexpr double kLeastLength = 1e-30;
constexpr double kMostLength = 1e30;

bool is_length(double x) { return x >= kLeastLength && x <= kMostLength; }

template <int D>
void require_places(const h5::Group& g, const Particles<D>& p) {
  for (Slot k = 0; k < p.size(); ++k) {
    const Sphere<D>& sphere = p.sphere[static_cast<std::size_t>(k)];
    for (const double x : sphere.x.v)
      if (!(std::abs(x) <= kMostLength)) damaged(g, "sphere");
    if (k < p.first_plane() && !is_length(sphere.r)) damaged(g, "sphere");
  }
}

/// A grain lies in a shell or in none; a shell that lies in itself, by whatever way round, would be followed for ever.
template <int D>
void require_shells(const h5::Group& g, const Particles<D>& p) {
  for (const std::int32_t first : p.shell) {
    Slot k = first;
    for (Slot depth = 0; k >= 0; ++depth) {
      if (k < p.grains || k >= p.first_plane() || depth > p.shells) damaged(g, "shell");
      k = p.shell[static_cast<std::size_t>(k)];
    }
  }
}

/// Reads them into members of the right length. Throws IoError.
struct StateReader {
  const h5::Group& g;

  void operator()(const std::string& name, std::vector<double>& values, std::size_t size) const {
    values = read_numbers(g, name, size);
  }
  void operator()(const std::string& name, std::vector<double>& values, const SomeHave& some) const {
    values = g.has(name) ? read_numbers(g, name, some.size) : std::vector<double>{};
  }
  void operator()(const std::string& name, std::vector<std::int32_t>& values, std::size_t size, Count low,
                  Count high) const {
    values = read_slots(g, name, size, low, high);
  }
  void operator()(const std::string&, std::vector<std::int32_t>& values, const Ids& ids) const {
    values = read_ids(g, ids.grains);
  }
  template <int D>
  void operator()(const std::string& name, std::vector<Sphere<D>>& values, std::size_t size) const {
    const auto spheres = read_vectors<D + 1>(g, name, size);
    values.resize(size);
    for (std::size_t u = 0; u < size; ++u) {
      for (int k = 0; k < D; ++k) values[u].x[k] = spheres[u][k];
      values[u].r = spheres[u][D];
    }
  }
  template <class V>
  requires requires(V one) { one.v; }
  void operator()(const std::string& name, std::vector<V>& values, std::size_t size) const {
    values = read_vectors<static_cast<int>(std::tuple_size_v<decltype(V{}.v)>), V>(g, name, size);
  }
  template <int D>
  void operator()(const std::string& name, Matrix<D>& matrix) const {
    const auto rows = read_vectors<D>(g, name, D);
    std::copy(rows.begin(), rows.end(), matrix.row.begin());
  }
  template <std::size_t kLength>
  void operator()(const std::string& name, std::array<bool, kLength>& flags) const {
    const auto values = read_slots(g, name, kLength, 0, 2);
    for (std::size_t k = 0; k < kLength; ++k) flags[k] = values[k] != 0;
  }
};

template <int D>
void read_bodies(const h5::Group& g, Particles<D>& p, Count materials) {
  read_counts(g, p);
  body_arrays<D>(StateReader{g}, p, materials);
  require_places(g, p);
  require_shells(g, p);
  const auto is_volume = [](double volume) { return volume >= 0.0 && volume <= kMostLength; };
  if (!std::all_of(p.largest_volume.begin(), p.largest_volume.end(), is_volume)) damaged(g, "largest_volume");
}

void cell_parts(auto&& visit, auto& cell) {
  visit("edges", cell.edges);
  visit("velocity_gradient", cell.velocity_gradient);
  visit("periodic", cell.periodic);
}

template <int D>
void read_cell(const h5::Group& g, Cell<D>& cell) {
  cell_parts(StateReader{g}, cell);
  for (int r = 0; r < D; ++r)
    for (int c = 0; c < D; ++c)
      if (r == c ? !is_length(cell.edges[r][c]) : !(std::abs(cell.edges[r][c]) <= kMostLength)) damaged(g, "edges");
}

void neighbour_counts(auto&& visit, auto& n) {
  visit("rebuilds", n.rebuilds);
  visit("passes_at_build", n.passes_at_build);
  visit("hasty", n.short_lived, kLater);
}

/// What the list was built with; nothing before the first build.
void build_arrays(auto&& visit, auto& n, std::size_t listed) {
  visit("reference", n.reference, listed);
  visit("skin", n.skin, listed);
  visit("reference_edges", n.reference_edges);
}

template <int D>
void write_neighbours(const h5::Group& g, const NeighbourState<D>& n) {
  build_arrays(StateWriter{g}, n, n.skin.size());
  neighbour_counts(AttributeWriter{g}, n);
}

template <int D>
void read_neighbours(const h5::Group& g, NeighbourState<D>& n, std::size_t bodies) {
  const std::size_t listed = g.doubles("skin").size();
  if (listed != 0 && listed != bodies) damaged(g, "skin");
  build_arrays(StateReader{g}, n, listed);
  if (!std::all_of(n.skin.begin(), n.skin.end(), is_length)) damaged(g, "skin");
  n.short_lived = 0;
  neighbour_counts(AttributeReader{g}, n);
}

/// The pairs, with the limits of their indices.
template <int D>
void pair_arrays(auto&& visit, auto& list, std::size_t pairs, const Particles<D>& p) {
  visit("i", list.i, pairs, Count{0}, Count{p.grains});
  visit("j", list.j, pairs, Count{0}, Count{p.size()});
  visit("image", list.image, pairs, Count{0}, Count{image_count<D>()});
}

constexpr auto kSection = [](auto&& visit, auto& s) {
  visit(s.begin);
  visit(s.end);
  visit(s.geometry);
  visit(s.law);
};

/// The history of the pairs, as far as laws have one.
void history_arrays(auto&& visit, auto& list) {
  const auto pairs = static_cast<std::size_t>(list.size());
  visit("spring", list.spring, list.has_spring ? pairs : 0);
  visit("memory", list.memory, list.has_memory ? pairs : 0);
  if (list.has_roll) visit("roll", list.roll, pairs);
}

template <int D>
void write_contacts(const h5::Group& g, const ContactList<D>& list, const Particles<D>& p) {
  pair_arrays(StateWriter{g}, list, list.i.size(), p);
  write_rows(g, "sections", list.sections, kSection);
  history_arrays(StateWriter{g}, list);
}

void read_sections(const h5::Group& g, std::vector<ContactSection>& sections, Count pairs, Count laws) {
  sections = records_in_rows<ContactSection>(g, "sections", kSection);
  Count end = 0;
  for (const ContactSection& s : sections) {
    const auto geometry = static_cast<Count>(s.geometry);
    if (s.begin != end || s.end <= end || geometry < 0 || geometry > 2 || s.law < 0 || s.law >= laws)
      damaged(g, "sections");
    end = s.end;
  }
  if (end != pairs) damaged(g, "sections");
}

/// The second body of every pair is of the kind that its section says.
template <int D>
void require_partners(const h5::Group& g, const ContactList<D>& list, const Particles<D>& p) {
  for (const ContactSection& s : list.sections)
    for (auto c = static_cast<std::size_t>(s.begin); c < static_cast<std::size_t>(s.end); ++c) {
      const Slot j = list.j[c];
      const Geometry found = j < p.grains          ? Geometry::sphere_sphere
                             : j < p.first_plane() ? Geometry::sphere_shell
                                                   : Geometry::sphere_plane;
      if (found != s.geometry || list.i[c] == j) damaged(g, "sections");
    }
}

template <int D>
void read_contacts(const h5::Group& g, System<D>& s) {
  ContactList<D>& list = s.contacts;
  pair_arrays(StateReader{g}, list, g.integers("i").size(), s.particles);
  read_sections(g, list.sections, list.size(), s.laws.size());
  require_partners(g, list, s.particles);
  adopt_list(s);
  history_arrays(StateReader{g}, list);
}

void clock_and_counters(auto&& visit, auto& s) {
  visit("time", s.time, Limits{});
  visit("step", s.step);
  visit("loop_passes", s.cost.loop_passes);
  visit("contact_evaluations", s.cost.contact_evaluations);
  visit("seconds", s.cost.seconds, Limits::not_negative());
}

}  // namespace

template <int D>
void write_system(const h5::Group& group, const System<D>& s) {
  write_bodies(group.create("bodies"), s.particles);
  cell_parts(StateWriter{group.create("cell")}, s.cell);
  write_neighbours(group.create("neighbours"), s.neighbours);
  write_contacts(group.create("contacts"), s.contacts, s.particles);
  write_vectors(group, "gravity", std::vector<Vec<D>>{s.gravity});
  group.attribute("dimension", Count{D});
  clock_and_counters(AttributeWriter{group}, s);
}

template <int D>
void read_system(const h5::Group& group, System<D>& s) {
  if (group.integer("dimension") != D) damaged(group, "dimension");
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
