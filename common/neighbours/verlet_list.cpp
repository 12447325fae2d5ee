#include "common/neighbours/verlet_list.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include "common/core/error.h"
#include "common/neighbours/hierarchical_grid.h"

namespace softgrain {

namespace {

/// A pair on its way into the list. The key sorts by geometry, law, i, j.
struct ListedPair {
  std::uint64_t key = 0;
  Slot i = 0;
  Slot j = 0;
  std::int32_t image = 0;
};

constexpr std::uint64_t kSlotBits = 28;

std::uint64_t body_key(Slot i, Slot j) {
  return (static_cast<std::uint64_t>(i) << kSlotBits) | static_cast<std::uint64_t>(j);
}

ListedPair listed(Geometry geometry, std::int32_t law, Slot i, Slot j, std::int32_t image) {
  const std::uint64_t head = (static_cast<std::uint64_t>(geometry) << 6) | static_cast<std::uint64_t>(law);
  return {(head << (2 * kSlotBits)) | body_key(i, j), i, j, image};
}

template <int D>
PairBodies bodies_of(const Particles<D>& p, Geometry geometry, Slot i, Slot j) {
  const auto a = static_cast<std::size_t>(i);
  const auto b = static_cast<std::size_t>(j);
  double rj = p.sphere[b].r;
  if (geometry == Geometry::sphere_shell) rj = -rj;
  if (geometry == Geometry::sphere_plane) rj = 0.0;
  return {p.sphere[a].r, rj, p.inverse_mass[a], p.inverse_mass[b]};
}

template <int D>
double onset_of(const System<D>& s, std::int32_t law, const PairBodies& bodies) {
  return std::visit([&](const auto& l) { return l.onset(bodies); }, s.laws.law(law));
}

template <int D>
void list_grain_pairs(const System<D>& s, std::vector<ListedPair>& out) {
  const auto& p = s.particles;
  for (const CandidatePair& c : candidate_pairs(p, s.cell, s.neighbours.skin)) {
    const auto a = static_cast<std::size_t>(c.i);
    const auto b = static_cast<std::size_t>(c.j);
    const std::int32_t law = s.laws.index(p.material[a], p.material[b]);
    if (law == LawSet::kNoContact) continue;
    const double onset = onset_of(s, law, bodies_of(p, Geometry::sphere_sphere, c.i, c.j));
    if (onset > 0.0) {
      const double reach = p.sphere[a].r + p.sphere[b].r - onset + s.neighbours.skin[a] + s.neighbours.skin[b];
      if (norm2(p.sphere[a].x - p.sphere[b].x - s.cell.image_shift(c.image)) >= reach * reach) continue;
    }
    out.push_back(listed(Geometry::sphere_sphere, law, c.i, c.j, c.image));
  }
}

template <int D>
void list_shells(const System<D>& s, std::vector<ListedPair>& out) {
  const auto& p = s.particles;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const Slot shell = p.shell[a];
    if (shell < 0) continue;
    const auto b = static_cast<std::size_t>(shell);
    const std::int32_t law = s.laws.index(p.material[a], p.material[b]);
    if (law == LawSet::kNoContact) continue;
    const double gap = p.sphere[b].r - p.sphere[a].r - norm(p.sphere[a].x - p.sphere[b].x);
    if (gap < s.neighbours.skin[a] + s.neighbours.skin[b])
      out.push_back(listed(Geometry::sphere_shell, law, i, shell, home_image<D>()));
  }
}

template <int D>
void list_planes(const System<D>& s, std::vector<ListedPair>& out) {
  const auto& p = s.particles;
  for (Slot plane = p.first_plane(); plane < p.size(); ++plane) {
    const auto b = static_cast<std::size_t>(plane);
    const Vec<D>& n = p.normal_of(plane);
    for (Slot i = 0; i < p.grains; ++i) {
      const auto a = static_cast<std::size_t>(i);
      const std::int32_t law = s.laws.index(p.material[a], p.material[b]);
      if (law == LawSet::kNoContact) continue;
      const double onset = onset_of(s, law, bodies_of(p, Geometry::sphere_plane, i, plane));
      const double gap = dot(p.sphere[a].x - p.sphere[b].x, n) - p.sphere[a].r + onset;
      if (gap < s.neighbours.skin[a] + s.neighbours.skin[b])
        out.push_back(listed(Geometry::sphere_plane, law, i, plane, home_image<D>()));
    }
  }
}

/// History that must survive: sorted by bodies alone, as image and section may change.
template <int D>
struct SavedHistory {
  std::uint64_t key = 0;
  Vec<D> spring{};
  double memory = 0.0;
};

template <int D>
std::vector<SavedHistory<D>> save_history(const ContactList<D>& list) {
  std::vector<SavedHistory<D>> out;
  for (std::int32_t c = 0; c < list.size(); ++c) {
    const auto u = static_cast<std::size_t>(c);
    SavedHistory<D> h{body_key(list.i[u], list.j[u]), list.has_spring ? list.spring[u] : Vec<D>{},
                      list.has_memory ? list.memory[u] : 0.0};
    if (h.memory != 0.0 || h.spring != Vec<D>{}) out.push_back(h);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  return out;
}

template <int D>
void restore_history(ContactList<D>& list, const std::vector<SavedHistory<D>>& saved) {
  for (std::size_t c = 0; c < list.i.size(); ++c) {
    const std::uint64_t key = body_key(list.i[c], list.j[c]);
    const auto found =
        std::lower_bound(saved.begin(), saved.end(), key, [](const auto& h, std::uint64_t k) { return h.key < k; });
    if (found == saved.end() || found->key != key) continue;
    if (list.has_spring) list.spring[c] = found->spring;
    if (list.has_memory) list.memory[c] = found->memory;
  }
}

template <int D>
void size_history(ContactList<D>& list, const LawSet& laws, std::size_t bodies) {
  bool sums = false;
  list.has_spring = list.has_memory = false;
  for (std::int32_t l = 0; l < laws.size(); ++l)
    std::visit(
        [&]<class Law>(const Law&) {
          list.has_spring = list.has_spring || Law::has_tangential;
          list.has_memory = list.has_memory || Law::has_memory;
          sums = sums || Law::needs_particle_pass;
        },
        laws.law(l));
  const std::size_t springs = list.has_spring ? list.i.size() : 0;
  const std::size_t memories = list.has_memory ? list.i.size() : 0;
  list.spring.assign(springs, Vec<D>{});
  list.spring_next.assign(springs, Vec<D>{});
  list.memory.assign(memories, 0.0);
  list.memory_next.assign(memories, 0.0);
  list.particle_sum.assign(sums ? bodies : 0, 0.0);
}

template <int D>
void fill_list(System<D>& s, const std::vector<ListedPair>& pairs) {
  ContactList<D>& list = s.contacts;
  list.i.clear();
  list.j.clear();
  list.image.clear();
  list.sections.clear();
  for (const ListedPair& pair : pairs) {
    const auto head = static_cast<std::int32_t>(pair.key >> (2 * kSlotBits));
    const auto geometry = static_cast<Geometry>(head >> 6);
    const std::int32_t law = head & 63;
    if (list.sections.empty() || list.sections.back().geometry != geometry || list.sections.back().law != law)
      list.sections.push_back({list.size(), list.size(), geometry, law});
    list.i.push_back(pair.i);
    list.j.push_back(pair.j);
    list.image.push_back(pair.image);
    list.sections.back().end = list.size();
  }
}

template <int D>
void fill_constants(System<D>& s) {
  ContactList<D>& list = s.contacts;
  list.constants.resize(list.i.size());
  for (const ContactSection& section : list.sections)
    std::visit(
        [&](const auto& law) {
          for (auto c = static_cast<std::size_t>(section.begin); c < static_cast<std::size_t>(section.end); ++c)
            list.constants[c] = law.pair_constants(bodies_of(s.particles, section.geometry, list.i[c], list.j[c]));
        },
        s.laws.law(section.law));
}

template <int D>
void require_sound(const Particles<D>& p) {
  for (Slot i = 0; i < p.size(); ++i) {
    const auto u = static_cast<std::size_t>(i);
    if (!std::isfinite(norm2(p.sphere[u].x)))
      throw NotUsable("body " + std::to_string(i) + " has a position that is not finite");
    if (i >= p.grains || p.shell[u] < 0) continue;
    const Sphere<D>& shell = p.sphere[static_cast<std::size_t>(p.shell[u])];
    if (norm(p.sphere[u].x - shell.x) - p.sphere[u].r > shell.r)
      throw NotUsable("grain " + std::to_string(i) + " (radius " + std::to_string(p.sphere[u].r) +
                      " m) has been squeezed out of its shell");
  }
}

/// Edge c loses whole edges r until its component along axis r is within half an edge: another basis of the same
/// lattice.
template <int D>
void reduce_tilt(Cell<D>& cell, int r, int c) {
  while (std::abs(cell.edges[r][c]) > 0.5000001 * cell.edges[r][r]) {
    const double sign = std::copysign(1.0, cell.edges[r][c]);
    for (int k = 0; k <= r; ++k) cell.edges[k][c] -= sign * cell.edges[k][r];
  }
}

/// Brings positions home into a periodic cell; a body that crosses a moving boundary takes the velocity of its new
/// image.
template <int D>
void wrap(System<D>& s) {
  if (!s.cell.any_periodic()) return;
  // A strongly sheared cell is replaced by the equivalent one with the least tilt.
  for (int c = 1; c < D; ++c)
    for (int r = c - 1; r >= 0; --r)
      if (s.cell.periodic[static_cast<std::size_t>(r)] && s.cell.periodic[static_cast<std::size_t>(c)])
        reduce_tilt(s.cell, r, c);
  auto& p = s.particles;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const Vec<D> frac = s.cell.fractional(p.sphere[u].x);
    Vec<D> back;
    for (int k = 0; k < D; ++k)
      if (s.cell.periodic[static_cast<std::size_t>(k)]) back[k] = std::floor(frac[k]);
    if (back == Vec<D>{}) continue;
    const Vec<D> shift = s.cell.edges * back;
    p.sphere[u].x -= shift;
    p.velocity[u] -= s.cell.velocity_gradient * shift;
  }
}

/// How far an image of a neighbour has moved because the cell deformed.
template <int D>
double image_drift(const System<D>& s) {
  if (!s.cell.any_periodic() || s.cell.velocity_gradient == Matrix<D>{}) return 0.0;
  double sum = 0.0;
  for (int r = 0; r < D; ++r)
    for (int c = 0; c < D; ++c) sum += std::abs(s.cell.edges[r][c] - s.neighbours.reference_edges[r][c]);
  return sum;
}

template <int D>
bool list_is_stale(const System<D>& s) {
  const auto& p = s.particles;
  const auto& n = s.neighbours;
  if (n.reference.size() != static_cast<std::size_t>(p.size())) return true;
  const double drift = 0.5 * image_drift(s);
  for (std::size_t u = 0; u < n.reference.size(); ++u) {
    const double allowed = n.skin[u] - drift;
    // Written so that NaN counts as moved.
    if (!(allowed > 0.0) || !(norm2(p.sphere[u].x - n.reference[u]) <= allowed * allowed)) return true;
  }
  return false;
}

}  // namespace

