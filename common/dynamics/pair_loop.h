// The pairs of a system one at a time, see contact_loop.h: for records and for what looks at contacts; forces go
// through block_loop.h, which gives the same bits.
#pragma once

#include <stdexcept>
#include <type_traits>

#include "common/contact/contact_list.h"
#include "common/contact/contact_loop.h"
#include "common/dynamics/block_loop.h"
#include "common/dynamics/parallel_pass.h"
#include "common/system.h"

namespace softgrain {

/// Pairs of one section of a system as a source. `Of` is a System, const for those who do not run it.
template <int D, Geometry kGeometry, bool kPeriodic, class Of>
struct SystemPairs {
  static constexpr int kDimension = D;

  Of& s;
  double dt = 0.0;
  History history = History::none;

  struct Pair {
    std::size_t i = 0;
    std::size_t j = 0;
    Vec<D> shift{};
    Vec<D> image_velocity{};
  };

  [[nodiscard]] Pair pair(std::size_t c) const {
    Pair out{static_cast<std::size_t>(s.contacts.i[c]), static_cast<std::size_t>(s.contacts.j[c]), {}, {}};
    if (kPeriodic && s.contacts.image[c] != home_image<D>()) {
      out.shift = s.cell.image_shift(s.contacts.image[c]);
      out.image_velocity = s.cell.velocity_gradient * out.shift;
    }
    return out;
  }

  [[gnu::always_inline]] bool meet(const Pair& pair, double reach, ContactGeometry<D>& g) const {
    const Sphere<D>& a = s.particles.sphere[pair.i];
    const Sphere<D>& b = s.particles.sphere[pair.j];
    const Vec<D> d = a.x - b.x - pair.shift;
    if constexpr (kGeometry == Geometry::sphere_plane)
      return meet_plane(d, a.r, s.particles.normal_of(static_cast<Slot>(pair.j)), g);
    else if constexpr (kGeometry == Geometry::sphere_sphere)
      return meet_sphere(d, a.r, b.r, reach, g);
    else
      return meet_shell(d, a.r, b.r - a.r, g);
  }

  template <LawTraits kLaw>
  [[nodiscard]] ContactState<D> state(const Pair& pair, std::size_t c, const ContactGeometry<D>& g) const {
    ContactState<D> state;
    state.overlap = g.overlap;
    state.normal = g.normal;
    state.dt = dt;
    state.constants = s.contacts.constants[c];
    if constexpr (kLaw.has_tangential) state.spring = s.contacts.spring[c];
    if constexpr (kLaw.has_memory) state.memory = s.contacts.memory[c];
    if constexpr (has_roll_history<D>(kLaw)) state.roll = s.contacts.roll[c];
    const double rj = s.particles.sphere[pair.j].r;
    state.radius_i = s.particles.sphere[pair.i].r;
    state.radius_j = kGeometry == Geometry::sphere_shell ? -rj : rj;
    return state;
  }

  /// Sets the relative motion at the contact. Spins are not needed without a tangential force.
  template <bool kSpins>
  [[gnu::always_inline]] void move(const Pair& pair, const ContactGeometry<D>& g, ContactState<D>& state) const {
    const auto& p = s.particles;
    const Vec<D> v = p.velocity[pair.i] - p.velocity[pair.j] - pair.image_velocity;
    if constexpr (kSpins)
      split_motion<D, double>(v, p.spin[pair.i] * g.arm_i + p.spin[pair.j] * g.arm_j, g.normal, state);
    else
      state.normal_speed = dot(v, g.normal);
  }
  [[nodiscard]] Rot<D> turning(const Pair& pair) const { return s.particles.spin[pair.i] - s.particles.spin[pair.j]; }

  void give_sums(const Pair& pair, ContactState<D>& state) const {
    state.sum_i = &s.contacts.particle_sum[pair.i];
    state.sum_j = &s.contacts.particle_sum[pair.j];
  }
  template <class Work>
  void sums_of(const Pair& pair, Work&& work) const {
    work(true, s.contacts.particle_sum[pair.i]);
    work(false, s.contacts.particle_sum[pair.j]);
  }

  template <class Law>
  [[nodiscard]] ContactResponse<D> evaluate(const Law& law, const ContactState<D>& state) const {
    return law.evaluate(state);
  }

  template <class Law>
  void keep(std::size_t c, const ContactResponse<D>& r) const {
    if (history == History::none) return;
    auto& list = s.contacts;
    const bool next = history == History::next;
    if (!next) list.touched[c] = 1;
    if constexpr (Law::traits.has_tangential) (next ? list.spring_next : list.spring)[c] = r.spring;
    if constexpr (Law::traits.has_memory) (next ? list.memory_next : list.memory)[c] = r.memory;
    if constexpr (has_roll_history<D>(Law::traits)) (next ? list.roll_next : list.roll)[c] = r.roll;
  }
  template <class Law>
  void forget(std::size_t c) const {
    keep<Law>(c, {});
  }
};

/// Opens law and geometry of a section: work(law, source).
template <int D, class Of, class Work>
void with_pairs(Of& s, const ContactSection& section, Work&& work, double dt = 0.0, History history = History::none) {
  const bool periodic = s.cell.any_periodic();
  std::visit(
      [&]<class Law>(const Law& law) {
        using G = Geometry;
        if constexpr (!law_serves<Law, D>()) {
          throw std::logic_error("a law for another number of dimensions");
        } else {
          const auto with = [&](auto geometry, auto repeats) {
            SystemPairs<D, decltype(geometry)::value, decltype(repeats)::value, Of> source{s, dt, history};
            work(law, source);
          };
          using Shell = std::integral_constant<G, G::sphere_shell>;
          using Sphere = std::integral_constant<G, G::sphere_sphere>;
          if (section.geometry == G::sphere_plane)
            with(std::integral_constant<G, G::sphere_plane>{}, std::false_type{});
          else if (section.geometry == G::sphere_shell)
            periodic ? with(Shell{}, std::true_type{}) : with(Shell{}, std::false_type{});
          else
            periodic ? with(Sphere{}, std::true_type{}) : with(Sphere{}, std::false_type{});
        }
      },
      s.laws.law(section.law));
}

/// Runs all contacts through `sink`, in list order. Asked for the next history, it leaves the committed one alone.
template <int D, class Sink>
void pair_loop(System<D>& s, double dt, Sink& sink, History history = History::next) {
  if (history == History::next) s.contacts.make_next();
  particle_pass(s);
  for (const ContactSection& section : s.contacts.sections)
    with_pairs<D>(
        s, section,
        [&](const auto& law, auto& source) {
          run_section(source, law, {section.begin, section.end}, sink);
        },
        dt, history);
}

}  // namespace softgrain
