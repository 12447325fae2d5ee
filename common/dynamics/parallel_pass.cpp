#include "common/dynamics/parallel_pass.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/dynamics/scatter_sink.h"

namespace softgrain {

namespace {

/// Pairs of one section that belong to one thread.
struct Share {
  std::vector<std::int32_t> inner;    ///< places in the list of pairs whose bodies are both the thread's
  std::vector<std::int32_t> outer;    ///< of those whose second body is another's
  std::vector<ContactLoad> loads;     ///< of outer
  std::vector<std::uint8_t> touches;  ///< of outer

  struct Incoming {
    std::int32_t thread = 0;
    std::int32_t number = 0;
  };
  std::vector<Incoming> incoming;  ///< outer pairs of earlier threads that end here, in list order
};

/// Who does what, good for one list and number of threads.
struct Plan {
  std::uint64_t build = 0;
  int threads = 0;
  std::vector<std::vector<Share>> shares;  ///< [thread][section]
};

/// First body of every thread, so that each has about as many pairs; one more entry at the end.
template <int D>
std::vector<Slot> split_bodies(const System<D>& s, int threads) {
  const auto bodies = static_cast<std::size_t>(s.particles.size());
  std::vector<std::int64_t> before(bodies + 1, 0);
  for (const Slot i : s.contacts.i) ++before[static_cast<std::size_t>(i) + 1];
  for (std::size_t b = 1; b <= bodies; ++b) before[b] += before[b - 1];
  std::vector<Slot> first{0};
  for (int t = 1; t < threads; ++t) {
    const std::int64_t target = before.back() * t / threads;
    const auto at = std::lower_bound(before.begin(), before.end(), target) - before.begin();
    first.push_back(std::max(static_cast<Slot>(at), first.back()));
  }
  first.push_back(s.particles.size());
  return first;
}

int owner(const std::vector<Slot>& first, Slot body) {
  return static_cast<int>(std::upper_bound(first.begin(), first.end() - 1, body) - first.begin()) - 1;
}

template <int D>
void make_plan(const System<D>& s, int threads, Plan& plan) {
  const auto& list = s.contacts;
  const std::vector<Slot> first = split_bodies(s, threads);
  plan.build = list.build;
  plan.threads = threads;
  plan.shares.assign(static_cast<std::size_t>(threads), std::vector<Share>(list.sections.size()));
  for (std::size_t k = 0; k < list.sections.size(); ++k) {
    const ContactSection& section = list.sections[k];
    for (std::int32_t c = section.begin; c < section.end; ++c) {
      const int mine = owner(first, list.i[static_cast<std::size_t>(c)]);
      const int other = owner(first, list.j[static_cast<std::size_t>(c)]);
      Share& share = plan.shares[static_cast<std::size_t>(mine)][k];
      if (mine == other) {
        share.inner.push_back(c);
        continue;
      }
      plan.shares[static_cast<std::size_t>(other)][k].incoming.push_back(
          {mine, static_cast<std::int32_t>(share.outer.size())});
      share.outer.push_back(c);
    }
    for (auto& of_thread : plan.shares) {
      of_thread[k].loads.resize(of_thread[k].outer.size());
      of_thread[k].touches.resize(of_thread[k].outer.size());
    }
  }
}

template <int D>
class Pass {
 public:
  Pass(System<D>& s, double dt, History history, Plan& plan) : s_(s), dt_(dt), history_(history), plan_(plan) {}

  void put_down(std::size_t thread) {
    for (std::size_t k = 0; k < s_.contacts.sections.size(); ++k) {
      Share& share = plan_.shares[thread][k];
      const ContactSection& section = s_.contacts.sections[k];
      const PairRange range{0, static_cast<std::int32_t>(share.outer.size()), share.outer.data()};
      if (has_fast_loop(s_.laws, section)) {
        hertz_loop(s_, section, dt_, range, history_, share.loads.data(), share.touches.data());
      } else {
        PutDownSink<D> sink{share.loads.data(), share.touches.data()};
        pair_loop(s_, section, dt_, range, sink, history_);
      }
    }
  }

  void add(std::size_t thread) {
    for (std::size_t k = 0; k < s_.contacts.sections.size(); ++k) {
      Share& share = plan_.shares[thread][k];
      add_incoming(share, k);
      const ContactSection& section = s_.contacts.sections[k];
      const PairRange range{0, static_cast<std::int32_t>(share.inner.size()), share.inner.data()};
      if (has_fast_loop(s_.laws, section)) {
        hertz_loop(s_, section, dt_, range, history_);
      } else {
        ScatterSink<D> sink{s_.particles};
        pair_loop(s_, section, dt_, range, sink, history_);
      }
      add_outer(share);
    }
  }

 private:
  static void apply(const ContactLoad& load, double sign, double arm, Stored<D>& force, StoredRot<D>& torque) {
    for (int c = 0; c < D; ++c) force[c] += sign * load.force[c];
    for (int c = 0; c < (D == 3 ? 3 : 1); ++c) torque[c] -= load.moment[c] * arm;
  }

  void add_incoming(const Share& share, std::size_t section) {
    for (const auto& in : share.incoming) {
      const Share& from = plan_.shares[static_cast<std::size_t>(in.thread)][section];
      const auto n = static_cast<std::size_t>(in.number);
      if (from.touches[n] == 0) continue;
      const auto j = static_cast<std::size_t>(s_.contacts.j[static_cast<std::size_t>(from.outer[n])]);
      apply(from.loads[n], -1.0, from.loads[n].arm_j, s_.particles.force[j], s_.particles.torque[j]);
    }
  }

  void add_outer(const Share& share) {
    for (std::size_t n = 0; n < share.outer.size(); ++n) {
      if (share.touches[n] == 0) continue;
      const auto i = static_cast<std::size_t>(s_.contacts.i[static_cast<std::size_t>(share.outer[n])]);
      apply(share.loads[n], 1.0, share.loads[n].arm_i, s_.particles.force[i], s_.particles.torque[i]);
    }
  }

  System<D>& s_;
  double dt_;
  History history_;
  Plan& plan_;
};

}  // namespace

template <int D>
void parallel_pass(System<D>& s, double dt, History history, int threads) {
  thread_local Plan kept;
  Plan& plan = kept;  // threads of the team would otherwise each look at their own
  if (plan.build != s.contacts.build || plan.threads != threads) make_plan(s, threads, plan);
  particle_pass(s);
  Pass<D> pass(s, dt, history, plan);
#pragma omp parallel num_threads(threads)
  {
#pragma omp for schedule(static, 1)
    for (int t = 0; t < threads; ++t) pass.put_down(static_cast<std::size_t>(t));
#pragma omp for schedule(static, 1)
    for (int t = 0; t < threads; ++t) pass.add(static_cast<std::size_t>(t));
  }
}

template void parallel_pass<2>(System<2>&, double, History, int);
template void parallel_pass<3>(System<3>&, double, History, int);

}  // namespace softgrain