template <int D>
std::vector<double> default_skin(const Particles<D>& p) {
  double smallest = 0.0;
  for (Slot i = 0; i < p.grains; ++i) {
    const double r = p.sphere[static_cast<std::size_t>(i)].r;
    smallest = i == 0 ? r : std::min(smallest, r);
  }
  std::vector<double> skin(static_cast<std::size_t>(p.size()), 0.0);
  double largest = 0.0;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    skin[u] = std::min(0.125 * p.sphere[u].r, 0.5 * smallest);
    largest = std::max(largest, skin[u]);
  }
  for (auto u = static_cast<std::size_t>(p.grains); u < skin.size(); ++u) skin[u] = largest;
  return skin;
}

template <int D>
void adopt_list(System<D>& s) {
  fill_constants(s);
  size_history(s.contacts, s.laws, static_cast<std::size_t>(s.particles.size()));
  static std::atomic<std::uint64_t> builds{0};
  s.contacts.build = ++builds;
}

template <int D>
void rebuild_neighbours(System<D>& s) {
  require_sound(s.particles);
  wrap(s);
  NeighbourState<D>& n = s.neighbours;
  if (n.skin.size() != static_cast<std::size_t>(s.particles.size())) n.skin = default_skin(s.particles);
  const auto saved = save_history(s.contacts);
  std::vector<ListedPair> pairs;
  list_grain_pairs(s, pairs);
  list_shells(s, pairs);
  list_planes(s, pairs);
  std::sort(pairs.begin(), pairs.end(), [](const ListedPair& a, const ListedPair& b) { return a.key < b.key; });
  fill_list(s, pairs);
  adopt_list(s);
  restore_history(s.contacts, saved);
  n.reference.resize(static_cast<std::size_t>(s.particles.size()));
  for (std::size_t u = 0; u < n.reference.size(); ++u) n.reference[u] = s.particles.sphere[u].x;
  n.reference_edges = s.cell.edges;
  ++n.rebuilds;
}

template <int D>
bool update_neighbours(System<D>& system) {
  if (!list_is_stale(system)) return false;
  rebuild_neighbours(system);
  return true;
}

template std::vector<double> default_skin<2>(const Particles<2>&);
template std::vector<double> default_skin<3>(const Particles<3>&);
template void adopt_list<2>(System<2>&);
template void adopt_list<3>(System<3>&);
template void rebuild_neighbours<2>(System<2>&);
template void rebuild_neighbours<3>(System<3>&);
template bool update_neighbours<2>(System<2>&);
template bool update_neighbours<3>(System<3>&);

}  // namespace softgrain
