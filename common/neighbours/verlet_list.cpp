#include "common/neighbours/verlet_list.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/core/text.h"
#include "common/neighbours/hierarchical_grid.h"
#include "common/neighbours/skin.h"

namespace softgrain {

namespace {

/// Pairs of one geometry on their way into the list, sorted by i, then j. Those without a law stay behind.
struct FoundPair {
  Slot i = 0;
  Slot j = 0;
  std::int32_t image = 0;
  std::int32_t law = 0;
};

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
  return std::visit([&](const auto& l) { return softgrain::onset_of(l, bodies); }, s.laws.law(law));
}

/// Whether pairs under a law may overlap without touching, so that they enter the list late.
bool has_onset(const AnyLaw& any) {
  return std::visit([]<class Law>(const Law&) { return Law::traits.has_onset; }, any);
}

/// Margins of the search: a pair's is the sum of both, so that whatever may come within reach is found.
template <int D>
std::vector<double> search_margins(const System<D>& s) {
  std::vector<double> margin = s.neighbours.skin;
  const double more = half_reach(s.laws);
  if (more > 0.0)
    for (double& m : margin) m += more;
  return margin;
}

template <int D>
std::vector<FoundPair> grain_pairs(const System<D>& s) {
  const auto& p = s.particles;
  std::vector<bool> late;
  for (std::int32_t l = 0; l < s.laws.size(); ++l) late.push_back(has_onset(s.laws.law(l)));
  const auto candidates = candidate_pairs(p, s.cell, search_margins(s));
  const auto law_of = [&](const CandidatePair& c) {
    const std::size_t a = at(c.i);
    const std::size_t b = at(c.j);
    const std::int32_t law = s.laws.index(p.material[a], p.material[b]);
    if (law == LawSet::kNoContact || !late[at(law)]) return law;
    const double onset = onset_of(s, law, bodies_of(p, Geometry::sphere_sphere, c.i, c.j));
    const double reach = p.sphere[a].r + p.sphere[b].r - onset + s.neighbours.skin[a] + s.neighbours.skin[b];
    const bool far = norm2(p.sphere[a].x - p.sphere[b].x - s.cell.image_shift(c.image)) >= reach * reach;
    return far ? LawSet::kNoContact : law;
  };
  std::vector<FoundPair> out(candidates.size());
  in_pieces(out.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      out[k] = {candidates[k].i, candidates[k].j, candidates[k].image, law_of(candidates[k])};
  });
  return out;
}

/// A grain meets the shell it lives in, in its image near the grain, and, when that lives in another one, that too.
template <int D>
std::vector<FoundPair> shell_pairs(const System<D>& s) {
  const auto& p = s.particles;
  std::vector<FoundPair> out;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const std::size_t first = out.size();
    for (Slot shell = p.shell[a]; shell >= 0; shell = p.shell[static_cast<std::size_t>(shell)]) {
      const auto b = static_cast<std::size_t>(shell);
      const std::int32_t law = s.laws.index(p.material[a], p.material[b]);
      if (law == LawSet::kNoContact) continue;
      const int image = s.cell.image_near(p.sphere[a].x, p.sphere[b].x);
      const double gap =
          p.sphere[b].r - p.sphere[a].r - norm(p.sphere[a].x - p.sphere[b].x - s.cell.image_shift(image));
      if (gap < s.neighbours.skin[a] + s.neighbours.skin[b]) out.push_back({i, shell, image, law});
    }
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
              [](const FoundPair& x, const FoundPair& y) { return x.j < y.j; });
  }
  return out;
}

template <int D>
std::vector<FoundPair> plane_pairs(const System<D>& s) {
  const auto& p = s.particles;
  std::vector<FoundPair> out;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto a = static_cast<std::size_t>(i);
    for (Slot plane = p.first_plane(); plane < p.size(); ++plane) {
      const auto b = static_cast<std::size_t>(plane);
      const std::int32_t law = s.laws.index(p.material[a], p.material[b]);
      if (law == LawSet::kNoContact) continue;
      const double onset = onset_of(s, law, bodies_of(p, Geometry::sphere_plane, i, plane));
      const double gap = dot(p.sphere[a].x - p.sphere[b].x, p.normal_of(plane)) - p.sphere[a].r + onset;
      if (gap < s.neighbours.skin[a] + s.neighbours.skin[b]) out.push_back({i, plane, home_image<D>(), law});
    }
  }
  return out;
}

