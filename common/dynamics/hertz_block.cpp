#include "common/dynamics/hertz_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "common/dynamics/hertz_lanes.h"

namespace softgrain {

namespace {

using namespace hertz;

/// Where results go.
struct Target {
  History history = History::next;
  ContactLoad* loads = nullptr;  ///< null: to the bodies
  std::uint8_t* touches = nullptr;
  WaitingLoads* waiting = nullptr;
};

template <int D, class Law, bool kPeriodic, bool kOrdered>
class Loop {
 public:
  Loop(System<D>& s, const Law& law, double dt, const PairRange& range, const Target& target)
      : s_(s), list_(s.contacts), law_(law), dt_(dt), range_(range), target_(target), images_(s.cell) {}

  void run() {
    for (std::int32_t k = range_.begin; k < range_.end; k += kBlock) {
      find_touching(k, std::min(k + kBlock, range_.end));
      if (block_.touching == 0) continue;
      gather();
      for (int g = 0; g < block_.touching; g += kLanes) evaluate(g);
      if (target_.loads != nullptr)
        put_down();
      else
        scatter();
    }
  }

 private:
  /// One per thread: clearing 45 kB in every pass is work that small systems need not do.
  static Block<D>& scratch() {
    thread_local Block<D> block{};
    return block;
  }

  static std::size_t u(std::int32_t k) { return static_cast<std::size_t>(k); }

  /// Place in the list of number k of the range.
  [[nodiscard]] std::int32_t place_of(std::int32_t k) const {
    if constexpr (kOrdered)
      return range_.order[k];
    else
      return k;
  }

  // Arrays are taken by local pointers in all loops: otherwise every store makes the compiler load them again.

  /// Branch vector and sum of radii; square of the distance against the square of the sum decides. No branch depends on
  /// whether a pair touches: about one in three does, which no processor can guess.
  void find_touching(std::int32_t begin, std::int32_t end) {  // NOLINT(readability-function-size): one hot loop
    const Slot* const first = list_.i.data();
    const Slot* const second = list_.j.data();
    const Sphere<D>* const spheres = s_.particles.sphere.data();
    const auto branch_of = [&](std::int32_t c) {
      const Quad a = place(spheres[u(first[c])]);
      const Quad b = place(spheres[u(second[c])]);
      Quad d = a - b;
      if constexpr (kPeriodic) d -= images_.shift[u(list_.image[u(c)])];
      return with_fourth(d, a + b);
    };
    Quad* const record = block_.record.data();
    std::int32_t* const pair = block_.pair.data();
    [[maybe_unused]] std::int32_t* const number = block_.number.data();
    int n = 0;
    for (std::int32_t k = begin; k < end; k += 4) {
      const int valid = std::min(end - k, 4);
      std::array<Quad, 4> d;
      std::array<std::int32_t, 4> c;
      for (int l = 0; l < 4; ++l) {
        c[u(l)] = place_of(std::min(k + l, end - 1));
        d[u(l)] = branch_of(c[u(l)]);
      }
      std::array<Quad, 4> t = d;
      transpose(t[0], t[1], t[2], t[3]);
      Quad distance2 = t[0] * t[0];
      for (std::size_t axis = 1; axis < D; ++axis) distance2 += t[axis] * t[axis];
      // Apart is what is known to be: a distance that is not a number makes a force that is none, as in the scalar
      // loop.
      const int touch = ~sign_bits(distance2 >= t[3] * t[3]) & ((1 << valid) - 1);
      for (int l = 0; l < 4; ++l) {
        record[n] = d[u(l)];
        pair[n] = c[u(l)];
        if constexpr (kOrdered) number[n] = k + l;
        n += touch >> l & 1;
      }
      if constexpr (Law::has_tangential) note_touch(c, valid, touch);
      if constexpr (kOrdered)
        if (target_.touches != nullptr)
          for (int l = 0; l < valid; ++l) target_.touches[k + l] = static_cast<std::uint8_t>(touch >> l & 1);
    }
    block_.touching = n;
    for (int pad = n; n > 0 && pad < n + 8; ++pad) {  // lanes without a contact repeat the last one
      record[pad] = record[n - 1];
      pair[pad] = pair[n - 1];
    }
  }

