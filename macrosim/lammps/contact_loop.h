// The loop over near pairs of one rank: geometry and law are types, what happens with each contact is the sink's
// business. The functions of geometry and law are those of the program's own loop.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <type_traits>
#include <utility>
#include <vector>

#include "common/contact/contact_geometry.h"
#include "macrosim/lammps/contact_store.h"

namespace softgrain::lammps {

/// The arrays of LAMMPS that contacts need; ghosts included.
struct Bodies {
  const double* const* x = nullptr;
  const double* const* v = nullptr;
  const double* const* omega = nullptr;
  const double* radius = nullptr;
  const double* mass = nullptr;
  const int* tag = nullptr;
  const int* type = nullptr;
  int own = 0;  ///< atoms of this rank; the rest are ghosts

  [[nodiscard]] double r(int i) const { return radius[i]; }
  [[nodiscard]] static Vec<3> vec(const double* a) { return {{a[0], a[1], a[2]}}; }
};

/// A plane with its normal into the side of the bodies.
struct Plane {
  Vec<3> point{};
  Vec<3> normal{};
  Vec<3> velocity{};
};

/// Pairs of atoms.
struct AtomSurface {
  const Bodies& b;

  bool meet(int i, int j, double reach, ContactGeometry<3>& g) const {
    return meet_sphere(Bodies::vec(b.x[i]) - Bodies::vec(b.x[j]), b.r(i), b.r(j), reach, g);
  }
  [[nodiscard]] Vec<3> turning(int i, int j) const { return Bodies::vec(b.omega[i]) - Bodies::vec(b.omega[j]); }
  [[nodiscard]] double radius_j(int j) const { return b.r(j); }
  void move(int i, int j, const ContactGeometry<3>& g, ContactState<3>& state) const {
    split_motion(Bodies::vec(b.v[i]) - Bodies::vec(b.v[j]),
                 Bodies::vec(b.omega[i]) * g.arm_i + Bodies::vec(b.omega[j]) * g.arm_j, g.normal, state);
  }
};

/// Atoms and planes.
struct PlaneSurface {
  const Bodies& b;
  const std::vector<Plane>& planes;

