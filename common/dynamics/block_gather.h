// The first half of the vectorised loop: which pairs of a block touch, and all that a law asks for in rows. For
// block_loop.cpp and particle_pass.cpp alone.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "common/dynamics/block_kernels.h"
#include "common/dynamics/block_loop.h"

namespace softgrain::block {

/// One per thread: clearing 80 kB in every pass is work that small systems need not do.
template <int D>
Block<D>& scratch() {
  thread_local Block<D> block{};
  return block;
}

/// Pairs that a loop goes over: those of the list, or copies of pairs of another thread (ForeignPairs).
enum class PairSource { list, foreign };

/// Finds the touching pairs of a block and brings all that a law asks for into rows. kTraits: what laws of this kind
/// ask for.
template <int D, LawTraits kTraits, Geometry kGeometry, bool kPeriodic, PairSource kSource>
class Gatherer {
 public:
  Gatherer(System<D>& s, const Kernel<D>& kernel, const PairRange& range, const BlockPass<D>& pass)
      : s_(s), list_(s.contacts), kernel_(kernel), range_(range), pass_(pass), images_(s.cell) {}

 protected:
  static constexpr bool kForeign = kSource == PairSource::foreign;
  static constexpr bool kSumsUp =
      kTraits.is_multi_contact && !kTraits.has_tangential;  ///< the first half of a particle pass

  static std::size_t u(std::int32_t k) { return static_cast<std::size_t>(k); }

  // What is known of pairs, by their places in the list or numbers among the foreign ones.
  [[nodiscard]] const std::vector<Slot>& first_bodies() const {
    if constexpr (kForeign)
      return pass_.foreign->i;
    else
      return list_.i;
  }
  [[nodiscard]] const std::vector<Slot>& second_bodies() const {
    if constexpr (kForeign)
      return pass_.foreign->j;
    else
      return list_.j;
  }
  [[nodiscard]] const std::int32_t* images() const {
    if constexpr (kForeign)
      return pass_.foreign->image.data();
    else
      return list_.image.data();
  }
  [[nodiscard]] const PairConstants* constants() const {
    if constexpr (kForeign)
      return pass_.foreign->constants.data();
    else
      return list_.constants.data();
  }
  /// Histories.
  [[nodiscard]] const auto& histories() const {
    if constexpr (kForeign)
      return *pass_.foreign;
    else
      return list_;
  }
  /// Place in the list.
  [[nodiscard]] std::size_t place_of(std::size_t c) const {
    if constexpr (kForeign)
      return u(pass_.foreign->place[c]);
    else
      return c;
  }

  // Arrays are taken by local pointers in all loops: otherwise every store makes the compiler load them again.

  static Quad dot(const std::array<Quad, 4>& a, const std::array<Quad, 4>& b) {
    Quad sum = a[0] * b[0];
    for (std::size_t axis = 1; axis < D; ++axis) sum += a[axis] * b[axis];
    return sum;
  }

  /// One bit for each of four pairs that is apart: what is not a number is not, and makes a force that is none, as in
  /// the scalar loop. `t`: branch and the fourth number in columns; `upright`: normals of planes.
  [[gnu::always_inline]] int apart(const std::array<Quad, 4>& t, std::array<Quad, 4> upright) const {
    if constexpr (kGeometry == Geometry::sphere_sphere) {
      Quad touch = t[3];
      if constexpr (kTraits.acts_at_distance) touch += kernel_.reach;
      return sign_bits(dot(t, t) >= touch * touch);
    } else if constexpr (kGeometry == Geometry::sphere_shell) {
      return sign_bits(t[3] > 0.0) & sign_bits(dot(t, t) <= t[3] * t[3]);
    } else {
      transpose(upright[0], upright[1], upright[2], upright[3]);
      return sign_bits(t[3] - dot(t, upright) <= 0.0);
    }
  }

