#include "common/dynamics/parallel_pass.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "common/dynamics/block_loop.h"
#include "common/dynamics/thread_choice.h"
#include "common/neighbours/spatial_order.h"

namespace softgrain {

namespace {

/// Consecutive pairs of one section that concern a thread.
struct Segment {
  std::int32_t begin = 0;  ///< places in the list; with `foreign` numbers among the foreign pairs
  std::int32_t end = 0;
  bool foreign = false;  ///< the second body alone is the thread's
};

/// What a thread does in one section.
template <int D>
struct Share {
  std::vector<Segment> segments;  ///< in list order
  ForeignPairs<D> foreign;        ///< pairs whose second body alone is the thread's
};

/// Who does what, good for one list and number of threads.
template <int D>
struct Plan {
  ThreadPace pace;
  std::uint64_t build = 0;
  std::vector<std::uint8_t> thread_of;  ///< thread of every group of bodies (owners_of)
  std::vector<std::uint8_t> owner;      ///< thread of every body
  std::vector<std::uint8_t> split;      ///< flag per place in the list, 1: the bodies of the pair have two owners
  std::vector<std::vector<BodyRange>> bodies;  ///< bodies of each thread, as stretches
  PieceThreads pieces;                         ///< owner of the middle of every piece of all bodies
  std::vector<std::vector<Share<D>>> shares;   ///< [thread][section]
  std::vector<std::vector<Slot>> neighbours;   ///< bodies of other threads that pairs of each thread reach
};

/// Threads of consecutive parts of the pairs, for numbers of pairs in a row of groups.
std::vector<std::uint8_t> threads_of(const std::vector<std::int64_t>& pairs, const std::vector<double>& share) {
  double all = 0.0;
  for (const std::int64_t here : pairs) all += static_cast<double>(here);
  std::vector<std::uint8_t> thread_of(pairs.size(), 0);
  double left = share.front() * all;
  std::size_t thread = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto here = static_cast<double>(pairs[k]);
    while (thread + 1 < share.size() && left < 0.5 * here) left += share[++thread] * all;
    thread_of[k] = static_cast<std::uint8_t>(thread);
    left -= here;
  }
  return thread_of;
}

/// Threads of bodies in groups that lie in a row: each gets its share of all evaluations. Pairs that had two threads by
/// the last plan, `thread_of`, count twice.
template <int D, class Group>
std::vector<std::uint8_t> owners_of(const System<D>& s, const std::vector<Group>& group, std::size_t groups,
                                    const std::vector<double>& share, std::vector<std::uint8_t>& thread_of) {
  const auto counted = [&] {
    std::vector<std::int64_t> pairs(groups, 0);
    for (std::size_t c = 0; c < s.contacts.i.size(); ++c) {
      const auto first = static_cast<std::size_t>(group[at(s.contacts.i[c])]);
      const auto second = static_cast<std::size_t>(group[at(s.contacts.j[c])]);
      ++pairs[first];
      if (!thread_of.empty() && thread_of[first] != thread_of[second]) ++pairs[second];
    }
    return pairs;
  };
  if (thread_of.size() != groups || *std::max_element(thread_of.begin(), thread_of.end()) + 1U != share.size()) {
    thread_of.clear();
    thread_of = threads_of(counted(), share);
  }
  thread_of = threads_of(counted(), share);
  std::vector<std::uint8_t> owner(group.size());
  for (std::size_t u = 0; u < owner.size(); ++u) owner[u] = thread_of[static_cast<std::size_t>(group[u])];
  return owner;
}

/// Grains of one size class lie along the curve as they were put in order; since then some have crossed the border
/// between two threads. Every thread keeps its number of grains of each class, and gets them in a row: pairs of a
/// thread lie in few stretches of the list.
template <int D>
void put_in_rows(const Particles<D>& p, std::size_t threads, std::vector<std::uint8_t>& owner) {
  const auto grains = static_cast<std::size_t>(p.grains);
  double smallest = p.sphere[0].r;
  for (std::size_t u = 1; u < grains; ++u) smallest = std::min(smallest, p.sphere[u].r);
  std::vector<std::size_t> many(threads);
  for (std::size_t begin = 0, end = 0; begin < grains; begin = end) {
    const int size = size_class(p.sphere[begin].r, smallest);
    std::fill(many.begin(), many.end(), 0);
    for (; end < grains && size_class(p.sphere[end].r, smallest) == size; ++end) ++many[owner[end]];
    std::size_t u = begin;
    for (std::size_t t = 0; t < threads; ++t)
      for (std::size_t k = 0; k < many[t]; ++k) owner[u++] = static_cast<std::uint8_t>(t);
  }
}

/// Shells per thread from which whole shells are dealt out, with all that is in them.
constexpr std::size_t kManyShells = 8;

/// Parts of the space-filling curve with the given shares of all pairs. Grains of a large scene lie along it, size
/// class by size class: what a thread owns is a few ranges of slots, and its pairs are neighbours in the list. What is
/// in one of many shells goes with the shell. Planes belong to the first thread.
template <int D>
std::vector<std::uint8_t> owners_by_place(const System<D>& s, const std::vector<double>& share,
                                          std::vector<std::uint8_t>& thread_of) {
  const auto& p = s.particles;
  const std::vector<std::uint16_t> part = curve_parts(s);
  const bool whole_shells = static_cast<std::size_t>(p.shells) >= kManyShells * share.size();
  const auto part_of = [&](std::size_t body) {
    while (whole_shells && p.shell[body] >= 0) body = at(p.shell[body]);
    return part[body];
  };
  std::vector<std::uint16_t> group(p.sphere.size(), 0);
  for (std::size_t u = 0; u < part.size(); ++u) group[u] = part_of(u);
  std::vector<std::uint8_t> owner = owners_of(s, group, kCurveParts, share, thread_of);
  if (!whole_shells) put_in_rows(p, share.size(), owner);
  return owner;
}

/// Ranges of slots with the given shares of all pairs: for bodies that do not lie in spatial order.
template <int D>
std::vector<std::uint8_t> owners_by_slot(const System<D>& s, const std::vector<double>& share) {
  std::vector<Slot> group(s.particles.sphere.size());
  std::iota(group.begin(), group.end(), 0);
  std::vector<std::uint8_t> thread_of;
  return owners_of(s, group, group.size(), share, thread_of);
}

std::vector<std::vector<BodyRange>> stretches_of(const std::vector<std::uint8_t>& owner, std::size_t threads) {
  std::vector<std::vector<BodyRange>> stretches(threads);
  for (std::size_t begin = 0, end = 0; begin < owner.size(); begin = end) {
    while (end < owner.size() && owner[end] == owner[begin]) ++end;
    stretches[owner[begin]].push_back({begin, end});
  }
  return stretches;
}

/// Bodies of a stretch, on average, below which bodies count as not in spatial order.
constexpr std::size_t kShort = 16;

bool long_ones(const std::vector<std::vector<BodyRange>>& stretches, std::size_t bodies) {
  std::size_t many = 0;
  for (const auto& of_thread : stretches) many += of_thread.size();
  return many * kShort <= bodies;
}

/// The pairs of section k with a body of the thread.
template <int D>
void fill_share(const System<D>& s, std::size_t k, std::uint8_t thread, Plan<D>& plan) {
  const ContactSection& section = s.contacts.sections[k];
  Share<D>& share = plan.shares[thread][k];
  share.segments.clear();
  share.foreign.clear();
  const auto extend = [&](std::int32_t at, bool foreign) {
    if (!share.segments.empty() && share.segments.back().foreign == foreign && share.segments.back().end == at)
      share.segments.back().end = at + 1;
    else
      share.segments.push_back({at, at + 1, foreign});
  };
  for (std::int32_t c = section.begin; c < section.end; ++c) {
    const std::uint8_t first = plan.owner[at(s.contacts.i[at(c)])];
    const std::uint8_t second = plan.owner[at(s.contacts.j[at(c)])];
    if (first == thread) {
      plan.split[at(c)] = second != thread ? 1 : 0;
      extend(c, false);
    } else if (second == thread) {
      extend(static_cast<std::int32_t>(share.foreign.place.size()), true);
      share.foreign.add(s.contacts, c);
    }
  }
}

/// Every body of another thread once that is in a pair with one of this thread.
template <int D>
std::vector<Slot> neighbours_of(const System<D>& s, std::uint8_t thread, const Plan<D>& plan) {
  std::vector<std::uint8_t> seen(plan.owner.size(), 0);
  std::vector<Slot> out;
  const auto see = [&](Slot body) {
    if (plan.owner[at(body)] == thread || seen[at(body)] != 0) return;
    seen[at(body)] = 1;
    out.push_back(body);
  };
  for (const Share<D>& share : plan.shares[thread])
    for (const Segment& segment : share.segments)
      for (std::int32_t k = segment.begin; k < segment.end; ++k)
        see(segment.foreign ? share.foreign.i[at(k)] : s.contacts.j[at(k)]);
  std::sort(out.begin(), out.end());
  return out;
}

template <int D>
void make_plan(const System<D>& s, std::size_t threads, Plan<D>& plan) {
  plan.pace.share_out(threads);
  plan.owner = owners_by_place(s, plan.pace.share, plan.thread_of);
  plan.bodies = stretches_of(plan.owner, threads);
  if (!long_ones(plan.bodies, plan.owner.size())) {
    plan.owner = owners_by_slot(s, plan.pace.share);
    plan.bodies = stretches_of(plan.owner, threads);
  }
  plan.pieces.clear();
  for (std::size_t begin = 0; begin < plan.owner.size(); begin += kPieceLength)
    plan.pieces.push_back(plan.owner[(begin + std::min(begin + kPieceLength, plan.owner.size())) / 2]);
  plan.build = s.contacts.build;
  plan.split.resize(s.contacts.i.size());
  plan.shares.resize(threads);
  plan.neighbours.resize(threads);
  for (auto& of_thread : plan.shares) of_thread.resize(s.contacts.sections.size());
  const int many = static_cast<int>(threads);
#pragma omp parallel for schedule(static, 1) num_threads(many)
  for (int t = 0; t < many; ++t) {
    const auto thread = static_cast<std::uint8_t>(t);
    for (std::size_t k = 0; k < s.contacts.sections.size(); ++k) fill_share(s, k, thread, plan);
    plan.neighbours[thread] = neighbours_of(s, thread, plan);
  }
}

template <int D>
class Pass {
 public:
  Pass(System<D>& s, const BlockPass<D>& asked, Plan<D>& plan) : s_(s), asked_(asked), plan_(plan) {}