/// One section per law, in the order of the laws.
template <int D>
void append_sections(ContactList<D>& list, Geometry geometry, const std::vector<FoundPair>& pairs, std::int32_t laws) {
  // next[piece][law]: first how many of a law are in a piece, then where its next one goes.
  std::vector<std::vector<std::int32_t>> next(pieces_of(pairs.size()), std::vector<std::int32_t>(at(laws), 0));
  in_pieces(pairs.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (pairs[k].law != LawSet::kNoContact) ++next[begin / kPieceLength][at(pairs[k].law)];
  });
  auto all = static_cast<std::int32_t>(list.i.size());
  for (std::int32_t l = 0; l < laws; ++l) {
    const std::int32_t first = all;
    for (auto& of_piece : next) {
      const std::int32_t many = of_piece[at(l)];
      of_piece[at(l)] = all;
      all += many;
    }
    if (all > first) list.sections.push_back({first, all, geometry, l});
  }
  list.i.resize(at(all));
  list.j.resize(at(all));
  list.image.resize(at(all));
  in_pieces(pairs.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (pairs[k].law == LawSet::kNoContact) continue;
      const std::size_t c = at(next[begin / kPieceLength][at(pairs[k].law)]++);
      list.i[c] = pairs[k].i;
      list.j[c] = pairs[k].j;
      list.image[c] = pairs[k].image;
    }
  });
}

/// What must survive a rebuild.
template <int D>
struct OldHistory {
  std::vector<Slot> i;
  std::vector<Slot> j;
  std::vector<ContactSection> sections;
  std::vector<Stored<D>> spring;
  std::vector<double> memory;
  std::vector<Stored<D>> roll;
};

template <int D>
OldHistory<D> take_history(ContactList<D>& list) {
  OldHistory<D> old{std::move(list.i),      std::move(list.j),      std::move(list.sections),
                    std::move(list.spring), std::move(list.memory), std::move(list.roll)};
  list.i.clear();
  list.j.clear();
  list.image.clear();
  list.sections.clear();
  return old;
}

/// Both lists are sorted by bodies within a section: one walk along both finds the pairs from `begin` to `end` that
/// stayed.
template <int D>
void merge_history(const OldHistory<D>& old, const ContactSection& from, ContactList<D>& list, std::size_t begin,
                   std::size_t end) {
  const auto before = [&](std::size_t k, std::size_t c) {
    return old.i[k] != list.i[c] ? old.i[k] < list.i[c] : old.j[k] < list.j[c];
  };
  std::size_t a = at(from.begin);
  for (std::size_t left = at(from.end) - a; left > 0;) {  // the first that is not before the beginning
    const std::size_t half = left / 2;
    if (before(a + half, begin)) {
      a += half + 1;
      left -= half + 1;
    } else {
      left = half;
    }
  }
  for (std::size_t c = begin; c < end; ++c) {
    while (a < at(from.end) && before(a, c)) ++a;
    if (a == at(from.end)) return;
    if (old.i[a] != list.i[c] || old.j[a] != list.j[c]) continue;
    if (!old.spring.empty() && list.has_spring) list.spring[c] = old.spring[a];
    if (!old.memory.empty() && list.has_memory) list.memory[c] = old.memory[a];
    if (!old.roll.empty() && list.has_roll) list.roll[c] = old.roll[a];
  }
}

template <int D>
void restore_history(ContactList<D>& list, const OldHistory<D>& old) {
  for (const ContactSection& to : list.sections)
    for (const ContactSection& from : old.sections)
      if (from.geometry == to.geometry && from.law == to.law)
        in_pieces(at(to.end - to.begin), [&](std::size_t begin, std::size_t end) {
          merge_history(old, from, list, at(to.begin) + begin, at(to.begin) + end);
        });
}

