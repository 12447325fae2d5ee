#include "common/dynamics/parallel_pass.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/dynamics/block_loop.h"
#include "common/dynamics/thread_choice.h"
#include "common/neighbours/spatial_order.h"

namespace softgrain {

namespace {

/// A pair whose load another thread, or this one, has stored, and one of its bodies here.
struct Waiting {
  std::int32_t place = 0;  ///< place of the pair in the list
  std::int32_t thread = 0;
  std::int32_t number = 0;
  bool first = false;  ///< the body here is the first of the pair
};

/// Pairs of one section that concern one thread.
struct Share {
  std::vector<std::int32_t> inner;   ///< places in the list of pairs whose bodies are both the thread's
  std::vector<PairRange> touching;   ///< stretches of the list that hold all pairs with a body of the thread
  std::vector<PairRange> stretches;  ///< stretches that hold all of inner, else only pairs of two threads
  std::vector<std::int32_t> outer;   ///< places of the pairs with bodies of two threads that this thread evaluates
  std::vector<ContactLoad> loads;    ///< loads of the outer pairs
  std::vector<ContactRoll> rolls;    ///< rolling moments of the outer pairs, in space where a law has them
  std::vector<ContactStiffness> stiffnesses;  ///< stiffnesses of the outer pairs, where they have been asked for
  std::vector<std::uint8_t> touches;          ///< whether each outer pair touches
  std::vector<Waiting> waiting;               ///< bodies here of all pairs whose loads were stored, in list order

  void clear() {
    inner.clear();
    touching.clear();
    stretches.clear();
    outer.clear();
    waiting.clear();
  }
};

/// Who does what, good for one list and number of threads.
struct Plan {
  ThreadPace pace;
  std::uint64_t build = 0;
  bool rolls = false;               ///< some law of the scene has rolling resistance
  bool shares_sums = false;         ///< the particle pass goes by threads: they find their pairs in long stretches
  std::vector<std::uint8_t> owner;  ///< thread of every body
  std::vector<std::vector<BodyRange>> bodies;  ///< bodies of each thread, as stretches
  std::vector<std::uint8_t> lent;              ///< flag per place in the list, 1: the pair has bodies of two threads
  std::vector<std::vector<Share>> shares;      ///< [thread][section]
};

/// Stretches of the space-filling curve with the given shares of all pairs. Grains of a large scene lie along it, size
/// class by size class: what a thread owns is a few ranges of slots, and its pairs are neighbours in the list. Walls
/// belong to the first thread.
template <int D>
std::vector<std::uint8_t> owners_of(const System<D>& s, const std::vector<double>& share) {
  const std::vector<std::uint16_t> part = curve_parts(s);
  std::vector<std::int64_t> pairs(kCurveParts, 0);
  for (const Slot i : s.contacts.i) ++pairs[part[at(i)]];
  std::vector<std::uint8_t> thread_of(kCurveParts, 0);
  double left = share.front() * static_cast<double>(s.contacts.i.size());
  std::size_t thread = 0;
  for (std::size_t b = 0; b < kCurveParts; ++b) {
    const auto here = static_cast<double>(pairs[b]);
    while (thread + 1 < share.size() && left < 0.5 * here)
      left += share[++thread] * static_cast<double>(s.contacts.i.size());
    thread_of[b] = static_cast<std::uint8_t>(thread);
    left -= here;
  }
  std::vector<std::uint8_t> owner(s.particles.sphere.size(), 0);
  for (std::size_t u = 0; u < part.size(); ++u) owner[u] = thread_of[part[u]];
  return owner;
}

/// Stretches of bodies of each thread. Empty where bodies do not lie in spatial order, so that stretches are short.
std::vector<std::vector<BodyRange>> stretches_of(const std::vector<std::uint8_t>& owner, std::size_t threads) {
  constexpr std::size_t kShort = 4;
  std::size_t many = 0;
  std::vector<std::vector<BodyRange>> stretches(threads);
  for (std::size_t begin = 0, end = 0; begin < owner.size(); begin = end) {
    while (end < owner.size() && owner[end] == owner[begin]) ++end;
    stretches[owner[begin]].push_back({begin, end});
    ++many;
  }
  if (many * kShort > owner.size()) stretches.clear();
  return stretches;
}

/// Pairs of two threads in a row that a stretch goes over, and the pairs of a stretch, on average, from which it pays
/// to go along stretches.
constexpr std::int32_t kBridge = 16;
constexpr std::size_t kLongStretch = 64;

/// Adds the pair at c, the next one whose bodies are both the thread's.
void stretch_to(std::int32_t c, bool in_a_row, std::vector<PairRange>& stretches) {
  if (in_a_row && !stretches.empty() && c - stretches.back().end <= kBridge)
    stretches.back().end = c + 1;
  else
    stretches.push_back({c, c + 1});
}

bool long_ones(const std::vector<PairRange>& stretches) {
  std::size_t pairs = 0;
  for (const PairRange& stretch : stretches) pairs += static_cast<std::size_t>(stretch.end - stretch.begin);
  return pairs >= kLongStretch * stretches.size();
}

/// Who evaluates pairs of two threads: the one that has fewer of them for its share. All threads go along the list and
/// count alike.
class Lenders {
 public:
  explicit Lenders(const std::vector<double>& share) : share_(share), lent_(share.size(), 0) {}