  /// A contact that has opened forgets its history.
  void note_touch(const std::array<std::int32_t, 4>& c, int valid, int touch) {
    if (target_.history == History::none) return;
    if (target_.history == History::next) {
      for (int l = 0; l < valid; ++l)
        if ((touch >> l & 1) == 0) forget(list_.spring_next, list_.memory_next, u(c[u(l)]));
      return;
    }
    std::uint8_t* const touched = list_.touched.data();
    int had = 0;
    if constexpr (!kOrdered) {
      if (valid == 4) {  // four flags in one word, which seldom changes
        std::uint32_t old = 0;
        std::memcpy(&old, touched + c[0], sizeof old);
        const std::uint32_t now = kFlags[u(touch)];
        if (old == now) return;
        std::memcpy(touched + c[0], &now, sizeof now);
        for (int l = 0; l < 4; ++l)
          if ((old & ~now) >> (8 * l) & 1U) forget(list_.spring, list_.memory, u(c[u(l)]));
        return;
      }
    }
    for (int l = 0; l < valid; ++l) {
      had |= touched[c[u(l)]] << l;
      touched[c[u(l)]] = static_cast<std::uint8_t>(touch >> l & 1);
    }
    if ((had & ~touch) == 0) return;
    for (int l = 0; l < valid; ++l)
      if (((had & ~touch) >> l & 1) != 0) forget(list_.spring, list_.memory, u(c[u(l)]));
  }

  static void forget(std::vector<Stored<D>>& spring, std::vector<double>& memory, std::size_t c) {
    spring[c] = {};
    if constexpr (Law::has_memory) memory[c] = 0.0;
  }

  /// From records to rows, four contacts at a time.
  void gather() {
    const auto& p = s_.particles;
    const Slot* const first = list_.i.data();
    const Slot* const second = list_.j.data();
    const Sphere<D>* const spheres = p.sphere.data();
    const Stored<D>* const velocities = p.velocity.data();
    const StoredRot<D>* const spins = p.spin.data();
    const Stored<D>* const springs = list_.spring.data();
    const PairConstants* const all_constants = list_.constants.data();
    for (int g = 0; g < block_.touching; g += 4) {
      std::array<Quad, 4> branch, motion, spin_i, spin_j, spring;
      for (std::size_t l = 0; l < 4; ++l) {
        const std::size_t c = u(block_.pair[u(g) + l]);
        const std::size_t i = u(first[c]);
        const std::size_t j = u(second[c]);
        branch[l] = block_.record[u(g) + l];
        block_.a.v[u(g) + l] = all_constants[c].a;
        if constexpr (Law::needs_velocity) {
          block_.b.v[u(g) + l] = all_constants[c].b;
          motion[l] = quad_of(velocities[i]) - quad_of(velocities[j]);
          if constexpr (kPeriodic) motion[l] -= images_.velocity[u(list_.image[c])];
        }
        if constexpr (Law::has_tangential) {
          spin_i[l] = with_fourth(quad_of(spins[i]), place(spheres[i]));
          spin_j[l] = with_fourth(quad_of(spins[j]), place(spheres[j]));
          spring[l] = quad_of(springs[c]);
        }
        if constexpr (Law::has_memory) block_.memory.v[u(g) + l] = list_.memory[c];
      }
      transpose(branch[0], branch[1], branch[2], branch[3]);
      store_rows<D>(block_.branch, g, branch);
      store_quad(block_.reach.v + g, branch[3]);
      if constexpr (Law::needs_velocity) {
        transpose(motion[0], motion[1], motion[2], motion[3]);
        store_rows<D>(block_.velocity, g, motion);
      }
      if constexpr (Law::has_tangential) {
        transpose(spin_i[0], spin_i[1], spin_i[2], spin_i[3]);
        transpose(spin_j[0], spin_j[1], spin_j[2], spin_j[3]);
        store_rows<kRot<D>>(block_.spin_i, g, spin_i);
        store_rows<kRot<D>>(block_.spin_j, g, spin_j);
        store_quad(block_.radius_i.v + g, spin_i[3]);
        store_quad(block_.radius_j.v + g, spin_j[3]);
        transpose(spring[0], spring[1], spring[2], spring[3]);
        store_rows<D>(block_.spring, g, spring);
      }
    }
  }

