// What laws do with a block: the rows of its contacts through the law's own text, lanes at a time.
#pragma once

#include "common/contact/contact_geometry.h"
#include "common/contact/contact_list.h"
#include "common/contact/law_set.h"
#include "common/dynamics/block.h"

namespace softgrain::block {

template <int D, Geometry kGeometry>
[[gnu::always_inline]] inline ContactGeometry<D, Lanes> geometry_at(const Block<D>& b, int g) {
  const Vec<D, Lanes> d = at<D>(b.branch, g);
  if constexpr (kGeometry == Geometry::sphere_sphere)
    return of_spheres(d, b.radius_i.at(g), b.radius_j.at(g), b.fourth.at(g));
  else if constexpr (kGeometry == Geometry::sphere_shell)
    return in_shell(d, b.radius_i.at(g), b.fourth.at(g));
  else
    return on_plane(d, b.fourth.at(g), at<D>(b.upright, g));
}

/// What the force of a contact takes from a sum.
template <int D, bool kDirections>
[[gnu::always_inline]] inline MultiContactSum<D, Lanes> sum_at(const SumRows<D>& rows, int g) {
  MultiContactSum<D, Lanes> sum;
  sum.volume = rows.volume.at(g);
  if constexpr (kDirections) {
    sum.first = at<D>(rows.first, g);
    for (std::size_t k = 0; k < sum.second.size(); ++k) sum.second[k] = rows.second[k].at(g);
  }
  sum.gain = rows.gain.at(g);
  sum.gain_slope = rows.gain_slope.at(g);
  return sum;
}

/// What a law is told before motion and sums.
template <int D, Geometry kGeometry, class Law>
[[gnu::always_inline]] inline ContactState<D, Lanes> state_at(const Block<D>& b, int g,
                                                              const ContactGeometry<D, Lanes>& geometry) {
  ContactState<D, Lanes> s;
  s.overlap = geometry.overlap;
  s.normal = geometry.normal;
  s.constants = {b.a.at(g), b.b.at(g)};
  if constexpr (Law::traits.is_multi_contact) {
    s.radius_i = b.radius_i.at(g);
    s.radius_j = kGeometry == Geometry::sphere_shell ? -b.radius_j.at(g) : b.radius_j.at(g);
  }
  if constexpr (Law::traits.has_tangential) s.spring = at<D>(b.spring, g);
  if constexpr (Law::traits.has_memory) s.memory = b.memory.at(g);
  if constexpr (has_roll_history<D>(Law::traits)) s.roll = at<D>(b.roll, g);
  return s;
}

template <int D, Geometry kGeometry, class Law>
[[gnu::flatten]] void evaluate(const void* of_law, double dt, bool stiffness, Block<D>& b) {
  constexpr LawTraits kLaw = Law::traits;
  const Law& law = *static_cast<const Law*>(of_law);
  for (int g = 0; g < b.touching; g += kLanes) {
    const ContactGeometry<D, Lanes> geometry = geometry_at<D, kGeometry>(b, g);
    ContactState<D, Lanes> s = state_at<D, kGeometry, Law>(b, g, geometry);
    s.dt = dt;
    if constexpr (kLaw.has_tangential)
      split_motion<D, Lanes>(at<D>(b.velocity, g),
                             at<kRot<D>>(b.spin_i, g) * geometry.arm_i + at<kRot<D>>(b.spin_j, g) * geometry.arm_j,
                             geometry.normal, s);
    else if constexpr (kLaw.needs_velocity)
      s.normal_speed = dot(at<D>(b.velocity, g), geometry.normal);
    if constexpr (kLaw.has_rolling) s.turning = at<kRot<D>>(b.spin_i, g) - at<kRot<D>>(b.spin_j, g);
    MultiContactSum<D, Lanes> sum_i, sum_j;
    Lanes lost_i, lost_j;
    if constexpr (kLaw.needs_particle_pass) {
      sum_i = sum_at<D, kLaw.directions_in_sums>(b.sum_i, g);
      sum_j = sum_at<D, kLaw.directions_in_sums>(b.sum_j, g);
      s.sum_i = &sum_i;
      s.sum_j = &sum_j;
      lost_i = b.lost_i.at(g);
      lost_j = b.lost_j.at(g);
      s.lost_i = &lost_i;
      s.lost_j = &lost_j;
    }
    const ContactResponse<D, Lanes> r = law.evaluate(s);
    if constexpr (kLaw.has_tangential) {
      put<D>(b.force, g, geometry.normal * r.normal_force + r.tangential_force);
      put<kRot<D>>(b.moment, g, cross(geometry.normal, r.tangential_force));
      put<D>(b.spring, g, r.spring);
      b.arm_i.put(g, geometry.arm_i);
      b.arm_j.put(g, geometry.arm_j);
    } else {
      put<D>(b.force, g, geometry.normal * r.normal_force);
    }
    if constexpr (kLaw.has_memory) b.memory.put(g, r.memory);
    if constexpr (has_roll_history<D>(kLaw)) {
      put<D>(b.roll_moment, g, r.rolling_moment);
      put<D>(b.roll, g, r.roll);
      if (stiffness) b.rolling_stiffness.put(g, r.rolling_stiffness);
    } else if constexpr (kLaw.has_rolling) {
      b.rolling.put(g, r.rolling_moment[0]);
    }
    if (!stiffness) continue;
    b.normal_force.put(g, r.normal_force);
    b.stiffness.put(g, r.normal_stiffness + r.tangential_stiffness);
    if constexpr (kLaw.has_tangential) b.tangential_stiffness.put(g, r.tangential_stiffness);
  }
}

/// What contacts take from their bodies.
template <int D, Geometry kGeometry, class Law>
[[gnu::flatten]] void take(const void* of_law, double, bool, Block<D>& b) {
  const Law& law = *static_cast<const Law*>(of_law);
  for (int g = 0; g < b.touching; g += kLanes) {
    const ContactGeometry<D, Lanes> geometry = geometry_at<D, kGeometry>(b, g);
    const ContactState<D, Lanes> s = state_at<D, kGeometry, Law>(b, g, geometry);
    put<D>(b.normal, g, geometry.normal);
    if (law.soft_sides().i) b.lost_i.put(g, law.occupied_volume(s, true));
    if (law.soft_sides().j) b.lost_j.put(g, law.occupied_volume(s, false));
  }
}

/// A law as the loop needs it. Loops are compiled for what laws ask for, not for each of them.
template <int D>
struct Kernel {
  const void* law = nullptr;
  void (*run)(const void* law, double dt, bool stiffness, Block<D>& block) = nullptr;
  double reach = 0.0;
  SoftSides sums{};  ///< bodies of a contact whose sums the law asks for

  void operator()(double dt, bool stiffness, Block<D>& block) const { run(law, dt, stiffness, block); }
};

/// work(kernel, geometry constant, traits that matter to gathering and scattering as a type).
template <LawTraits kTraits>
struct TraitsOf {
  static constexpr LawTraits value = kTraits;
};

constexpr LawTraits seen_by_loop(LawTraits t) {
  return {.needs_velocity = t.needs_velocity,
          .has_tangential = t.has_tangential,
          .has_memory = t.has_memory,
          .has_rolling = t.has_rolling,
          .acts_at_distance = t.acts_at_distance,
          .needs_particle_pass = t.needs_particle_pass,
          .directions_in_sums = t.directions_in_sums,
          .is_multi_contact = t.is_multi_contact};
}

}  // namespace softgrain::block