  /// Branch vector and the fourth number of every pair, and which touch. No branch depends on that: about one pair in
  /// three does, which no processor can guess.
  // NOLINTNEXTLINE(readability-function-size): one hot loop
  [[gnu::always_inline]] void find_touching(std::int32_t begin, std::int32_t end) {
    const Slot* const first = first_bodies().data();
    const Slot* const second = second_bodies().data();
    const Sphere<D>* const spheres = s_.particles.sphere.data();
    [[maybe_unused]] const std::int32_t* const image = images();
    const auto branch_of = [&](std::int32_t c) {
      const Quad a = place(spheres[u(first[c])]);
      const Quad b = place(spheres[u(second[c])]);
      Quad d = a - b;
      if constexpr (kPeriodic) d -= images_.shift[u(image[c])];
      if constexpr (kGeometry == Geometry::sphere_sphere) return with_fourth(d, a + b);
      return with_fourth(d, kGeometry == Geometry::sphere_shell ? b - a : a);
    };
    [[maybe_unused]] const Vec<D>* const normals = s_.particles.plane_normal.data();
    [[maybe_unused]] const Slot first_plane = s_.particles.first_plane();
    const auto upright_of = [&](std::int32_t c) {
      const Vec<D>& n = normals[second[u(c)] - first_plane];
      if constexpr (D == 3)
        return Quad{n[0], n[1], n[2], 0.0};
      else
        return Quad{n[0], n[1], 0.0, 0.0};
    };
    Quad* const record = block_.record.data();
    [[maybe_unused]] Quad* const upright = block_.upright_record.data();
    std::int32_t* const pair = block_.pair.data();
    int n = 0;
    for (std::int32_t k = begin; k < end; k += 4) {
      const int valid = std::min(end - k, 4);
      std::array<Quad, 4> d;
      std::array<Quad, 4> normal{};
      std::array<std::int32_t, 4> c;
      for (int l = 0; l < 4; ++l) {
        c[u(l)] = std::min(k + l, end - 1);
        d[u(l)] = branch_of(c[u(l)]);
        if constexpr (kGeometry == Geometry::sphere_plane) normal[u(l)] = upright_of(c[u(l)]);
      }
      std::array<Quad, 4> t = d;
      transpose(t[0], t[1], t[2], t[3]);
      const int here = (1 << valid) - 1;
      const int touch = ~apart(t, normal) & here;
      for (int l = 0; l < 4; ++l) {
        record[n] = d[u(l)];
        pair[n] = c[u(l)];
        if constexpr (kGeometry == Geometry::sphere_plane) upright[n] = normal[u(l)];
        n += touch >> l & 1;
      }
      if (far_) fetch_ahead(c);
      if constexpr (kTraits.has_tangential && !kForeign) note_touch(c, here, touch);
    }
    block_.touching = n;
    for (int pad = n; n > 0 && pad < n + 8; ++pad) {  // lanes without a contact repeat the last one
      record[pad] = record[n - 1];
      pair[pad] = pair[n - 1];
      if constexpr (kGeometry == Geometry::sphere_plane) upright[pad] = upright[n - 1];
    }
  }

  /// Bodies from which on their records no longer stay in the caches near the core: 100,000 grains take 100 instead of
  /// 140 ns a step. At 20,000 nothing was gained that could be told from the noise.
  static constexpr std::size_t kFar = 30000;

  /// Asks for what is about to be needed of four pairs: the place of a body a few groups later, and what `gather` and
  /// the sums of forces read once the block is looked through. First bodies come in order and need no asking.
  [[gnu::always_inline]] void fetch_ahead(const std::array<std::int32_t, 4>& c) const {
    constexpr std::size_t kLater = 32;
    const auto& p = s_.particles;
    const Slot* const second = second_bodies().data();
    const std::size_t last = second_bodies().size() - 1;
    for (std::size_t l = 0; l < 4; ++l) {
      const std::size_t place = u(c[l]);
      const std::size_t j = u(second[place]);
      __builtin_prefetch(&p.sphere[u(second[std::min(place + kLater, last)])]);
      if constexpr (!kSumsUp) __builtin_prefetch(&p.force[j], 1);
      if constexpr (kTraits.needs_velocity) __builtin_prefetch(&p.velocity[j]);
      if constexpr (kTraits.has_tangential) {
        __builtin_prefetch(&p.spin[j]);
        __builtin_prefetch(&p.torque[j], 1);
      }
      if constexpr (kTraits.needs_particle_pass || kSumsUp)
        if (kernel_.sums.j) {
          __builtin_prefetch(&list_.particle_sum[j], kSumsUp ? 1 : 0);
          if constexpr (kTraits.directions_in_sums)
            __builtin_prefetch(&list_.particle_sum[j].second[1], kSumsUp ? 1 : 0);
        }
    }
    if constexpr (kForeign) return;
    const std::size_t place = u(c[0]);
    __builtin_prefetch(&list_.constants[place]);
    if constexpr (kTraits.has_tangential) {
      __builtin_prefetch(&list_.spring[place], 1);
      __builtin_prefetch(&list_.spring[u(c[3])], 1);
    }
  }