  void evaluate(int g) {
    using std::experimental::sqrt;
    Vec<D, Lanes> normal = at<D>(block_.branch, g);
    const Lanes distance = sqrt(norm2(normal));
    const Lanes overlap = block_.reach.at(g) - distance;
    normal *= 1.0 / distance;
    const auto known = distance > 0.0;  // of coincident centres the normal is an arbitrary, fixed one
    for (int c = 0; c < D; ++c) normal[c] = choose(known, normal[c], Lanes(c == 0 ? 1.0 : 0.0));
    const Lanes root_h = sqrt(overlap);
    const Lanes contact_radius = block_.a.at(g) * root_h;
    Lanes normal_force = contact_radius * overlap * law_.k.inverse_d;
    if constexpr (Law::needs_velocity) {
      Vec<D, Lanes> v = at<D>(block_.velocity, g);
      Lanes arm_i(0.0);
      Lanes arm_j(0.0);
      if constexpr (Law::has_tangential) {
        arm_i = block_.radius_i.at(g) - 0.5 * overlap;
        arm_j = block_.radius_j.at(g) - 0.5 * overlap;
        v -= cross(at<kRot<D>>(block_.spin_i, g) * arm_i + at<kRot<D>>(block_.spin_j, g) * arm_j, normal);
      }
      const Lanes speed = dot(v, normal);
      Lanes eta(0.0);
      if constexpr (Law::is_damped) {
        eta = block_.b.at(g) * sqrt(root_h);
        normal_force -= eta * speed;
      }
      if constexpr (Law::has_tangential) {
        const Vec<D, Lanes> sliding = v - normal * speed;
        const Vec<D, Lanes> ft = tangential(g, normal, sliding, contact_radius, eta, normal_force);
        put<D>(block_.force, g, normal * normal_force + ft);
        put<kRot<D>>(block_.moment, g, cross(normal, ft));
        block_.arm_i.put(g, arm_i);
        block_.arm_j.put(g, arm_j);
        return;
      }
    }
    put<D>(block_.force, g, normal * normal_force);
  }

  /// See carried_spring.
  static Vec<D, Lanes> carried(const Vec<D, Lanes>& old, const Vec<D, Lanes>& normal) {
    using std::experimental::copysign;
    using std::experimental::sqrt;
    if constexpr (D == 2) {
      const Vec<D, Lanes> tangent{{-normal[1], normal[0]}};
      return tangent * Lanes(copysign(sqrt(norm2(old)), dot(old, tangent)));
    } else {
      const Vec<D, Lanes> flat = old - normal * dot(old, normal);
      const Lanes after = norm2(flat);
      return flat * choose(after > 0.0, sqrt(norm2(old) / after), Lanes(1.0));
    }
  }

  /// See coulomb_spring.
  Vec<D, Lanes> tangential(int g, const Vec<D, Lanes>& normal, const Vec<D, Lanes>& sliding,
                           const Lanes& contact_radius, const Lanes& eta, const Lanes& normal_force) {
    using std::experimental::any_of;
    using std::experimental::max;
    using std::experimental::sqrt;
    const Lanes limit = law_.k.friction * max(normal_force, Lanes(0.0));
    Vec<D, Lanes> old = at<D>(block_.spring, g);
    if constexpr (Law::has_memory) {
      const Lanes memory = block_.memory.at(g);
      old *= choose(memory > 0.0 && contact_radius > memory, memory / contact_radius, Lanes(1.0));
      block_.memory.put(g, contact_radius);
    }
    Vec<D, Lanes> spring = carried(old, normal) + sliding * Lanes(dt_);
    const Lanes stiffness = contact_radius * law_.k.shear;
    Vec<D, Lanes> force = spring * -stiffness;
    const Lanes size2 = norm2(force);
    const Lanes limit2 = limit * limit;
    const auto slides = size2 > limit2;
    if constexpr (Law::is_damped) {
      Vec<D, Lanes> damped = force - sliding * eta;
      const Lanes damped2 = norm2(damped);
      const auto capped = damped2 > limit2;
      if (any_of(capped && !slides)) damped *= choose(capped, limit / sqrt(damped2), Lanes(1.0));
      for (int c = 0; c < D; ++c) force[c] = choose(slides, force[c], damped[c]);
    }
    if (any_of(slides)) {
      const Lanes share = choose(slides, limit / sqrt(size2), Lanes(1.0));
      spring *= share;
      force *= share;
    }
    put<D>(block_.spring, g, spring);
    return force;
  }

  /// Rows become records again and go to the bodies in the order of the range.
  void scatter() {
    const Slot* const first = list_.i.data();
    const Slot* const second = list_.j.data();
    Stored<D>* const forces = s_.particles.force.data();
    StoredRot<D>* const torques = s_.particles.torque.data();
    for_records([&](int k, std::size_t c, Quad force, Quad moment) {
      if constexpr (kOrdered)
        if (target_.waiting != nullptr && target_.waiting->next < static_cast<std::int32_t>(c))
          target_.waiting->add_before(static_cast<std::int32_t>(c));
      const std::size_t i = u(first[c]);
      const std::size_t j = u(second[c]);
      store(forces[i], quad_of(forces[i]) + force);
      store(forces[j], quad_of(forces[j]) - force);
      if constexpr (Law::has_tangential) {
        store(torques[i], quad_of(torques[i]) - moment * block_.arm_i.v[k]);
        store(torques[j], quad_of(torques[j]) - moment * block_.arm_j.v[k]);
      }
    });
  }

