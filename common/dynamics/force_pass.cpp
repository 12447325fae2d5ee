#include "common/dynamics/force_pass.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "common/dynamics/pair_loop.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {

namespace {

/// Below this many listed pairs one thread is faster than two.
constexpr std::int32_t kParallelPairs = 8000;

/// Adds each contact to its two bodies at once, in list order.
template <int D>
struct ScatterSink {
  Particles<D>& p;

  void apart(std::size_t) {}
  template <bool kTorque>
  void touch(std::size_t, std::size_t i, std::size_t j, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    if constexpr (kTorque) {
      const Vec<D> f = g.normal * r.normal_force + r.tangential_force;
      p.force[i] += f;
      p.force[j] -= f;
      const Rot<D> moment = cross(g.normal, r.tangential_force);
      p.torque[i] -= moment * g.arm_i;
      p.torque[j] -= moment * g.arm_j;
    } else {
      const Vec<D> f = g.normal * r.normal_force;
      p.force[i] += f;
      p.force[j] -= f;
    }
  }
};

/// The same and stiffness sums.
template <int D>
struct StiffnessSink {
  ScatterSink<D> scatter;
  BodyStiffness& out;

  void apart(std::size_t) {}
  template <bool kTorque>
  void touch(std::size_t c, std::size_t i, std::size_t j, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    scatter.template touch<kTorque>(c, i, j, g, r);
    if (r.normal_force != 0.0) {
      out.force_sum += std::abs(r.normal_force);
      ++out.contacts;
    }
    const double k = r.normal_stiffness + r.tangential_stiffness;
    out.translation[i] += k;
    out.translation[j] += k;
    out.rotation[i] += r.tangential_stiffness * g.arm_i * g.arm_i;
    out.rotation[j] += r.tangential_stiffness * g.arm_j * g.arm_j;
  }
};

/// What one contact adds to its bodies, kept for the gather.
template <int D>
struct Contribution {
  Vec<D> force{};
  Rot<D> torque_i{};
  Rot<D> torque_j{};
  bool active = false;
};

template <int D>
struct StoreSink {
  std::vector<Contribution<D>>& out;

  void apart(std::size_t c) { out[c].active = false; }
  template <bool kTorque>
  void touch(std::size_t c, std::size_t, std::size_t, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    Contribution<D>& to = out[c];
    to.active = true;
    to.force = g.normal * r.normal_force;
    if constexpr (kTorque) {
      to.force = g.normal * r.normal_force + r.tangential_force;
      const Rot<D> moment = cross(g.normal, r.tangential_force);
      to.torque_i = moment * g.arm_i;
      to.torque_j = moment * g.arm_j;
    } else {
      to.torque_i = {};
      to.torque_j = {};
    }
  }
};

template <int D>
struct RecordSink {
  const System<D>& s;
  std::vector<ContactRecord<D>>& out;