  struct Lent {
    std::uint8_t thread = 0;
    std::int32_t number = 0;  ///< number of the pair among those of two threads that this thread evaluates
  };
  Lent next(std::uint8_t a, std::uint8_t b) {
    const std::uint8_t thread = lent_[a] * share_[b] <= lent_[b] * share_[a] ? a : b;
    return {thread, lent_[thread]++};
  }

 private:
  const std::vector<double>& share_;
  std::vector<std::int32_t> lent_;
};

/// Bodies of a pair and who owns them.
struct Owners {
  std::uint8_t first = 0;
  std::uint8_t second = 0;
};

template <int D>
Owners owners_at(const System<D>& s, const Plan& plan, std::int32_t c) {
  return {plan.owner[at(s.contacts.i[at(c)])], plan.owner[at(s.contacts.j[at(c)])]};
}

/// What a thread does in section k. Marks those lent pairs whose first body it owns.
template <int D>
void fill_share(const System<D>& s, std::size_t k, std::uint8_t thread, Plan& plan) {
  const ContactSection& section = s.contacts.sections[k];
  Share& share = plan.shares[thread][k];
  share.clear();
  Lenders lenders(plan.pace.share);
  std::size_t inner = 0;
  int last = -1;
  for (std::int32_t c = section.begin; c < section.end; ++c) {
    const auto [first, second] = owners_at(s, plan, c);
    if (plan.shares_sums && (first == thread || second == thread)) stretch_to(c, true, share.touching);
    if (first == second) {
      if (first == thread) {
        ++inner;
        stretch_to(c, last == first, share.stretches);
      }
      last = first;
      continue;
    }
    const Lenders::Lent lent = lenders.next(first, second);
    if (lent.thread == thread) share.outer.push_back(c);
    if (first == thread) share.waiting.push_back({c, lent.thread, lent.number, true});
    if (second == thread) share.waiting.push_back({c, lent.thread, lent.number, false});
    if (first == thread) plan.lent[at(c)] = 1;
  }
  share.loads.resize(share.outer.size());
  if (D == 3 && plan.rolls) share.rolls.resize(share.outer.size());
  share.touches.resize(share.outer.size());
  if (inner >= kLongStretch * share.stretches.size()) return;
  share.stretches.clear();
  for (std::int32_t c = section.begin; c < section.end; ++c)
    if (const Owners of = owners_at(s, plan, c); of.first == thread && of.second == thread) share.inner.push_back(c);
}

template <int D>
void make_plan(const System<D>& s, std::size_t threads, Plan& plan) {
  plan.pace.share_out(threads);
  plan.owner = owners_of(s, plan.pace.share);
  plan.bodies = stretches_of(plan.owner, threads);
  plan.build = s.contacts.build;
  plan.rolls = false;
  for (std::int32_t l = 0; l < s.laws.size(); ++l) plan.rolls = plan.rolls || traits_of(s.laws.law(l)).has_rolling;
  plan.shares_sums = !s.contacts.particle_sum.empty();
  plan.lent.assign(s.contacts.i.size() + 4, 0);  // the loop looks at four places at once
  plan.shares.resize(threads);
  for (auto& of_thread : plan.shares) of_thread.resize(s.contacts.sections.size());
  const int many = static_cast<int>(threads);
#pragma omp parallel for schedule(static, 1) num_threads(many)
  for (int t = 0; t < many; ++t)
    for (std::size_t k = 0; k < s.contacts.sections.size(); ++k) fill_share(s, k, static_cast<std::uint8_t>(t), plan);
  for (const auto& of_thread : plan.shares)
    for (const Share& share : of_thread) plan.shares_sums = plan.shares_sums && long_ones(share.touching);
}

/// The waiting loads of one thread and section.
template <int D>
class Waiters : public WaitingLoads {
 public:
  Waiters(System<D>& s, const Plan& plan, std::size_t thread, std::size_t section, BodyStiffness* stiffness)
      : s_(s), plan_(plan), section_(section), stiffness_(stiffness), waiting_(plan.shares[thread][section].waiting) {
    find_next();
  }