  /// What it takes a thread decides on its later share, never on a sum.
  void timed(std::size_t thread, void (Pass::*work)(std::size_t)) {
    const double begin = omp_get_wtime();
    (this->*work)(thread);
    plan_.pace.seconds[thread] += omp_get_wtime() - begin;
  }

  /// Copies what other threads change in the pass, and calls what they have written since the last one into the cache.
  void fetch(std::size_t thread) {
    const auto& p = s_.particles;
    for (const Slot body : plan_.neighbours[thread]) {
      __builtin_prefetch(&p.sphere[at(body)]);
      __builtin_prefetch(&p.velocity[at(body)]);
      __builtin_prefetch(&p.spin[at(body)]);
    }
    for (Share<D>& share : plan_.shares[thread]) share.foreign.copy_histories(s_.contacts);
  }

  /// The particle pass.
  void add_shares(std::size_t thread) {
    clear_particle_sums(s_, part(thread));
    for (std::size_t k = 0; k < s_.contacts.sections.size(); ++k) {
      const Share<D>& share = plan_.shares[thread][k];
      for (const Segment& segment : share.segments)
        add_particle_shares<D>(s_, s_.contacts.sections[k], {segment.begin, segment.end},
                               {.part = part(thread), .foreign = segment.foreign ? &share.foreign : nullptr});
    }
    close_particle_sums<D>(s_, part(thread));
  }