  void apart(std::size_t) {}
  template <bool kTorque>
  void touch(std::size_t c, std::size_t i, std::size_t, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    if (r.elastic_force == 0.0 && r.normal_force == 0.0) return;
    out.push_back({s.contacts.i[c], s.contacts.j[c], g.overlap, g.normal, g.branch,
                   s.particles.sphere[i].x - g.normal * g.arm_i, r.normal_force, r.tangential_force, r.sliding});
  }
};

/// Body -> its contacts in list order, for the parallel gather.
struct Adjacency {
  std::vector<std::int32_t> start;
  std::vector<std::int32_t> contact;
};

template <int D>
Adjacency adjacency_of(const System<D>& s) {
  Adjacency a;
  const auto n = static_cast<std::size_t>(s.particles.size());
  a.start.assign(n + 1, 0);
  const auto& list = s.contacts;
  for (std::size_t c = 0; c < list.i.size(); ++c) {
    ++a.start[static_cast<std::size_t>(list.i[c]) + 1];
    ++a.start[static_cast<std::size_t>(list.j[c]) + 1];
  }
  for (std::size_t b = 1; b <= n; ++b) a.start[b] += a.start[b - 1];
  a.contact.resize(2 * list.i.size());
  std::vector<std::int32_t> next(a.start.begin(), a.start.end() - 1);
  for (std::size_t c = 0; c < list.i.size(); ++c) {
    a.contact[static_cast<std::size_t>(next[static_cast<std::size_t>(list.i[c])]++)] = static_cast<std::int32_t>(c);
    a.contact[static_cast<std::size_t>(next[static_cast<std::size_t>(list.j[c])]++)] = static_cast<std::int32_t>(c);
  }
  return a;
}

/// Scratch of the parallel path, good for one build of a contact list.
template <int D>
struct ParallelScratch {
  std::uint64_t build = 0;
  std::vector<Contribution<D>> contributions;
  Adjacency adjacency;
};

template <int D>
void gather(System<D>& s, const ParallelScratch<D>& scratch) {
  auto& p = s.particles;
  const std::int32_t n = p.size();
#pragma omp parallel for schedule(static, 256)
  for (std::int32_t b = 0; b < n; ++b) {
    const auto u = static_cast<std::size_t>(b);
    Vec<D> force{};
    Rot<D> torque{};
    for (auto k = static_cast<std::size_t>(scratch.adjacency.start[u]);
         k < static_cast<std::size_t>(scratch.adjacency.start[u + 1]); ++k) {
      const auto c = static_cast<std::size_t>(scratch.adjacency.contact[k]);
      const Contribution<D>& from = scratch.contributions[c];
      if (!from.active) continue;
      if (s.contacts.i[c] == b) {
        force += from.force;
        torque -= from.torque_i;
      } else {
        force -= from.force;
        torque -= from.torque_j;
      }
    }
    p.force[u] = force;
    p.torque[u] = torque;
  }
}

template <int D>
void parallel_pass(System<D>& s, double dt) {
  thread_local ParallelScratch<D> scratch;
  if (scratch.build != s.contacts.build) {
    scratch.build = s.contacts.build;
    scratch.contributions.assign(s.contacts.i.size(), {});
    scratch.adjacency = adjacency_of(s);
  }
  particle_pass(s);
  StoreSink<D> sink{scratch.contributions};
  constexpr std::int32_t kChunk = 1024;
  for (const ContactSection& section : s.contacts.sections) {
    const std::int32_t chunks = (section.end - section.begin + kChunk - 1) / kChunk;
#pragma omp parallel for schedule(static)
    for (std::int32_t k = 0; k < chunks; ++k) {
      const std::int32_t begin = section.begin + k * kChunk;
      StoreSink<D> own = sink;
      pair_loop(s, section, dt, begin, std::min(begin + kChunk, section.end), own);
    }
  }
  gather(s, scratch);
}

template <int D>
void clear_forces(Particles<D>& p) {
  std::fill(p.force.begin(), p.force.end(), Vec<D>{});
  std::fill(p.torque.begin(), p.torque.end(), Rot<D>{});
}

template <int D>
void count_pass(System<D>& s) {
  ++s.cost.loop_passes;
  s.cost.contact_evaluations += s.contacts.size();
}

}  // namespace

template <int D>
void force_pass(System<D>& system, double dt) {
  update_neighbours(system);
  if (system.contacts.size() >= kParallelPairs && omp_get_max_threads() > 1 && omp_in_parallel() == 0) {
    parallel_pass(system, dt);
  } else {
    clear_forces(system.particles);
    ScatterSink<D> sink{system.particles};
    pair_loop(system, dt, sink);
  }
  count_pass(system);
}

template <int D>
void force_pass(System<D>& system, double dt, BodyStiffness& stiffness) {
  update_neighbours(system);
  clear_forces(system.particles);
  stiffness.translation.assign(static_cast<std::size_t>(system.particles.size()), 0.0);
  stiffness.rotation.assign(static_cast<std::size_t>(system.particles.size()), 0.0);
  stiffness.force_sum = 0.0;
  stiffness.contacts = 0;
  StiffnessSink<D> sink{{system.particles}, stiffness};
  pair_loop(system, dt, sink);
  count_pass(system);
}

template <int D>
std::vector<ContactRecord<D>> contact_records(const System<D>& system) {
  System<D> copy = system;  // the loop writes the uncommitted history; a copy keeps the state untouched
  std::vector<ContactRecord<D>> out;
  update_neighbours(copy);
  RecordSink<D> sink{copy, out};
  pair_loop(copy, 0.0, sink);
  return out;
}

template void force_pass<2>(System<2>&, double);
template void force_pass<3>(System<3>&, double);
template void force_pass<2>(System<2>&, double, BodyStiffness&);
template void force_pass<3>(System<3>&, double, BodyStiffness&);
template std::vector<ContactRecord<2>> contact_records<2>(const System<2>&);
template std::vector<ContactRecord<3>> contact_records<3>(const System<3>&);

}  // namespace softgrain
