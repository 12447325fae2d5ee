#include "common/dynamics/block_loop.h"

#include <cmath>

#include "common/dynamics/block_gather.h"

namespace softgrain {

namespace {

using namespace block;

/// Forces of a range of pairs.
template <int D, LawTraits kTraits, Geometry kGeometry, bool kPeriodic, PairSubset kSubset>
class Loop : Gatherer<D, kTraits, kGeometry, kPeriodic, kSubset> {
  using Base = Gatherer<D, kTraits, kGeometry, kPeriodic, kSubset>;
  using Base::block_, Base::list_, Base::pass_, Base::s_, Base::u, Base::kRolls;

 public:
  using Base::Base;

  void run() {
    const PairRange& range = this->range_;
    for (std::int32_t k = range.begin; k < range.end; k += kBlock) {
      this->find_touching(k, std::min(k + kBlock, range.end));
      if (block_.touching == 0) continue;
      this->gather();
      this->kernel_(pass_.dt, pass_.stiffness != nullptr || pass_.stiffnesses != nullptr, block_);
      if (pass_.loads != nullptr)
        put_down();
      else if (pass_.stiffness != nullptr)
        scatter<true>();
      else
        scatter<false>();
    }
  }

 private:
  /// Rows become records again and go to the bodies in the order of the range. Of walls, which many contacts in a row
  /// share, the sums stay at hand.
  template <bool kStiffness>
  void scatter() {
    const Slot* const first = list_.i.data();
    const Slot* const second = list_.j.data();
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
      if constexpr (kSubset != PairSubset::all)
        if (pass_.waiting != nullptr && pass_.waiting->next < static_cast<std::int32_t>(c)) {
          if constexpr (kWalls) let_go();
          pass_.waiting->add_before(static_cast<std::int32_t>(c));
        }
      const std::size_t i = u(first[c]);
      const std::size_t j = u(second[c]);
      if constexpr (kStiffness) {
        const ContactStiffness stiffness = stiffness_of(k);
        add_first(stiffness, i, *pass_.stiffness);
        add_second(stiffness, j, *pass_.stiffness);
      }
      store(forces[i], quad_of(forces[i]) + force);
      if constexpr (kTraits.has_tangential) store(torques[i], quad_of(torques[i]) - moment * block_.arm_i.v[k]);
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
        if constexpr (kRolls) {
          for (std::size_t a = 0; a < D; ++a) {
            torques[i][static_cast<int>(a)] += block_.roll_moment[a].v[k];
            torques[j][static_cast<int>(a)] -= block_.roll_moment[a].v[k];
          }
        } else {
          torques[i][0] += block_.rolling.v[k];
          torques[j][0] -= block_.rolling.v[k];
        }
      }
    });
    if constexpr (kWalls) let_go();
    if (pass_.virial != nullptr) add_virial(*pass_.virial);
  }

  /// Stiffness of contact number k of the block.
  [[nodiscard]] ContactStiffness stiffness_of(int k) const {
    ContactStiffness out{block_.stiffness.v[k], 0.0, 0.0, std::abs(block_.normal_force.v[k])};
    if constexpr (kTraits.has_tangential) {
      out.rotation_i = block_.tangential_stiffness.v[k] * block_.arm_i.v[k] * block_.arm_i.v[k];
      out.rotation_j = block_.tangential_stiffness.v[k] * block_.arm_j.v[k] * block_.arm_j.v[k];
    }
    if constexpr (kRolls) {
      out.rotation_i += block_.rolling_stiffness.v[k];
      out.rotation_j += block_.rolling_stiffness.v[k];
    }
    return out;
  }

  void add_virial(Vec<D>& out) {
    for (int k = 0; k < block_.touching; ++k)
      for (int a = 0; a < D; ++a)
        out[a] += block_.force[static_cast<std::size_t>(a)].v[k] * block_.branch[static_cast<std::size_t>(a)].v[k];
  }

  /// Stores the loads of the contacts, for bodies of other threads.
  void put_down() {
    for_records([&](int k, std::size_t, Quad force, Quad moment) {
      ContactLoad& load = pass_.loads[block_.number[u(k)]];
      if (pass_.stiffnesses != nullptr) pass_.stiffnesses[block_.number[u(k)]] = stiffness_of(k);
      if constexpr (kTraits.has_tangential) {
        force[3] = block_.arm_i.v[k];
        moment[3] = block_.arm_j.v[k];
      } else {
        force[3] = 0.0;
      }
      if constexpr (kRolls) {
        ContactRoll& roll = pass_.rolls[block_.number[u(k)]];
        for (std::size_t a = 0; a < D; ++a) roll.moment[a] = block_.roll_moment[a].v[k];
      } else if constexpr (kTraits.has_rolling) {
        moment[1] = block_.rolling.v[k];
      }
      store_quad(load.force, force);
      store_quad(load.moment, moment);
    });
  }

  /// work(number in the block, place in the list, force, moment) for every touching pair; keeps the new history.
  template <class Work>
  void for_records(Work&& work) {
    const bool next = pass_.history == History::next;
    const bool keep = pass_.history != History::none;
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
  const auto run = [&]<PairSubset kSubset>(auto periodic) {
    Loop<D, kTraits, kGeometry, decltype(periodic)::value, kSubset>(s, kernel, range, pass).run();
  };
  const auto with_order = [&](auto periodic) {
    if (range.order != nullptr)
      run.template operator()<PairSubset::ordered>(periodic);
    else if (pass.lent != nullptr)
      run.template operator()<PairSubset::own>(periodic);
    else
      run.template operator()<PairSubset::all>(periodic);
  };
  if constexpr (kGeometry != Geometry::sphere_plane)
    if (s.cell.any_periodic()) return with_order(std::true_type{});
  with_order(std::false_type{});
}

}  // namespace

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

void add_first(const ContactStiffness& of, std::size_t body, BodyStiffness& to) {
  to.translation[body] += of.translation;
  to.rotation[body] += of.rotation_i;
  to.force[body] += of.force;
  to.contacts[body] += of.force != 0.0 ? 1 : 0;
}

void add_second(const ContactStiffness& of, std::size_t body, BodyStiffness& to) {
  to.translation[body] += of.translation;
  to.rotation[body] += of.rotation_j;
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
