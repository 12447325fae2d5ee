// The near pairs of one rank as a source of the program's own loop (common/contact/contact_loop.h).
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <type_traits>
#include <utility>
#include <vector>

#include "common/contact/contact_loop.h"
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
  bool flows =
      false;  ///< the box moves, and whatever is in it, ghosts across its faces too: by rate times (x - centre)
  Vec<3> rate{};
  Vec<3> centre{};

  /// Velocity of a body by its own motion and that of the box.
  [[nodiscard]] Vec<3> velocity(int i) const {
    Vec<3> out = vec(v[i]);
    if (flows)
      for (int k = 0; k < 3; ++k) out[k] += rate[k] * (x[i][k] - centre[k]);
    return out;
  }
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
    split_motion(b.velocity(i) - b.velocity(j), Bodies::vec(b.omega[i]) * g.arm_i + Bodies::vec(b.omega[j]) * g.arm_j,
                 g.normal, state);
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
    split_motion(b.velocity(i) - planes[static_cast<std::size_t>(j)].velocity, Bodies::vec(b.omega[i]) * g.arm_i,
                 g.normal, state);
  }
};

/// What a pass does.
struct Pass {
  bool advance = false;                ///< whether the history goes on; else it is left alone
  double dt = 0.0;                     ///< time step of the history [s]
  MultiContactSum<3>* sums = nullptr;  ///< sums of laws with a particle pass, per atom, ghosts included
};

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
  out.rolling_stiffness = r.rolling_stiffness;
  for (int k = 0; k < 2; ++k) {
    out.tangential_force[k] = r.tangential_force[k];
    out.spring[k] = r.spring[k];
  }
  return out;
}

/// Whether a law keeps a rolling history. Only laws in space do; those in the plane keep an angle as their memory.
template <class Law>
inline constexpr bool kRolls = law_serves<Law, 3>() && has_roll_history<3>(Law::traits);

/// Pairs of a store as a source; a store that is const keeps no history.
template <class Surface, class Store>
struct StorePairs {
  static constexpr int kDimension = 3;
  static constexpr bool kAtoms = std::is_same_v<Surface, AtomSurface>;

  Store& store;
  const Surface& surface;
  const Pass& pass;

  struct Pair {
    int i = 0;
    int j = 0;
  };

  [[nodiscard]] Pair pair(std::size_t c) const { return {store.i[c], store.j[c]}; }
  bool meet(const Pair& p, double reach, ContactGeometry<3>& g) const { return surface.meet(p.i, p.j, reach, g); }
  template <LawTraits>
  [[nodiscard]] ContactState<3> state(const Pair& p, std::size_t c, const ContactGeometry<3>& g) const {
    ContactState<3> s;
    s.overlap = g.overlap;
    s.normal = g.normal;
    s.dt = pass.dt;
    s.constants = store.constants[c];
    s.spring = store.spring[c];
    s.memory = store.memory[c];
    s.roll = store.roll[c];
    s.radius_i = surface.b.r(p.i);
    s.radius_j = surface.radius_j(p.j);
    return s;
  }
  template <bool kSpins>
  void move(const Pair& p, const ContactGeometry<3>& g, ContactState<3>& s) const {
    surface.move(p.i, p.j, g, s);
  }
  [[nodiscard]] Vec<3> turning(const Pair& p) const { return surface.turning(p.i, p.j); }

  void give_sums(const Pair& p, ContactState<3>& s) const {
    s.sum_i = &pass.sums[p.i];
    if constexpr (kAtoms) s.sum_j = &pass.sums[p.j];
  }
  /// Works on the sums of own atoms. Ghosts get theirs from their rank.
  template <class Work>
  void sums_of(const Pair& p, Work&& work) const {
    work(true, pass.sums[p.i]);
    if (kAtoms && p.j < surface.b.own) work(false, pass.sums[p.j]);
  }

  template <class Law>
  [[nodiscard]] ContactResponse<3> evaluate(const Law& law, const ContactState<3>& s) const {
    if constexpr (!law_serves<Law, 3>())
      return evaluate_flat(law, s);
    else
      return law.evaluate(s);
  }

  template <class Law>
  void keep(std::size_t c, const ContactResponse<3>& r) const {
    if (!pass.advance) return;
    store.touched[c] = 1;
    if constexpr (Law::traits.has_tangential) store.spring[c] = r.spring;
    if constexpr (Law::traits.has_memory) store.memory[c] = r.memory;
    if constexpr (kRolls<Law>) store.roll[c] = r.roll;
  }
  template <class Law>
  void forget(std::size_t c) const {
    if (!pass.advance || store.touched[c] == 0) return;
    store.touched[c] = 0;
    store.spring[c] = {};
    store.memory[c] = 0.0;
    store.roll[c] = {};
  }
};
template <class Surface, class Store>
StorePairs(Store&, const Surface&, const Pass&) -> StorePairs<Surface, Store>;

/// touch(i, j, geometry, response) as a sink.
template <class Touch>
struct ToSink {
  Touch on_touch;

  void apart(std::size_t) {}
  template <LawTraits>
  void touch(std::size_t, int i, int j, const ContactGeometry<3>& g, const ContactResponse<3>& r) {
    on_touch(i, j, g, r);
  }
};
template <class Touch>
ToSink<Touch> to_sink(Touch touch) {
  return {touch};
}

/// Opens the law of every section: work(law, range).
template <class Work>
void over_sections(const ContactStore& store, const std::vector<AnyLaw>& laws, Work&& work) {
  for (const Section& section : store.sections)
    std::visit(
        [&](const auto& law) {
          work(law, PairRange{section.begin, section.end});
        },
        laws[static_cast<std::size_t>(section.law)]);
}

}  // namespace softgrain::lammps