  bool meet(int i, int j, double, ContactGeometry<3>& g) const {
    const Plane& p = planes[static_cast<std::size_t>(j)];
    return meet_plane(Bodies::vec(b.x[i]) - p.point, b.r(i), p.normal, g);
  }
  [[nodiscard]] static double radius_j(int) { return 0.0; }
  [[nodiscard]] Vec<3> turning(int i, int) const { return Bodies::vec(b.omega[i]); }
  void move(int i, int j, const ContactGeometry<3>& g, ContactState<3>& state) const {
    split_motion(Bodies::vec(b.v[i]) - planes[static_cast<std::size_t>(j)].velocity, Bodies::vec(b.omega[i]) * g.arm_i,
                 g.normal, state);
  }
};

/// What a pass does.
struct Pass {
  bool advance = false;               ///< the history goes on; else it is left alone
  double dt = 0.0;                    ///< for it [s]
  const CrowdSum<3>* sums = nullptr;  ///< per atom, ghosts included; of laws with a particle pass
};

template <class Surface>
ContactState<3> state_of(const ContactStore& store, std::size_t c, const Surface& surface,
                         const ContactGeometry<3>& g) {
  ContactState<3> s;
  s.overlap = g.overlap;
  s.normal = g.normal;
  s.constants = store.constants[c];
  s.radius_i = surface.b.r(store.i[c]);
  s.radius_j = surface.radius_j(store.j[c]);
  s.memory = store.memory[c];
  return s;
}

/// A law of two dimensions asked about bodies in the plane z = 0.
template <class Law>
ContactResponse<3> evaluate_flat(const Law& law, const ContactState<3>& s) {
  ContactState<2> flat;
  flat.overlap = s.overlap;
  flat.normal_speed = s.normal_speed;
  flat.dt = s.dt;
  flat.constants = s.constants;
  flat.memory = s.memory;
  flat.radius_i = s.radius_i;
  flat.radius_j = s.radius_j;
  flat.turning[0] = s.turning[2];
  for (int k = 0; k < 2; ++k) {
    flat.normal[k] = s.normal[k];
    flat.sliding[k] = s.sliding[k];
    flat.spring[k] = s.spring[k];
  }
  const ContactResponse<2> r = law.evaluate(flat);
  ContactResponse<3> out;
  out.normal_force = r.normal_force;
  out.elastic_force = r.elastic_force;
  out.normal_stiffness = r.normal_stiffness;
  out.tangential_stiffness = r.tangential_stiffness;
  out.sliding = r.sliding;
  out.memory = r.memory;
  out.rolling_moment[2] = r.rolling_moment[0];
  for (int k = 0; k < 2; ++k) {
    out.tangential_force[k] = r.tangential_force[k];
    out.spring[k] = r.spring[k];
  }
  return out;
}

/// What a law answers to contact c as it is.
template <class Law, class Surface>
ContactResponse<3> response_of(const Law& law, const ContactStore& store, std::size_t c, const Surface& surface,
                               const ContactGeometry<3>& g, const Pass& pass) {
  const int i = store.i[c];
  const int j = store.j[c];
  ContactState<3> s = state_of(store, c, surface, g);
  s.dt = pass.dt;
  if constexpr (Law::needs_velocity) surface.move(i, j, g, s);
  s.spring = store.spring[c];
  if constexpr (Law::needs_particle_pass) {
    s.sum_i = &pass.sums[i];
    if constexpr (std::is_same_v<Surface, AtomSurface>) s.sum_j = &pass.sums[j];
  }
  if constexpr (resists_rolling<Law>()) s.turning = surface.turning(i, j);
  if constexpr (!law_serves<Law, 3>())
    return evaluate_flat(law, s);
  else
    return law.evaluate(s);
}

/// sink(c, geometry, response) for every pair of a section that touches.
template <class Law, class Surface, class Sink>
void run_section(const Law& law, ContactStore& store, const Section& section, const Surface& surface, const Pass& pass,
                 Sink&& sink) {
  for (std::size_t c = section.begin; c < section.end; ++c) {
    ContactGeometry<3> g;
    if (!surface.meet(store.i[c], store.j[c], reach_of(law), g)) {
      if (pass.advance && store.touched[c] != 0) {
        store.touched[c] = 0;
        store.spring[c] = {};
        store.memory[c] = 0.0;
      }
      continue;
    }
    const ContactResponse<3> r = response_of(law, store, c, surface, g, pass);
    if (pass.advance) {
      store.touched[c] = 1;
      if constexpr (Law::has_tangential) store.spring[c] = r.spring;
      if constexpr (Law::has_memory) store.memory[c] = r.memory;
    }
    sink(c, g, r);
  }
}

/// Opens the law of every section: work(law, section).
template <class Work>
void over_sections(const ContactStore& store, const std::vector<AnyLaw>& laws, Work&& work) {
  for (const Section& section : store.sections)
    std::visit([&](const auto& law) { work(law, section); }, laws[static_cast<std::size_t>(section.law)]);
}

/// Adds what the contacts of a store take from their own bodies to the sums of those; ghosts get theirs from their
/// rank.
template <class Surface>
void add_shares(const ContactStore& store, const std::vector<AnyLaw>& laws, const Surface& surface,
                std::vector<CrowdSum<3>>& sums) {
  over_sections(store, laws, [&]<class Law>(const Law& law, const Section& section) {
    if constexpr (Law::needs_particle_pass)
      for (std::size_t c = section.begin; c < section.end; ++c) {
        ContactGeometry<3> g;
        if (!surface.meet(store.i[c], store.j[c], 0.0, g)) continue;
        const ContactState<3> s = state_of(store, c, surface, g);
        law.share(s, true, sums[static_cast<std::size_t>(store.i[c])]);
        if (std::is_same_v<Surface, AtomSurface> && store.j[c] < surface.b.own)
          law.share(s, false, sums[static_cast<std::size_t>(store.j[c])]);
      }
  });
}

/// Closes the sums of the own bodies of a store, once each.
template <bool kPlanes>
void finish_sums(const ContactStore& store, const std::vector<AnyLaw>& laws, int own, std::vector<CrowdSum<3>>& sums) {
  over_sections(store, laws, [&]<class Law>(const Law& law, const Section& section) {
    if constexpr (Law::needs_particle_pass) {
      const auto close = [&](int body) {
        CrowdSum<3>& sum = sums[static_cast<std::size_t>(body)];
        if (!sum.ready && sum.square > 0.0) law.finish(sum);
      };
      for (std::size_t c = section.begin; c < section.end; ++c) {
        close(store.i[c]);
        if (!kPlanes && store.j[c] < own) close(store.j[c]);
      }
    }
  });
}

}  // namespace softgrain::lammps
