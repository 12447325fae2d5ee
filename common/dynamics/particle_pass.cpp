#include "common/dynamics/parallel_pass.h"

#include <algorithm>

#include "common/dynamics/block_gather.h"

namespace softgrain {

namespace {

using namespace block;

bool is_own(ThreadPart part, Slot body) { return part.owner == nullptr || part.owner[at(body)] == part.thread; }

template <class Law>
constexpr LawTraits kAskedOfShares{.has_memory = Law::traits.memory_in_sums,
                                   .directions_in_sums = Law::traits.directions_in_sums,
                                   .is_multi_contact = true};

/// The first half of the particle pass: what every contact takes from its bodies.
template <class Law, Geometry kGeometry, bool kPeriodic, PairSource kSource>
class Shares : Gatherer<3, kAskedOfShares<Law>, kGeometry, kPeriodic, kSource> {
  using Base = Gatherer<3, kAskedOfShares<Law>, kGeometry, kPeriodic, kSource>;
  using Base::block_, Base::list_, Base::u, Base::kForeign;

 public:
  Shares(System<3>& s, const Law& law, const PairRange& range, const BlockPass<3>& pass)
      : Base(s, {&law, &take<3, kGeometry, Law>, 0.0, law.soft_sides()}, range, pass), law_(law) {}

  void run() {
    for (std::int32_t k = this->range_.begin; k < this->range_.end; k += kBlock) {
      this->find_touching(k, std::min(k + kBlock, this->range_.end));
      if (block_.touching == 0) continue;
      this->gather();
      this->kernel_(0.0, false, block_);
      for (int n = 0; n < block_.touching; ++n) add(n);
    }
  }

 private:
  void add(int n) {
    const std::size_t c = u(block_.pair[u(n)]);
    const Quad normal{block_.normal[0].v[n], block_.normal[1].v[n], block_.normal[2].v[n], 0.0};
    const Slot i = this->first_bodies()[c];
    const Slot j = this->second_bodies()[c];
    if constexpr (!kForeign) {
      if (law_.i_is_soft) list_.lost_i[c] = block_.lost_i.v[n];
      if (law_.j_is_soft) list_.lost_j[c] = block_.lost_j.v[n];
      if (law_.i_is_soft) add(block_.lost_i.v[n], -normal, list_.particle_sum[u(i)]);
    }
    const std::uint8_t* const split = this->pass_.part.split;
    if (law_.j_is_soft && (kForeign || split == nullptr || split[c] == 0))
      add(block_.lost_j.v[n], normal, list_.particle_sum[u(j)]);
  }

  /// Law::add, four numbers at once.
  static void add(double nu, Quad n, MultiContactSum<3>& sum) {
    double* const numbers = &sum.volume;
    const auto to = [&](int group, Quad more) {
      store_quad(numbers + 4 * group, load_quad(numbers + 4 * group) + more);  // NOLINT: they lie in groups of four
    };
    to(0, Quad{nu, 0.0, 0.0, nu * nu});
    if constexpr (Law::traits.directions_in_sums) {
      const Quad first = n * nu;
      to(1, Quad{first[0], first[1], first[2], first[0] * n[0]});
      to(2, Quad{first[0], first[0], first[1], first[1]} * Quad{n[1], n[2], n[1], n[2]});
      sum.second[5] += first[2] * n[2];
    }
  }

  const Law& law_;
};

/// Closes sums, several at a time.
template <class Law>
class Closing {
 public:
  Closing(const Law& law, const std::vector<double>& largest)
      : law_(law), largest_(law.remembers() && !largest.empty() ? largest.data() : nullptr) {}

  void add(Slot body, MultiContactSum<3>& sum) {
    if (!(sum.square > 0.0)) return;
    waiting_[static_cast<std::size_t>(many_)] = &sum;
    volume_.v[many_] = law_.equivalent(sum);
    if (largest_ != nullptr) most_.v[many_] = largest_[at(body)];
    if (++many_ == kLanes) close();
  }
  void close() {
    for (int l = many_; l < kLanes; ++l) volume_.v[l] = volume_.v[0];
    MultiContactSum<3, Lanes> sum;
    if (largest_ != nullptr)
      unload(sum);
    else if (many_ > 0)
      sum.close(law_.form.pressure, volume_.at(0));
    for (int l = 0; l < many_; ++l) {
      waiting_[static_cast<std::size_t>(l)]->gain = sum.gain[static_cast<std::size_t>(l)];
      waiting_[static_cast<std::size_t>(l)]->gain_slope = sum.gain_slope[static_cast<std::size_t>(l)];
    }
    many_ = 0;
  }