template <int D>
void size_history(ContactList<D>& list, const LawSet& laws, std::size_t bodies) {
  bool sums = false;
  list.has_spring = list.has_memory = list.has_roll = false;
  for (std::int32_t l = 0; l < laws.size(); ++l)
    std::visit(
        [&]<class Law>(const Law&) {
          list.has_spring = list.has_spring || Law::traits.has_tangential;
          list.has_memory = list.has_memory || Law::traits.has_memory;
          list.has_roll = list.has_roll || has_roll_history<D>(Law::traits);
          sums = sums || Law::traits.needs_particle_pass;
        },
        laws.law(l));
  const std::size_t springs = list.has_spring ? list.i.size() : 0;
  const std::size_t memories = list.has_memory ? list.i.size() : 0;
  list.spring.assign(springs, Vec<D>{});
  list.spring_next.clear();
  list.memory.assign(memories, 0.0);
  list.memory_next.clear();
  list.roll.assign(list.has_roll ? list.i.size() : 0, Vec<D>{});
  list.roll_next.clear();
  list.touched.assign(list.i.size(), 1);
  list.particle_sum.assign(sums ? bodies : 0, MultiContactSum<D>{});
  list.lost_i.resize(sums ? list.i.size() : 0);
  list.lost_j.resize(sums ? list.i.size() : 0);
}

template <int D>
void fill_constants(System<D>& s) {
  ContactList<D>& list = s.contacts;
  list.constants.resize(list.i.size());
  for (const ContactSection& section : list.sections)
    std::visit(
        [&](const auto& law) {
          in_pieces(at(section.end - section.begin), [&](std::size_t begin, std::size_t end) {
            for (std::size_t c = at(section.begin) + begin; c < at(section.begin) + end; ++c)
              list.constants[c] = law.pair_constants(bodies_of(s.particles, section.geometry, list.i[c], list.j[c]));
          });
        },
        s.laws.law(section.law));
}

/// Soft particles go with the first section that lists them.
template <int D>
void note_multi_contact_bodies(System<D>& s) {
  ContactList<D>& list = s.contacts;
  list.multi_contact_bodies.clear();
  if (list.particle_sum.empty()) return;
  std::vector<std::int32_t> law_of(list.particle_sum.size(), LawSet::kNoContact);
  const auto note = [&](Slot body, std::int32_t law) {
    if (law_of[at(body)] == LawSet::kNoContact) law_of[at(body)] = law;
  };
  for (const ContactSection& section : list.sections) {
    if (!traits_of(s.laws.law(section.law)).needs_particle_pass) continue;
    const SoftSides soft = soft_sides(s.laws.law(section.law));
    for (std::size_t c = at(section.begin); c < at(section.end); ++c) {
      if (soft.i) note(list.i[c], section.law);
      if (soft.j) note(list.j[c], section.law);
    }
  }
  for (std::int32_t law = 0; law < s.laws.size(); ++law)
    if (traits_of(s.laws.law(law)).needs_particle_pass)
      for (std::size_t u = 0; u < law_of.size(); ++u)
        if (law_of[u] == law) list.multi_contact_bodies.push_back({static_cast<Slot>(u), law});
}

/// Radii from the origin beyond which a grain is lost: its overlap with a neighbour would be no number of 53 bits.
constexpr double kFarthest = 0x1p45;

template <int D>
[[noreturn]] void lose(const Particles<D>& p, Slot i) {
  double farthest = 0.0;
  for (const double x : p.sphere[static_cast<std::size_t>(i)].x.v) {
    if (!std::isfinite(x)) throw UnusableResult("body " + std::to_string(i) + " has a position that is not finite");
    farthest = std::max(farthest, std::abs(x));
  }
  std::ostringstream what;
  what << (i < p.grains ? grain_name(p, i) : "body " + std::to_string(i)) << " is lost: it is " << farthest
       << " m away";
  throw UnusableResult(what.str());
}

