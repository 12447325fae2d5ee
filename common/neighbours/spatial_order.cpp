#include "common/neighbours/spatial_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <tuple>

#include "common/core/parallel_tasks.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {

namespace {

/// Bits of a coordinate on the curve.
constexpr int kBits = 16;

struct Place {
  int size_class = 0;
  std::uint64_t curve = 0;
  Slot slot = 0;

  friend bool operator<(const Place& a, const Place& b) {
    if (a.size_class != b.size_class) return a.size_class < b.size_class;
    return a.curve != b.curve ? a.curve < b.curve : a.slot < b.slot;
  }
};

template <int D>
std::uint64_t morton(const Vec<D>& unit) {
  std::array<std::uint64_t, static_cast<std::size_t>(D)> whole;
  // A place that is no number lies at the start: whoever follows the motion will say so.
  for (int k = 0; k < D; ++k)
    whole[at(k)] = static_cast<std::uint64_t>(
        std::min(std::max(0.0, std::floor(unit[k] * (1 << kBits))), static_cast<double>((1 << kBits) - 1)));
  std::uint64_t code = 0;
  for (int bit = kBits - 1; bit >= 0; --bit)
    for (const std::uint64_t w : whole) code = code << 1 | (w >> bit & 1U);
  return code;
}

/// Coordinates of the first bodies in the cell (periodic axes) or in the box around them (open ones), 0 to 1.
template <int D>
std::vector<Vec<D>> unit_places(const System<D>& s, Slot bodies) {
  std::vector<Vec<D>> unit(at(bodies));
  in_pieces(unit.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) unit[u] = s.cell.fractional(s.particles.sphere[u].x);
  });
  for (int k = 0; k < D; ++k) {
    if (s.cell.periodic[static_cast<std::size_t>(k)]) {
      for (Vec<D>& u : unit) u[k] -= std::floor(u[k]);
      continue;
    }
    double low = unit.front()[k];
    double high = low;
    for (const Vec<D>& u : unit) {
      low = std::min(low, u[k]);
      high = std::max(high, u[k]);
    }
    for (Vec<D>& u : unit) u[k] = high > low ? (u[k] - low) / (high - low) : 0.0;
  }
  return unit;
}

template <class T>
void permute(std::vector<T>& values, const std::vector<Slot>& order) {
  if (values.empty()) return;
  std::vector<T> out(values);
  for (std::size_t k = 0; k < order.size(); ++k) out[k] = values[static_cast<std::size_t>(order[k])];
  values.swap(out);
}

/// A pair under its new names. They may put it under another law: one that asks which of two bodies is the soft one.
template <int D>
struct RenamedPair {
  Geometry geometry = Geometry::sphere_sphere;
  std::int32_t law = 0;
  Slot i = 0;
  Slot j = 0;
  std::int32_t image = 0;
  Stored<D> spring{};
  double memory = 0.0;
  Stored<D> roll{};

  /// Orders pairs as in a list that has just been made.
  friend bool operator<(const RenamedPair& a, const RenamedPair& b) {
    return std::tie(a.geometry, a.law, a.i, a.j) < std::tie(b.geometry, b.law, b.i, b.j);
  }
};

bool memory_has_sides_under(const AnyLaw& any) {
  return std::visit([]<class Law>(const Law&) { return Law::traits.memory_has_sides; }, any);
}

/// The body with the smaller slot is i: where that changes, the pair is seen from the other side.
template <int D>
RenamedPair<D> renamed(const System<D>& s, const ContactSection& section, std::size_t c,
                       const std::vector<Slot>& slot_of) {
  const ContactList<D>& list = s.contacts;
  const auto name = [&](Slot slot) {
    return slot < static_cast<Slot>(slot_of.size()) ? slot_of[static_cast<std::size_t>(slot)] : slot;
  };
  RenamedPair<D> pair{section.geometry, section.law, name(list.i[c]), name(list.j[c]), list.image[c], {}, 0.0, {}};
  if (list.has_spring) pair.spring = list.spring[c];
  if (list.has_memory) pair.memory = list.memory[c];
  if (list.has_roll) pair.roll = list.roll[c];
  if (pair.i < pair.j) return pair;
  std::swap(pair.i, pair.j);
  pair.law = s.laws.index(s.particles.material[static_cast<std::size_t>(pair.i)],
                          s.particles.material[static_cast<std::size_t>(pair.j)]);
  if (pair.law == LawSet::kNoContact) throw std::logic_error("two materials have a contact law in one order alone");
  pair.image = image_count<D>() - 1 - pair.image;
  pair.spring = -pair.spring;
  pair.roll = -pair.roll;
  if (memory_has_sides_under(s.laws.law(pair.law))) pair.memory = -pair.memory;
  return pair;
}