  /// A contact that has opened forgets its history. `here`: one bit for each of the four that is looked at.
  [[gnu::always_inline]] void note_touch(const std::array<std::int32_t, 4>& c, int here, int touch) {
    if (pass_.history == History::none) return;
    if (pass_.history == History::next) {
      for (int l = 0; l < 4; ++l)
        if (((here & ~touch) >> l & 1) != 0) forget(list_.spring_next, list_.memory_next, list_.roll_next, u(c[u(l)]));
      return;
    }
    std::uint8_t* const touched = list_.touched.data();
    if (here == 15) {  // four flags in one word, which seldom changes
      std::uint32_t old = 0;
      std::memcpy(&old, touched + c[0], sizeof old);
      const std::uint32_t now = kFlags[u(touch)];
      if (old == now) return;
      std::memcpy(touched + c[0], &now, sizeof now);
      for (int l = 0; l < 4; ++l)
        if ((old & ~now) >> (8 * l) & 1U) forget(list_.spring, list_.memory, list_.roll, u(c[u(l)]));
      return;
    }
    for (int l = 0; l < 4; ++l) {
      if ((here >> l & 1) == 0) continue;
      const std::size_t place = u(c[u(l)]);
      const bool now = (touch >> l & 1) != 0;
      if (touched[place] != 0 && !now) forget(list_.spring, list_.memory, list_.roll, place);
      touched[place] = static_cast<std::uint8_t>(now);
    }
  }

  static constexpr bool kRolls = has_roll_history<D>(kTraits);

  static void forget(std::vector<Stored<D>>& spring, std::vector<double>& memory, std::vector<Stored<D>>& roll,
                     std::size_t c) {
    spring[c] = {};
    if constexpr (kTraits.has_memory) memory[c] = 0.0;
    if constexpr (kRolls) roll[c] = {};
  }

  /// Gathers records into rows, four contacts at a time.
  [[gnu::always_inline]] void gather() {
    const auto& p = s_.particles;
    const Slot* const first = first_bodies().data();
    const Slot* const second = second_bodies().data();
    const Sphere<D>* const spheres = p.sphere.data();
    const MultiContactSum<D>* const sums = list_.particle_sum.data();
    const Stored<D>* const velocities = p.velocity.data();
    const StoredRot<D>* const spins = p.spin.data();
    const auto& history = histories();
    const Stored<D>* const springs = history.spring.data();
    [[maybe_unused]] const std::int32_t* const image = images();
    const PairConstants* const all_constants = constants();
    for (int g = 0; g < block_.touching; g += 4) {
      std::array<Quad, 4> branch, motion, spin_i, spin_j, spring, normal, roll;
      [[maybe_unused]] std::array<const MultiContactSum<D>*, 4> sum_i, sum_j;
      for (std::size_t l = 0; l < 4; ++l) {
        const std::size_t c = u(block_.pair[u(g) + l]);
        const std::size_t i = u(first[c]);
        const std::size_t j = u(second[c]);
        branch[l] = block_.record[u(g) + l];
        block_.a.v[u(g) + l] = all_constants[c].a;
        if constexpr (kTraits.needs_velocity || kTraits.is_multi_contact) block_.b.v[u(g) + l] = all_constants[c].b;
        if constexpr (kTraits.needs_velocity) {
          motion[l] = quad_of(velocities[i]) - quad_of(velocities[j]);
          if constexpr (kPeriodic) motion[l] -= images_.velocity[u(image[c])];
        }
        if constexpr (kTraits.has_tangential) {
          spin_i[l] = with_fourth(quad_of(spins[i]), place(spheres[i]));
          spin_j[l] = with_fourth(quad_of(spins[j]), place(spheres[j]));
          spring[l] = quad_of(springs[c]);
        }
        if constexpr (kRolls) roll[l] = quad_of(history.roll[c]);
        if constexpr (kSumsUp) {
          block_.radius_i.v[u(g) + l] = spheres[i].r;
          block_.radius_j.v[u(g) + l] = spheres[j].r;
        }
        if constexpr (kTraits.has_memory) block_.memory.v[u(g) + l] = history.memory[c];
        if constexpr (kTraits.needs_particle_pass) {
          sum_i[l] = &sums[i];
          sum_j[l] = &sums[j];
          if (kernel_.sums.i) block_.lost_i.v[u(g) + l] = list_.lost_i[place_of(c)];
          if (kernel_.sums.j) block_.lost_j.v[u(g) + l] = list_.lost_j[place_of(c)];
        }
        if constexpr (kGeometry == Geometry::sphere_plane) normal[l] = block_.upright_record[u(g) + l];
      }
      transpose(branch[0], branch[1], branch[2], branch[3]);
      store_rows<D>(block_.branch, g, branch);
      store_quad(block_.fourth.v + g, branch[3]);
      if constexpr (kGeometry == Geometry::sphere_plane) {
        transpose(normal[0], normal[1], normal[2], normal[3]);
        store_rows<D>(block_.upright, g, normal);
      }
      if constexpr (kTraits.needs_velocity) {
        transpose(motion[0], motion[1], motion[2], motion[3]);
        store_rows<D>(block_.velocity, g, motion);
      }
      if constexpr (kTraits.has_tangential) {
        transpose(spin_i[0], spin_i[1], spin_i[2], spin_i[3]);
        transpose(spin_j[0], spin_j[1], spin_j[2], spin_j[3]);
        store_rows<kRot<D>>(block_.spin_i, g, spin_i);
        store_rows<kRot<D>>(block_.spin_j, g, spin_j);
        store_quad(block_.radius_i.v + g, spin_i[3]);
        store_quad(block_.radius_j.v + g, spin_j[3]);
        transpose(spring[0], spring[1], spring[2], spring[3]);
        store_rows<D>(block_.spring, g, spring);
      }
      if constexpr (kTraits.needs_particle_pass) {
        if (kernel_.sums.i) gather_sums(block_.sum_i, g, sum_i);
        if (kernel_.sums.j) gather_sums(block_.sum_j, g, sum_j);
      }
      if constexpr (kRolls) {
        transpose(roll[0], roll[1], roll[2], roll[3]);
        store_rows<D>(block_.roll, g, roll);
      }
    }
  }

