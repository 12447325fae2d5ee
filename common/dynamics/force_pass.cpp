#include "common/dynamics/force_pass.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "common/core/parallel_tasks.h"
#include "common/dynamics/pair_loop.h"
#include "common/dynamics/parallel_pass.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {

namespace {

/// Number of listed pairs below which one thread is faster than two.
constexpr std::int32_t kParallelPairs = 8000;

template <int D>
struct RecordSink {
  const System<D>& s;
  std::vector<ContactRecord<D>>& out;

  void apart(std::size_t) {}
  template <LawTraits>
  void touch(std::size_t c, std::size_t i, std::size_t, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    if (r.elastic_force == 0.0 && r.normal_force == 0.0) return;
    out.push_back({s.contacts.i[c], s.contacts.j[c], g.overlap, g.normal, g.branch,
                   s.particles.sphere[i].x - g.normal * g.arm_i, r.normal_force, r.tangential_force, r.sliding,
                   r.rolling_moment});
  }
};

template <int D>
void clear_forces(Particles<D>& p) {
  in_pieces(p.force.size(), [&](std::size_t begin, std::size_t end) {
    std::fill(p.force.begin() + static_cast<std::ptrdiff_t>(begin), p.force.begin() + static_cast<std::ptrdiff_t>(end),
              Stored<D>{});
    std::fill(p.torque.begin() + static_cast<std::ptrdiff_t>(begin),
              p.torque.begin() + static_cast<std::ptrdiff_t>(end), StoredRot<D>{});
  });
}

template <int D>
void count_pass(System<D>& s) {
  ++s.cost.loop_passes;
  s.cost.contact_evaluations += s.contacts.size();
}

template <int D>
void add_forces(System<D>& system, const BlockPass<D>& pass) {
  if (pass.history == History::next) system.contacts.make_next();
  if (system.contacts.size() >= kParallelPairs && omp_get_max_threads() > 1 && omp_in_parallel() == 0) {
    parallel_pass(system, pass, omp_get_max_threads());
  } else {
    particle_pass(system);
    block_loop<D>(system, pass);
  }
  count_pass(system);
}

}  // namespace

template <int D>
void add_contact_forces(System<D>& system, double dt, History history) {
  add_forces<D>(system, {.dt = dt, .history = history});
}

template <int D>
void add_contact_forces(System<D>& system, double dt, BodyStiffness& stiffness, History history) {
  stiffness.clear(static_cast<std::size_t>(system.particles.size()));
  add_forces<D>(system, {.dt = dt, .history = history, .stiffness = &stiffness});
}

template <int D>
void add_contact_forces(System<D>& system, double dt, std::vector<Vec<D>>& virials, History history) {
  virials.resize(system.contacts.i.size());
  add_forces<D>(system, {.dt = dt, .history = history, .virials = virials.data()});
}

template <int D>
void force_pass(System<D>& system, double dt, History history) {
  update_neighbours(system);
  clear_forces(system.particles);
  add_contact_forces(system, dt, history);
}

template <int D>
void force_pass(System<D>& system, double dt, BodyStiffness& stiffness, History history) {
  update_neighbours(system);
  clear_forces(system.particles);
  add_contact_forces(system, dt, stiffness, history);
}

template <int D>
std::vector<ContactRecord<D>> contact_records(const System<D>& system) {
  System<D> copy = system;  // the loop writes the uncommitted history; a copy keeps the state untouched
  std::vector<ContactRecord<D>> out;
  update_neighbours(copy);
  RecordSink<D> sink{copy, out};
  pair_loop(copy, 0.0, sink, History::none);
  return out;
}

template void add_contact_forces<2>(System<2>&, double, History);
template void add_contact_forces<3>(System<3>&, double, History);
template void add_contact_forces<2>(System<2>&, double, BodyStiffness&, History);
template void add_contact_forces<3>(System<3>&, double, BodyStiffness&, History);
template void add_contact_forces<2>(System<2>&, double, std::vector<Vec<2>>&, History);
template void add_contact_forces<3>(System<3>&, double, std::vector<Vec<3>>&, History);
template void force_pass<2>(System<2>&, double, History);
template void force_pass<3>(System<3>&, double, History);
template void force_pass<2>(System<2>&, double, BodyStiffness&, History);
template void force_pass<3>(System<3>&, double, BodyStiffness&, History);
template std::vector<ContactRecord<2>> contact_records<2>(const System<2>&);
template std::vector<ContactRecord<3>> contact_records<3>(const System<3>&);

template <int D>
void displace(System<D>& s, const std::vector<Vec<D>>& moves) {
  auto& p = s.particles;
  std::fill(p.spin.begin(), p.spin.end(), StoredRot<D>{});
  for (std::size_t u = 0; u < moves.size(); ++u) {
    p.sphere[u].x += moves[u];
    p.velocity[u] = moves[u];
  }
  force_pass(s, 1.0, History::advance);
  std::fill(p.velocity.begin(), p.velocity.end(), Stored<D>{});
}

template <int D>
void displace(System<D>& s, const std::vector<Vec<D>>& moves, const Vec<D>& growth) {
  Vec<D> factor;
  for (int k = 0; k < D; ++k) {
    factor[k] = 1.0 + growth[k];
    s.cell.velocity_gradient[k][k] = growth[k] / factor[k];  // over the unit of time that displace() takes
  }
  s.cell.stretch(factor);
  displace(s, moves);
  s.cell.velocity_gradient = {};
}

template void displace<2>(System<2>&, const std::vector<Vec<2>>&);
template void displace<2>(System<2>&, const std::vector<Vec<2>>&, const Vec<2>&);
template void displace<3>(System<3>&, const std::vector<Vec<3>>&, const Vec<3>&);
template void displace<3>(System<3>&, const std::vector<Vec<3>>&);

}  // namespace softgrain