 private:
  void unload(MultiContactSum<3, Lanes>& sum) {
    for (int l = many_; l < kLanes; ++l) most_.v[l] = most_.v[0];
    if (many_ > 0) sum.close(law_.form.pressure, volume_.at(0), most_.at(0), law_.unloading_ratio);
  }

  const Law& law_;
  const double* largest_;  ///< per body, of laws that remember it; else null
  int many_ = 0;
  std::array<MultiContactSum<3>*, static_cast<std::size_t>(kLanes)> waiting_{};
  Row volume_{};
  Row most_{};
};

}  // namespace

template <>
void add_particle_shares(System<2>&, const ContactSection&, const PairRange&, const BlockPass<2>&) {}

template <>
void add_particle_shares(System<3>& s, const ContactSection& section, const PairRange& range,
                         const BlockPass<3>& pass) {
  open(s, section, [&]<class Law>(const Law& law, auto geometry) {
    constexpr Geometry kGeometry = decltype(geometry)::value;
    if constexpr (Law::traits.needs_particle_pass) {
      const auto run = [&]<bool kPeriodic>() {
        if (pass.foreign != nullptr)
          Shares<Law, kGeometry, kPeriodic, PairSource::foreign>(s, law, range, pass).run();
        else
          Shares<Law, kGeometry, kPeriodic, PairSource::list>(s, law, range, pass).run();
      };
      if (kGeometry == Geometry::sphere_sphere && s.cell.any_periodic())
        run.template operator()<true>();
      else
        run.template operator()<false>();
    }
  });
}

template <int D>
void clear_particle_sums(System<D>& s, ThreadPart part) {
  for (const MultiContactBody& multi_contact : s.contacts.multi_contact_bodies)
    if (is_own(part, multi_contact.body)) s.contacts.particle_sum[at(multi_contact.body)] = {};
}

template <>
void close_particle_sums(System<2>&, ThreadPart) {}

template <>
void close_particle_sums(System<3>& s, ThreadPart part) {
  const auto& bodies = s.contacts.multi_contact_bodies;
  for (std::size_t begin = 0, end = 0; begin < bodies.size(); begin = end) {
    while (end < bodies.size() && bodies[end].law == bodies[begin].law) ++end;
    std::visit(
        [&]<class Law>(const Law& law) {
          if constexpr (Law::traits.needs_particle_pass) {
            Closing<Law> closing(law, s.particles.largest_volume);
            for (std::size_t k = begin; k < end; ++k)
              if (is_own(part, bodies[k].body))
                closing.add(bodies[k].body, s.contacts.particle_sum[at(bodies[k].body)]);
            closing.close();
          }
        },
        s.laws.law(bodies[begin].law));
  }
}

template <>
void keep_largest_volumes(System<2>&) {}

template <>
void keep_largest_volumes(System<3>& s) {
  std::vector<double>& largest = s.particles.largest_volume;
  for (const MultiContactBody& one : s.contacts.multi_contact_bodies)
    std::visit(
        [&]<class Law>(const Law& law) {
          if constexpr (Law::traits.needs_particle_pass) {
            if (!law.remembers()) return;
            largest.resize(s.particles.sphere.size(), 0.0);
            double& most = largest[at(one.body)];
            most = std::max(most, law.equivalent(s.contacts.particle_sum[at(one.body)]));
          }
        },
        s.laws.law(one.law));
}

template <int D>
void particle_pass(System<D>& s) {
  if (s.contacts.particle_sum.empty()) return;
  clear_particle_sums(s, {});
  for (const ContactSection& section : s.contacts.sections)
    add_particle_shares<D>(s, section, {section.begin, section.end}, {});
  close_particle_sums<D>(s, {});
}

template void clear_particle_sums<2>(System<2>&, ThreadPart);
template void clear_particle_sums<3>(System<3>&, ThreadPart);
template void particle_pass<2>(System<2>&);
template void particle_pass<3>(System<3>&);

}  // namespace softgrain
