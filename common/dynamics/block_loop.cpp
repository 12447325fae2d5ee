#include "common/dynamics/block_loop.h"

#include <cmath>

#include "common/dynamics/block_gather.h"

namespace softgrain {

namespace {

using namespace block;

/// Forces of a range of pairs.
template <int D, LawTraits kTraits, Geometry kGeometry, bool kPeriodic, PairSource kSource>
class Loop : Gatherer<D, kTraits, kGeometry, kPeriodic, kSource> {
  using Base = Gatherer<D, kTraits, kGeometry, kPeriodic, kSource>;
  using Base::block_, Base::list_, Base::pass_, Base::s_, Base::u, Base::kRolls, Base::kForeign;

 public:
  using Base::Base;

  void run() {
    const PairRange& range = this->range_;
    if (!kForeign && pass_.virials != nullptr)
      std::fill(pass_.virials + range.begin, pass_.virials + range.end, Vec<D>{});
    for (std::int32_t k = range.begin; k < range.end; k += kBlock) {
      this->find_touching(k, std::min(k + kBlock, range.end));
      if (block_.touching == 0) continue;
      this->gather();
      this->kernel_(pass_.dt, pass_.stiffness != nullptr, block_);
      if (kForeign && pass_.forces != nullptr)
        store_forces();
      else if (pass_.stiffness != nullptr)
        scatter<true>();
      else
        scatter<false>();
    }
  }

 private:
  /// Rows become records again and go to the bodies of this thread in the order of the range. Of walls, which many
  /// contacts in a row share, the sums stay at hand.
  template <bool kStiffness>
  void scatter() {
    if (kForeign || pass_.part.split == nullptr)
      scatter_to<kStiffness, !kForeign>([](std::size_t) { return true; });
    else
      scatter_to<kStiffness, true>([split = pass_.part.split](std::size_t c) { return split[c] == 0; });
    if (!kForeign && pass_.virials != nullptr) store_virials();
  }

  /// `mine`: whether the second body of the contact at a place is of this thread.
  template <bool kStiffness, bool kFirst, class Mine>
  void scatter_to(const Mine& mine) {
    const Slot* const first = this->first_bodies().data();
    const Slot* const second = this->second_bodies().data();
    Stored<D>* const forces = s_.particles.force.data();
    StoredRot<D>* const torques = s_.particles.torque.data();
    [[maybe_unused]] Slot wall = -1;
    [[maybe_unused]] Quad wall_force{}, wall_torque{};
    const auto let_go = [&] {
      if (wall < 0) return;
      store(forces[u(wall)], wall_force);
      if constexpr (kTraits.has_tangential) store(torques[u(wall)], wall_torque);
      wall = -1;
    };
    for_records([&](int k, std::size_t c, Quad force, Quad moment) {
      const std::size_t i = u(first[c]);
      const std::size_t j = u(second[c]);
      const bool to_second = mine(c);
      if constexpr (kStiffness) {
        if constexpr (kFirst) add_stiffness_to_first(k, i);
        if (to_second) add_stiffness_to_second(k, j);
      }
      if constexpr (kFirst) {
        store(forces[i], quad_of(forces[i]) + force);
        if constexpr (kTraits.has_tangential) store(torques[i], quad_of(torques[i]) - moment * block_.arm_i.v[k]);
        if constexpr (kTraits.has_rolling) add_rolling(k, 1.0, torques[i]);
      }
      if (!to_second) return;
      if constexpr (kWalls) {
        if (wall != second[c]) {
          let_go();
          wall = second[c];
          wall_force = quad_of(forces[j]);
          if constexpr (kTraits.has_tangential) wall_torque = quad_of(torques[j]);
        }
        wall_force -= force;
        if constexpr (kTraits.has_tangential) wall_torque -= moment * block_.arm_j.v[k];
      } else {
        store(forces[j], quad_of(forces[j]) - force);
        if constexpr (kTraits.has_tangential) store(torques[j], quad_of(torques[j]) - moment * block_.arm_j.v[k]);
      }
      if constexpr (kTraits.has_rolling) {
        if constexpr (kWalls) let_go();
        add_rolling(k, -1.0, torques[j]);
      }
    });
    if constexpr (kWalls) let_go();
  }