template <int D>
void require_valid(const Particles<D>& p, const Cell<D>& cell, Slot begin, Slot end) {
  for (Slot i = begin; i < end; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const double distance2 = norm2(p.sphere[u].x);
    if (!std::isfinite(distance2)) lose(p, i);
    if (i >= p.grains) continue;
    if (distance2 > kFarthest * kFarthest * p.sphere[u].r * p.sphere[u].r) lose(p, i);
    for (Slot k = p.shell[u]; k >= 0; k = p.shell[static_cast<std::size_t>(k)]) {
      const Sphere<D>& shell = p.sphere[static_cast<std::size_t>(k)];
      const Vec<D> image = cell.image_shift(cell.image_near(p.sphere[u].x, shell.x));
      const double outside = norm(p.sphere[u].x - shell.x - image) - p.sphere[u].r - shell.r;
      if (outside <= 0.0) continue;
      throw UnusableResult(grain_name(p, i) + " (radius " + rounded_text(p.sphere[u].r) +
                           " m) has been squeezed out of its shell (radius " + rounded_text(shell.r) +
                           " m): " + rounded_text(outside) + " m lie between them");
    }
  }
}

template <int D>
void require_valid(const Particles<D>& p, const Cell<D>& cell) {
  in_pieces(at(p.size()), [&](std::size_t begin, std::size_t end) {
    require_valid(p, cell, static_cast<Slot>(begin), static_cast<Slot>(end));
  });
}

/// Edge c loses whole edges r until its component along axis r is within half an edge: another basis of the same
/// lattice. At once: a cell that is sheared out of all proportion has no end of edges to lose.
template <int D>
void reduce_tilt(Cell<D>& cell, int r, int c) {
  const double tilt = cell.edges[r][c] / cell.edges[r][r];
  if (!(std::abs(tilt) > 0.5000001)) return;
  const double whole = std::round(tilt);
  for (int k = 0; k <= r; ++k) cell.edges[k][c] -= whole * cell.edges[k][r];
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
  in_pieces(at(p.first_plane()), [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      const Vec<D> frac = s.cell.fractional(p.sphere[u].x);
      Vec<D> back;
      for (int k = 0; k < D; ++k)
        if (s.cell.periodic[static_cast<std::size_t>(k)]) back[k] = std::floor(frac[k]);
      if (back == Vec<D>{}) continue;
      const Vec<D> shift = s.cell.edges * back;
      p.sphere[u].x -= shift;
      p.velocity[u] -= s.cell.velocity_gradient * shift;
    }
  });
}

}  // namespace

template <int D>
void adopt_list(System<D>& s) {
  fill_constants(s);
  size_history(s.contacts, s.laws, static_cast<std::size_t>(s.particles.size()));
  note_multi_contact_bodies(s);
  note_skin(s);
  static std::atomic<std::uint64_t> builds{0};
  s.contacts.build = ++builds;
}

template <int D>
void rebuild_neighbours(System<D>& s) {
  require_valid(s.particles, s.cell);
  NeighbourState<D>& n = s.neighbours;
  if (n.skin.size() != static_cast<std::size_t>(s.particles.size())) n.skin = default_skin(s.particles);
  adapt_skin(s);
  wrap(s);
  fit_skin_to_cell(s);
  const OldHistory<D> old = take_history(s.contacts);
  append_sections(s.contacts, Geometry::sphere_sphere, grain_pairs(s), s.laws.size());
  append_sections(s.contacts, Geometry::sphere_shell, shell_pairs(s), s.laws.size());
  append_sections(s.contacts, Geometry::sphere_plane, plane_pairs(s), s.laws.size());
  adopt_list(s);
  restore_history(s.contacts, old);
  n.reference.resize(static_cast<std::size_t>(s.particles.size()));
  in_pieces(n.reference.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) n.reference[u] = s.particles.sphere[u].x;
  });
  n.reference_edges = s.cell.edges;
  if (n.rebuilds > 1 && s.cost.loop_passes - n.passes_at_build <= 1) ++n.short_lived;
  n.passes_at_build = s.cost.loop_passes;
  ++n.rebuilds;
}

template <int D>
bool update_neighbours(System<D>& system) {
  if (skin_used(system) <= 1.0) return false;
  rebuild_neighbours(system);
  return true;
}

template void adopt_list<2>(System<2>&);
template void adopt_list<3>(System<3>&);
template void rebuild_neighbours<2>(System<2>&);
template void rebuild_neighbours<3>(System<3>&);
template bool update_neighbours<2>(System<2>&);
template bool update_neighbours<3>(System<3>&);

}  // namespace softgrain