  /// Four sums become columns of the rows, see MultiContactSum.
  static void gather_sums(SumRows<D>& rows, int g, const std::array<const MultiContactSum<D>*, 4>& sums) {
    static_assert(D != 3 || offsetof(MultiContactSum<3>, second) == 7 * sizeof(double));
    std::array<Quad, 4> numbers;
    const auto columns = [&](int group, const std::array<Row*, 4>& to) {
      for (std::size_t l = 0; l < 4; ++l)
        numbers[l] = load_quad(reinterpret_cast<const double*>(sums[l]) + 4 * group);  // NOLINT: in groups of four
      transpose(numbers[0], numbers[1], numbers[2], numbers[3]);
      for (std::size_t k = 0; k < 4; ++k)
        if (to[k] != nullptr) store_quad(to[k]->v + g, numbers[k]);
    };
    columns(0, {&rows.volume, &rows.gain, &rows.gain_slope, nullptr});
    if constexpr (kTraits.directions_in_sums) {
      columns(1, {rows.first.data(), &rows.first[1], &rows.first[2], rows.second.data()});
      columns(2, {&rows.second[1], &rows.second[2], &rows.second[3], &rows.second[4]});
      for (std::size_t l = 0; l < 4; ++l) rows.second[5].v[u(g) + l] = sums[l]->second[5];
    }
  }

  System<D>& s_;
  ContactList<D>& list_;
  const Kernel<D> kernel_;
  const PairRange range_;
  const BlockPass<D> pass_;
  const Images<D, kPeriodic> images_;
  Block<D>& block_ = scratch<D>();
  const bool far_ = s_.particles.sphere.size() >= kFar;
};

/// Opens law and geometry of a section for those that this number of dimensions knows.
template <int D, class Work>
void open(const System<D>& s, const ContactSection& section, Work&& work) {
  std::visit(
      [&]<class Law>(const Law& law) {
        using G = Geometry;
        if constexpr (!law_serves<Law, D>())
          throw std::logic_error("a law for another number of dimensions");
        else if (section.geometry == G::sphere_sphere)
          work(law, std::integral_constant<G, G::sphere_sphere>{});
        else if (section.geometry == G::sphere_shell)
          work(law, std::integral_constant<G, G::sphere_shell>{});
        else
          work(law, std::integral_constant<G, G::sphere_plane>{});
      },
      s.laws.law(section.law));
}

}  // namespace softgrain::block