/// One section per geometry and law.
template <int D>
void list_pairs(ContactList<D>& list, const std::vector<RenamedPair<D>>& pairs) {
  list.sections.clear();
  for (std::size_t c = 0; c < pairs.size(); ++c) {
    const RenamedPair<D>& pair = pairs[c];
    const auto at = static_cast<std::int32_t>(c);
    const bool goes_on = !list.sections.empty() && list.sections.back().geometry == pair.geometry &&
                         list.sections.back().law == pair.law;
    if (!goes_on) list.sections.push_back({at, at, pair.geometry, pair.law});
    list.sections.back().end = at + 1;
    list.i[c] = pair.i;
    list.j[c] = pair.j;
    list.image[c] = pair.image;
  }
}

/// The particles have their new names already.
template <int D>
void rename_pairs(System<D>& s, const std::vector<Slot>& order) {
  ContactList<D>& list = s.contacts;
  std::vector<Slot> slot_of(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) slot_of[static_cast<std::size_t>(order[k])] = static_cast<Slot>(k);
  std::vector<RenamedPair<D>> pairs;
  pairs.reserve(list.i.size());
  for (const ContactSection& section : list.sections)
    for (std::int32_t c = section.begin; c < section.end; ++c)
      pairs.push_back(renamed(s, section, static_cast<std::size_t>(c), slot_of));
  std::sort(pairs.begin(), pairs.end());
  list_pairs(list, pairs);
  adopt_list(s);
  for (std::size_t c = 0; c < pairs.size(); ++c) {
    if (list.has_spring) list.spring[c] = pairs[c].spring;
    if (list.has_memory) list.memory[c] = pairs[c].memory;
    if (list.has_roll) list.roll[c] = pairs[c].roll;
  }
}

}  // namespace

template <int D>
std::vector<Slot> spatial_order(const System<D>& s) {
  const auto& p = s.particles;
  std::vector<Slot> order;
  if (p.grains == 0) return order;
  double smallest = p.sphere[0].r;
  for (Slot i = 1; i < p.grains; ++i) smallest = std::min(smallest, p.sphere[static_cast<std::size_t>(i)].r);
  const std::vector<Vec<D>> unit = unit_places(s, p.grains);
  std::vector<Place> places;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    places.push_back({size_class(p.sphere[u].r, smallest), morton<D>(unit[u]), i});
  }
  std::sort(places.begin(), places.end());
  for (const Place& place : places) order.push_back(place.slot);
  return order;
}

template <int D>
std::vector<std::uint16_t> curve_parts(const System<D>& s) {
  constexpr int kPartBits = 12;
  static_assert(kCurveParts == std::size_t{1} << kPartBits && kPartBits % D == 0);
  std::vector<std::uint16_t> parts(at(s.particles.first_plane()));
  if (parts.empty()) return parts;
  const std::vector<Vec<D>> unit = unit_places(s, s.particles.first_plane());
  in_pieces(unit.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u)
      parts[u] = static_cast<std::uint16_t>(morton<D>(unit[u]) >> (kBits * D - kPartBits));
  });
  return parts;
}

template <int D>
void reorder_grains(System<D>& s, const std::vector<Slot>& order) {
  auto& p = s.particles;
  if (p.id.empty()) {
    p.id.resize(order.size());
    std::iota(p.id.begin(), p.id.end(), 0);
  }
  permute(p.id, order);
  permute(p.sphere, order);
  permute(p.velocity, order);
  permute(p.spin, order);
  permute(p.force, order);
  permute(p.torque, order);
  permute(p.inverse_mass, order);
  permute(p.inverse_inertia, order);
  permute(p.material, order);
  permute(p.shell, order);
  permute(p.largest_volume, order);
  permute(s.neighbours.reference, order);
  permute(s.neighbours.skin, order);
  if (!s.neighbours.reference.empty()) rename_pairs(s, order);
}

template <int D>
void restore_order(System<D>& s) {
  if (s.particles.id.empty()) return;
  reorder_grains(s, slots_by_id(s.particles));
  s.particles.id.clear();
}

template <int D>
std::vector<Slot> slots_by_id(const Particles<D>& p) {
  std::vector<Slot> slots(static_cast<std::size_t>(p.grains));
  std::iota(slots.begin(), slots.end(), 0);
  for (std::size_t u = 0; u < p.id.size(); ++u) slots[static_cast<std::size_t>(p.id[u])] = static_cast<Slot>(u);
  return slots;
}

template std::vector<Slot> spatial_order<2>(const System<2>&);
template std::vector<Slot> spatial_order<3>(const System<3>&);
template std::vector<std::uint16_t> curve_parts<2>(const System<2>&);
template std::vector<std::uint16_t> curve_parts<3>(const System<3>&);
template void reorder_grains<2>(System<2>&, const std::vector<Slot>&);
template void reorder_grains<3>(System<3>&, const std::vector<Slot>&);
template void restore_order<2>(System<2>&);
template void restore_order<3>(System<3>&);
template std::vector<Slot> slots_by_id<2>(const Particles<2>&);
template std::vector<Slot> slots_by_id<3>(const Particles<3>&);

}  // namespace softgrain