  void add_before(std::int32_t c) override {
    for (; at_ < waiting_.size() && waiting_[at_].place < c; ++at_) add(waiting_[at_]);
    find_next();
  }
  void add_all() { add_before(std::numeric_limits<std::int32_t>::max()); }

 private:
  void find_next() { next = at_ < waiting_.size() ? waiting_[at_].place : std::numeric_limits<std::int32_t>::max(); }

  void add(const Waiting& w) {
    const Share& from = plan_.shares[static_cast<std::size_t>(w.thread)][section_];
    const auto n = static_cast<std::size_t>(w.number);
    const auto c = static_cast<std::size_t>(w.place);
    const auto body = static_cast<std::size_t>(w.first ? s_.contacts.i[c] : s_.contacts.j[c]);
    if (from.touches[n] == 0) return;
    if (stiffness_ != nullptr) (w.first ? add_first : add_second)(from.stiffnesses[n], body, *stiffness_);
    const ContactLoad& load = from.loads[n];
    const double sign = w.first ? 1.0 : -1.0;
    const double arm = w.first ? load.arm_i : load.arm_j;
    for (int k = 0; k < D; ++k) s_.particles.force[body][k] += sign * load.force[k];
    for (int k = 0; k < (D == 3 ? 3 : 1); ++k) s_.particles.torque[body][k] -= load.moment[k] * arm;
    if (!plan_.rolls) return;
    if constexpr (D == 2)
      s_.particles.torque[body][0] += sign * load.moment[1];
    else
      for (int k = 0; k < 3; ++k) s_.particles.torque[body][k] += sign * from.rolls[n].moment[k];
  }

  System<D>& s_;
  const Plan& plan_;
  std::size_t section_;
  BodyStiffness* stiffness_;
  const std::vector<Waiting>& waiting_;
  std::size_t at_ = 0;
};

template <int D>
class Pass {
 public:
  Pass(System<D>& s, double dt, History history, Plan& plan, BodyStiffness* stiffness)
      : s_(s), dt_(dt), history_(history), plan_(plan), stiffness_(stiffness) {}

  /// What it takes a thread decides on its later share, never on a sum.
  void timed(std::size_t thread, void (Pass::*work)(std::size_t)) {
    const double begin = omp_get_wtime();
    (this->*work)(thread);
    plan_.pace.seconds[thread] += omp_get_wtime() - begin;
  }

  /// The two halves of the particle pass.
  void add_shares(std::size_t thread) {
    const OwnBodies own{plan_.owner.data(), static_cast<std::uint8_t>(thread)};
    clear_particle_sums(s_, own);
    for (std::size_t k = 0; k < s_.contacts.sections.size(); ++k)
      for (const PairRange& stretch : plan_.shares[thread][k].touching)
        add_particle_shares<D>(s_, s_.contacts.sections[k], stretch, own);
    close_particle_sums<D>(s_, own);
  }

