// The one pair loop: geometry and law are types, what happens with each contact is the sink's business (forces,
// stiffness, records). Everything that looks at contacts goes through here.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include "common/contact/contact_geometry.h"
#include "common/contact/contact_list.h"
#include "common/system.h"

namespace softgrain {

namespace detail {

/// False when the bodies do not overlap, spheres: not within `reach` of each other (overlap is then minus the gap).
template <int D, Geometry kGeometry>
[[gnu::always_inline]] inline bool meet(const Particles<D>& p, std::size_t i, std::size_t j, const Vec<D>& shift,
                                        ContactGeometry<D>& g, double reach = 0.0) {
  const Sphere<D>& a = p.sphere[i];
  const Sphere<D>& b = p.sphere[j];
  const Vec<D> d = a.x - b.x - shift;
  if constexpr (kGeometry == Geometry::sphere_plane)
    return meet_plane(d, a.r, p.normal_of(static_cast<Slot>(j)), g);
  else if constexpr (kGeometry == Geometry::sphere_sphere)
    return meet_sphere(d, a.r, b.r, reach, g);
  else
    return meet_shell(d, a.r, b.r - a.r, g);
}

/// Relative velocity of i against j at the contact point, split along the normal. Without a tangential force spins are
/// not needed.
template <int D, bool kSpins>
[[gnu::always_inline]] inline void relative_motion(const Particles<D>& p, std::size_t i, std::size_t j,
                                                   const ContactGeometry<D>& g, const Vec<D>& image_velocity,
                                                   ContactState<D>& state) {
  const Vec<D> v = p.velocity[i] - p.velocity[j] - image_velocity;
  if constexpr (kSpins)
    split_motion(v, p.spin[i] * g.arm_i + p.spin[j] * g.arm_j, g.normal, state);
  else
    state.normal_speed = dot(v, g.normal);
}

/// What a law is told of a contact before motion and history.
template <int D, Geometry kGeometry>
inline ContactState<D> contact_state(const System<D>& s, std::size_t c, const ContactGeometry<D>& g) {
  ContactState<D> state;
  state.overlap = g.overlap;
  state.normal = g.normal;
  state.constants = s.contacts.constants[c];
  const double rj = s.particles.sphere[static_cast<std::size_t>(s.contacts.j[c])].r;
  state.radius_i = s.particles.sphere[static_cast<std::size_t>(s.contacts.i[c])].r;
  state.radius_j = kGeometry == Geometry::sphere_shell ? -rj : rj;
  return state;
}

template <int D, Geometry kGeometry, bool kPeriodic, class Law, class Sink>
void run_section(System<D>& s, const Law& law, double dt, const PairRange& range, History history, Sink& sink) {
  ContactList<D>& list = s.contacts;
  const auto keep = [&](std::size_t c, const Vec<D>& spring, double memory) {
    if (history == History::none) return;
    const bool next = history == History::next;
    if (!next) list.touched[c] = 1;
    if constexpr (Law::has_tangential) (next ? list.spring_next : list.spring)[c] = spring;
    if constexpr (Law::has_memory) (next ? list.memory_next : list.memory)[c] = memory;
  };
  for (std::int32_t k = range.begin; k < range.end; ++k) {
    const auto c = static_cast<std::size_t>(range.at(k));
    const auto i = static_cast<std::size_t>(list.i[c]);
    const auto j = static_cast<std::size_t>(list.j[c]);
    Vec<D> shift{};
    Vec<D> image_velocity{};
    if (kPeriodic && list.image[c] != home_image<D>()) {
      shift = s.cell.image_shift(list.image[c]);
      image_velocity = s.cell.velocity_gradient * shift;
    }
    ContactGeometry<D> g;
    if (!meet<D, kGeometry>(s.particles, i, j, shift, g, reach_of(law))) {
      keep(c, {}, 0.0);
      sink.apart(c);
      continue;
    }
    ContactState<D> state = contact_state<D, kGeometry>(s, c, g);
    state.dt = dt;
    if constexpr (Law::needs_velocity)
      relative_motion<D, Law::has_tangential>(s.particles, i, j, g, image_velocity, state);
    if constexpr (resists_rolling<Law>()) state.turning = s.particles.spin[i] - s.particles.spin[j];
    if constexpr (Law::has_tangential) state.spring = list.spring[c];
    if constexpr (Law::has_memory) state.memory = list.memory[c];
    if constexpr (Law::needs_particle_pass) {
      state.sum_i = &list.particle_sum[i];
      state.sum_j = &list.particle_sum[j];
    }
    const ContactResponse<D> response = law.evaluate(state);
    keep(c, response.spring, response.memory);
    sink.template touch<Law::has_tangential>(c, i, j, g, response);
    if constexpr (resists_rolling<Law>() && requires { sink.roll(i, j, response.rolling_moment); })
      sink.roll(i, j, response.rolling_moment);
  }
}

/// The pass over particles that a law may ask for: every contact adds its share to the sums of its bodies, before any
/// contact is evaluated. Laws that do not ask compile to nothing.
template <int D, Geometry kGeometry, bool kPeriodic, class Law>
void sum_section(System<D>& s, const ContactSection& section, const Law& law) {
  if constexpr (Law::needs_particle_pass) {
    ContactList<D>& list = s.contacts;
    for (std::int32_t k = section.begin; k < section.end; ++k) {
      const auto c = static_cast<std::size_t>(k);
      const auto i = static_cast<std::size_t>(list.i[c]);
      const auto j = static_cast<std::size_t>(list.j[c]);
      Vec<D> shift{};
      if constexpr (kPeriodic) shift = s.cell.image_shift(list.image[c]);
      ContactGeometry<D> g;
      if (!meet<D, kGeometry>(s.particles, i, j, shift, g)) continue;
      ContactState<D> state = contact_state<D, kGeometry>(s, c, g);
      if constexpr (Law::has_memory) state.memory = list.memory[c];
      law.share(state, true, list.particle_sum[i]);
      law.share(state, false, list.particle_sum[j]);
    }
  } else {
    (void)s;
    (void)section;
    (void)law;
  }
}

/// Closes the sums of all bodies that a section knows, once each.
template <int D, class Law>
void finish_section(System<D>& s, const ContactSection& section, const Law& law) {
  if constexpr (Law::needs_particle_pass) {
    ContactList<D>& list = s.contacts;
    const auto close = [&](Slot body) {
      CrowdSum<D>& sum = list.particle_sum[static_cast<std::size_t>(body)];
      if (!sum.ready && sum.square > 0.0) law.finish(sum);
    };
    for (auto c = static_cast<std::size_t>(section.begin); c < static_cast<std::size_t>(section.end); ++c) {
      close(list.i[c]);
      close(list.j[c]);
    }
  } else {
    (void)s;
    (void)section;
    (void)law;
  }
}

/// Opens geometry and law of a section: work(law, geometry constant, periodic constant).
template <int D, class Work>
void with_types(const System<D>& s, const ContactSection& section, Work&& work) {
  const bool periodic = s.cell.any_periodic();
  std::visit(
      [&]<class Law>(const Law& law) {
        using G = Geometry;
        if constexpr (!law_serves<Law, D>())
          throw std::logic_error("a law for another number of dimensions");
        else
          switch (section.geometry) {
            case G::sphere_sphere:
              if (periodic)
                work(law, std::integral_constant<G, G::sphere_sphere>{}, std::true_type{});
              else
                work(law, std::integral_constant<G, G::sphere_sphere>{}, std::false_type{});
              break;
            case G::sphere_shell:
              work(law, std::integral_constant<G, G::sphere_shell>{}, std::false_type{});
              break;
            case G::sphere_plane:
              work(law, std::integral_constant<G, G::sphere_plane>{}, std::false_type{});
              break;
          }
      },
      s.laws.law(section.law));
}

}  // namespace detail

/// Runs some pairs of one section through `sink`.
template <int D, class Sink>
void pair_loop(System<D>& s, const ContactSection& section, double dt, const PairRange& range, Sink& sink,
               History history) {
  detail::with_types(s, section, [&](const auto& law, auto geometry, auto periodic) {
    detail::run_section<D, decltype(geometry)::value, decltype(periodic)::value>(s, law, dt, range, history, sink);
  });
}

/// The particle pass of all laws that ask for one; must precede the loop over contacts.
template <int D>
void particle_pass(System<D>& s) {
  if (s.contacts.particle_sum.empty()) return;
  std::fill(s.contacts.particle_sum.begin(), s.contacts.particle_sum.end(), CrowdSum<D>{});
  for (const ContactSection& section : s.contacts.sections)
    detail::with_types(s, section, [&](const auto& law, auto geometry, auto periodic) {
      detail::sum_section<D, decltype(geometry)::value, decltype(periodic)::value>(s, section, law);
    });
  for (const ContactSection& section : s.contacts.sections)
    detail::with_types(s, section, [&](const auto& law, auto, auto) { detail::finish_section<D>(s, section, law); });
}

/// Runs all contacts through `sink`, in list order. Asked for the next history, it leaves the committed one alone.
template <int D, class Sink>
void pair_loop(System<D>& s, double dt, Sink& sink, History history = History::next) {
  if (history == History::next) s.contacts.make_next();
  particle_pass(s);
  for (const ContactSection& section : s.contacts.sections)
    pair_loop(s, section, dt, {section.begin, section.end}, sink, history);
}

}  // namespace softgrain