  void add_forces(std::size_t thread) {
    BlockPass<D> pass = asked_;
    pass.part = part(thread);
    for (std::size_t k = 0; k < s_.contacts.sections.size(); ++k) {
      const Share<D>& share = plan_.shares[thread][k];
      for (const Segment& segment : share.segments) {
        pass.foreign = segment.foreign ? &share.foreign : nullptr;
        block_loop<D>(s_, s_.contacts.sections[k], {segment.begin, segment.end}, pass);
      }
    }
  }

 private:
  [[nodiscard]] ThreadPart part(std::size_t thread) const {
    return {plan_.owner.data(), plan_.split.data(), static_cast<std::uint8_t>(thread)};
  }

  System<D>& s_;
  BlockPass<D> asked_;
  Plan<D>& plan_;
};

}  // namespace

template <int D>
void parallel_pass(System<D>& s, const BlockPass<D>& asked, int threads) {
  auto& plan = s.contacts.plan.template get<Plan<D>>();
  const int many = std::min(threads, 255);
  if (plan.pace.forget_changed() || plan.build != s.contacts.build ||
      plan.shares.size() != static_cast<std::size_t>(many) || plan.pace.uneven())
    make_plan(s, static_cast<std::size_t>(many), plan);
  Pass<D> pass(s, asked, plan);
  const bool sums = !s.contacts.particle_sum.empty();
#pragma omp parallel num_threads(many)
  {
#pragma omp for schedule(static, 1)
    for (int t = 0; t < many; ++t) {
      pass.timed(static_cast<std::size_t>(t), &Pass<D>::fetch);
      if (sums) pass.timed(static_cast<std::size_t>(t), &Pass<D>::add_shares);
    }
#pragma omp for schedule(static, 1)
    for (int t = 0; t < many; ++t) pass.timed(static_cast<std::size_t>(t), &Pass<D>::add_forces);
  }
  ++plan.pace.passes;
}