  void put_down(std::size_t thread) {
    for (std::size_t k = 0; k < s_.contacts.sections.size(); ++k) {
      Share& share = plan_.shares[thread][k];
      const ContactSection& section = s_.contacts.sections[k];
      const PairRange range{0, static_cast<std::int32_t>(share.outer.size()), share.outer.data()};
      if (stiffness_ != nullptr) share.stiffnesses.resize(share.outer.size());
      block_loop<D>(s_, section, range,
                    {.dt = dt_,
                     .history = history_,
                     .loads = share.loads.data(),
                     .rolls = share.rolls.data(),
                     .touches = share.touches.data(),
                     .stiffnesses = stiffness_ != nullptr ? share.stiffnesses.data() : nullptr});
    }
  }

  void add(std::size_t thread) {
    for (std::size_t k = 0; k < s_.contacts.sections.size(); ++k) {
      const Share& share = plan_.shares[thread][k];
      const ContactSection& section = s_.contacts.sections[k];
      const PairRange range{0, static_cast<std::int32_t>(share.inner.size()), share.inner.data()};
      Waiters<D> waiting(s_, plan_, thread, k, stiffness_);
      const BlockPass<D> pass{
          .dt = dt_, .history = history_, .waiting = &waiting, .lent = plan_.lent.data(), .stiffness = stiffness_};
      if (range.end > 0) block_loop<D>(s_, section, range, pass);
      for (const PairRange& stretch : share.stretches) block_loop<D>(s_, section, stretch, pass);
      waiting.add_all();
    }
  }

 private:
  System<D>& s_;
  double dt_;
  History history_;
  Plan& plan_;
  BodyStiffness* stiffness_;
};

}  // namespace

template <int D>
void parallel_pass(System<D>& s, double dt, History history, int threads, BodyStiffness* stiffness) {
  Plan& plan = s.contacts.plan.template get<Plan>();
  const int many = std::min(threads, 255);
  if (plan.build != s.contacts.build || plan.shares.size() != static_cast<std::size_t>(many) || plan.pace.uneven())
    make_plan(s, static_cast<std::size_t>(many), plan);
  if (!plan.shares_sums) particle_pass(s);
  Pass<D> pass(s, dt, history, plan, stiffness);
#pragma omp parallel num_threads(many)
  {
    if (plan.shares_sums) {
#pragma omp for schedule(static, 1)
      for (int t = 0; t < many; ++t) pass.timed(static_cast<std::size_t>(t), &Pass<D>::add_shares);
    }
#pragma omp for schedule(static, 1)
    for (int t = 0; t < many; ++t) pass.timed(static_cast<std::size_t>(t), &Pass<D>::put_down);
#pragma omp for schedule(static, 1)
    for (int t = 0; t < many; ++t) pass.timed(static_cast<std::size_t>(t), &Pass<D>::add);
  }
  ++plan.pace.passes;
}

template <int D>
const std::vector<std::vector<BodyRange>>* owned_bodies(System<D>& s) {
  const auto threads = static_cast<std::size_t>(std::min(omp_get_max_threads(), 255));
  if (threads < 2 || omp_in_parallel() != 0) return nullptr;
  const Plan& plan = s.contacts.plan.template get<Plan>();
  const bool good = plan.build == s.contacts.build && plan.bodies.size() == threads;
  return good && plan.owner.size() == s.particles.sphere.size() ? &plan.bodies : nullptr;
}

template const std::vector<std::vector<BodyRange>>* owned_bodies(System<2>&);
template const std::vector<std::vector<BodyRange>>* owned_bodies(System<3>&);
template void parallel_pass<2>(System<2>&, double, History, int, BodyStiffness*);
template void parallel_pass<3>(System<3>&, double, History, int, BodyStiffness*);

}  // namespace softgrain