  /// The moment of rolling resistance of contact number k of the block, with its sign on the body.
  void add_rolling(int k, double sign, StoredRot<D>& torque) const {
    if constexpr (kRolls) {
      for (std::size_t a = 0; a < D; ++a) torque[static_cast<int>(a)] += sign * block_.roll_moment[a].v[k];
    } else if constexpr (kTraits.has_rolling) {
      torque[0] += sign * block_.rolling.v[k];
    }
  }

  /// Rotational stiffness of contact number k of the block for a body with this arm.
  [[nodiscard]] double rotation_of(int k, [[maybe_unused]] double arm) const {
    double rotation = 0.0;
    if constexpr (kTraits.has_tangential) rotation = block_.tangential_stiffness.v[k] * arm * arm;
    if constexpr (kRolls) rotation += block_.rolling_stiffness.v[k];
    return rotation;
  }
  void add_stiffness_to_first(int k, std::size_t body) const {
    BodyStiffness& to = *pass_.stiffness;
    const double force = std::abs(block_.normal_force.v[k]);
    to.translation[body] += block_.stiffness.v[k];
    to.rotation[body] += rotation_of(k, block_.arm_i.v[k]);
    to.force[body] += force;
    to.contacts[body] += force != 0.0 ? 1 : 0;
  }
  void add_stiffness_to_second(int k, std::size_t body) const {
    BodyStiffness& to = *pass_.stiffness;
    to.translation[body] += block_.stiffness.v[k];
    to.rotation[body] += rotation_of(k, block_.arm_j.v[k]);
  }

  void store_virials() {
    for (int k = 0; k < block_.touching; ++k)
      for (int a = 0; a < D; ++a)
        pass_.virials[u(block_.pair[u(k)])][a] =
            block_.force[static_cast<std::size_t>(a)].v[k] * block_.branch[static_cast<std::size_t>(a)].v[k];
  }

  void store_forces() {
    for_records([&](int, std::size_t c, Quad force, Quad) { store(pass_.forces[c], force); });
  }

  /// work(number in the block, place of the pair, force, moment) for every touching pair; keeps the new history.
  template <class Work>
  void for_records(Work&& work) {
    const bool next = pass_.history == History::next;
    const bool keep = !kForeign && pass_.history != History::none;
    Stored<D>* const springs = next ? list_.spring_next.data() : list_.spring.data();
    double* const memories = next ? list_.memory_next.data() : list_.memory.data();
    [[maybe_unused]] Stored<D>* const rolls = next ? list_.roll_next.data() : list_.roll.data();
    for (int g = 0; g < block_.touching; g += 4) {
      const std::array<Quad, 4> force = quads<D>(block_.force, g);
      std::array<Quad, 4> moment{}, spring;
      if constexpr (kTraits.has_tangential) {
        moment = quads<kRot<D>>(block_.moment, g);
        spring = quads<D>(block_.spring, g);
      }
      const int many = std::min(4, block_.touching - g);
      for (int l = 0; l < many; ++l) {
        const std::size_t c = u(block_.pair[u(g + l)]);
        work(g + l, c, force[u(l)], moment[u(l)]);
        if constexpr (kTraits.has_tangential)
          if (keep) store(springs[c], spring[u(l)]);
        if constexpr (kTraits.has_memory)
          if (keep) memories[c] = block_.memory.v[g + l];
        if constexpr (kRolls)
          if (keep) rolls[c] = Vec<D>{{block_.roll[0].v[g + l], block_.roll[1].v[g + l], block_.roll[2].v[g + l]}};
      }
    }
  }