  /// The same for bodies of other threads.
  void put_down() {
    for_records([&](int k, std::size_t, Quad force, Quad moment) {
      ContactLoad& load = target_.loads[block_.number[u(k)]];
      if constexpr (Law::has_tangential) {
        force[3] = block_.arm_i.v[k];
        moment[3] = block_.arm_j.v[k];
      } else {
        force[3] = 0.0;
      }
      store_quad(load.force, force);
      store_quad(load.moment, moment);
    });
  }

  /// work(number in the block, place in the list, force, moment) for every touching pair; keeps the new history.
  template <class Work>
  void for_records(Work&& work) {
    const bool next = target_.history == History::next;
    const bool keep = target_.history != History::none;
    Stored<D>* const springs = next ? list_.spring_next.data() : list_.spring.data();
    double* const memories = next ? list_.memory_next.data() : list_.memory.data();
    for (int g = 0; g < block_.touching; g += 4) {
      const std::array<Quad, 4> force = quads<D>(block_.force, g);
      std::array<Quad, 4> moment{}, spring;
      if constexpr (Law::has_tangential) {
        moment = quads<kRot<D>>(block_.moment, g);
        spring = quads<D>(block_.spring, g);
      }
      const int many = std::min(4, block_.touching - g);
      for (int l = 0; l < many; ++l) {
        const std::size_t c = u(block_.pair[u(g + l)]);
        work(g + l, c, force[u(l)], moment[u(l)]);
        if constexpr (Law::has_tangential)
          if (keep) store(springs[c], spring[u(l)]);
        if constexpr (Law::has_memory)
          if (keep) memories[c] = block_.memory.v[g + l];
      }
    }
  }

  template <int N>
  static std::array<Quad, 4> quads(const Rows<N>& rows, int g) {
    std::array<Quad, 4> q{};
    for (std::size_t c = 0; c < static_cast<std::size_t>(N); ++c) q[c] = load_quad(rows[c].v + g);
    transpose(q[0], q[1], q[2], q[3]);
    return q;
  }

  System<D>& s_;
  ContactList<D>& list_;
  const Law law_;
  const double dt_;
  const PairRange range_;
  const Target target_;
  const Images<D, kPeriodic> images_;
  Block<D>& block_ = scratch();
};

template <class Law>
constexpr bool kIsHertz = false;
template <Tangential kTangential, bool kDamped>
constexpr bool kIsHertz<HertzMindlin<kTangential, kDamped>> = true;

}  // namespace

bool has_fast_loop(const LawSet& laws, const ContactSection& section) {
  return section.geometry == Geometry::sphere_sphere &&
         std::visit([]<class Law>(const Law&) { return kIsHertz<Law>; }, laws.law(section.law));
}

template <int D>
// NOLINTNEXTLINE(readability-function-size): its parameters are those of the passes that call it
void hertz_loop(System<D>& s, const ContactSection& section, double dt, const PairRange& range, History history,
                ContactLoad* loads, std::uint8_t* touches, WaitingLoads* waiting) {
  const Target target{history, loads, touches, waiting};
  std::visit(
      [&]<class Law>(const Law& law) {
        if constexpr (kIsHertz<Law>) {
          const auto run = [&](auto periodic, auto ordered) {
            Loop<D, Law, decltype(periodic)::value, decltype(ordered)::value>(s, law, dt, range, target).run();
          };
          const auto with_order = [&](auto periodic) {
            range.order == nullptr ? run(periodic, std::false_type{}) : run(periodic, std::true_type{});
          };
          s.cell.any_periodic() ? with_order(std::true_type{}) : with_order(std::false_type{});
        }
      },
      s.laws.law(section.law));
}

template void hertz_loop<2>(System<2>&, const ContactSection&, double, const PairRange&, History, ContactLoad*,
                            std::uint8_t*, WaitingLoads*);
template void hertz_loop<3>(System<3>&, const ContactSection&, double, const PairRange&, History, ContactLoad*,
                            std::uint8_t*, WaitingLoads*);

}  // namespace softgrain