namespace {

/// The plan of the last pass, if bodies may be dealt out by it.
template <int D>
const Plan<D>* valid_plan(System<D>& s) {
  const auto threads = static_cast<std::size_t>(std::min(omp_get_max_threads(), 255));
  if (threads < 2 || omp_in_parallel() != 0) return nullptr;
  const auto& plan = s.contacts.plan.template get<Plan<D>>();
  const bool good = plan.build == s.contacts.build && plan.bodies.size() == threads;
  return good && plan.owner.size() == s.particles.sphere.size() ? &plan : nullptr;
}

}  // namespace

template <int D>
const std::vector<std::vector<BodyRange>>* owned_bodies(System<D>& s) {
  const Plan<D>* const plan = valid_plan(s);
  return plan != nullptr ? &plan->bodies : nullptr;
}

template <int D>
std::vector<PartSize> part_sizes(System<D>& s) {
  const Plan<D>* const plan = valid_plan(s);
  std::vector<PartSize> out(plan != nullptr ? plan->shares.size() : 0);
  for (std::size_t t = 0; t < out.size(); ++t) {
    for (const Share<D>& share : plan->shares[t]) {
      for (const Segment& segment : share.segments) out[t].pairs += segment.end - segment.begin;
      out[t].foreign += std::ssize(share.foreign.place);
    }
    out[t].neighbours = std::ssize(plan->neighbours[t]);
  }
  return out;
}

template <int D>
const PieceThreads* piece_threads(System<D>& s) {
  const Plan<D>* const plan = valid_plan(s);
  return plan != nullptr ? &plan->pieces : nullptr;
}

template const std::vector<std::vector<BodyRange>>* owned_bodies(System<2>&);
template const std::vector<std::vector<BodyRange>>* owned_bodies(System<3>&);
template std::vector<PartSize> part_sizes(System<2>&);
template std::vector<PartSize> part_sizes(System<3>&);
template const PieceThreads* piece_threads(System<2>&);
template const PieceThreads* piece_threads(System<3>&);
template void parallel_pass<2>(System<2>&, const BlockPass<2>&, int);
template void parallel_pass<3>(System<3>&, const BlockPass<3>&, int);

}  // namespace softgrain