  template <int N>
  static std::array<Quad, 4> quads(const Rows<N>& rows, int g) {
    std::array<Quad, 4> q{};
    for (std::size_t c = 0; c < static_cast<std::size_t>(N); ++c) q[c] = load_quad(rows[c].v + g);
    transpose(q[0], q[1], q[2], q[3]);
    return q;
  }

  static constexpr bool kWalls = kGeometry != Geometry::sphere_sphere;
};
template <int D, LawTraits kTraits, Geometry kGeometry>
void run_loop(System<D>& s, const Kernel<D>& kernel, const PairRange& range, const BlockPass<D>& pass) {
  const auto run = [&]<PairSource kSource>(auto periodic) {
    Loop<D, kTraits, kGeometry, decltype(periodic)::value, kSource>(s, kernel, range, pass).run();
  };
  const auto from_source = [&](auto periodic) {
    if (pass.foreign != nullptr)
      run.template operator()<PairSource::foreign>(periodic);
    else
      run.template operator()<PairSource::list>(periodic);
  };
  if constexpr (kGeometry != Geometry::sphere_plane)
    if (s.cell.any_periodic()) return from_source(std::true_type{});
  from_source(std::false_type{});
}

}  // namespace

template <int D>
void ForeignPairs<D>::clear() {
  place.clear();
  i.clear();
  j.clear();
  image.clear();
  constants.clear();
}

template <int D>
void ForeignPairs<D>::add(const ContactList<D>& list, std::int32_t at) {
  const auto c = static_cast<std::size_t>(at);
  place.push_back(at);
  i.push_back(list.i[c]);
  j.push_back(list.j[c]);
  image.push_back(list.image[c]);
  constants.push_back(list.constants[c]);
}

template <int D>
void ForeignPairs<D>::copy_histories(const ContactList<D>& list) {
  const auto copy = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.resize(place.size());
    for (std::size_t n = 0; n < place.size(); ++n) {
      const auto c = static_cast<std::size_t>(place[n]);
      if (list.touched[c] != 0)  // else known to be empty
        to[n] = from[c];
      else
        to[n] = {};
    }
  };
  copy(list.spring, spring);
  copy(list.memory, memory);
  copy(list.roll, roll);
}

template struct ForeignPairs<2>;
template struct ForeignPairs<3>;

void BodyStiffness::clear(std::size_t bodies) {
  translation.assign(bodies, 0.0);
  rotation.assign(bodies, 0.0);
  force.assign(bodies, 0.0);
  contacts.assign(bodies, 0);
}

double BodyStiffness::mean_force() const {
  double sum = 0.0;
  std::int64_t many = 0;
  for (std::size_t u = 0; u < force.size(); ++u) {
    sum += force[u];
    many += contacts[u];
  }
  return many > 0 ? sum / static_cast<double>(many) : 0.0;
}

template <int D>
void block_loop(System<D>& s, const ContactSection& section, const PairRange& range, const BlockPass<D>& pass) {
  open(s, section, [&]<class Law>(const Law& law, auto geometry) {
    constexpr Geometry kGeometry = decltype(geometry)::value;
    Kernel<D> kernel{&law, &evaluate<D, kGeometry, Law>, reach_of(law), {}};
    if constexpr (Law::traits.needs_particle_pass) kernel.sums = law.soft_sides();
    run_loop<D, seen_by_loop(Law::traits), kGeometry>(s, kernel, range, pass);
  });
}

template <int D>
void block_loop(System<D>& s, const BlockPass<D>& pass) {
  for (const ContactSection& section : s.contacts.sections) block_loop(s, section, {section.begin, section.end}, pass);
}
template void block_loop<2>(System<2>&, const ContactSection&, const PairRange&, const BlockPass<2>&);
template void block_loop<3>(System<3>&, const ContactSection&, const PairRange&, const BlockPass<3>&);
template void block_loop<2>(System<2>&, const BlockPass<2>&);
template void block_loop<3>(System<3>&, const BlockPass<3>&);

}  // namespace softgrain
