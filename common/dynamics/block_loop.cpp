#include "common/dynamics/block_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "common/dynamics/block_kernels.h"

namespace softgrain {

namespace {

using namespace block;

/// One per thread: clearing 80 kB in every pass is work that small systems need not do.
template <int D>
Block<D>& scratch() {
  thread_local Block<D> block{};
  return block;
}

/// Which pairs of a range a loop takes: all of them, those of an order, or those that are not lent, with what waits
/// added in between.
enum class Take { all, ordered, own };

/// Finds the touching pairs of a block and brings all that a law asks for into rows. kTraits: what laws of this kind
/// ask for.
template <int D, LawTraits kTraits, Geometry kGeometry, bool kPeriodic, Take kTake>
class Gatherer {
 public:
  Gatherer(System<D>& s, const Kernel<D>& kernel, const PairRange& range, const BlockPass<D>& pass)
      : s_(s), list_(s.contacts), kernel_(kernel), range_(range), pass_(pass), images_(s.cell) {}

 protected:
  static constexpr bool kOrdered = kTake == Take::ordered;

  static std::size_t u(std::int32_t k) { return static_cast<std::size_t>(k); }

  /// Place in the list of number k of the range.
  [[nodiscard]] std::int32_t place_of(std::int32_t k) const {
    if constexpr (!kOrdered) return k;
    return range_.at(k);
  }

  // Arrays are taken by local pointers in all loops: otherwise every store makes the compiler load them again.

  static Quad dot(const std::array<Quad, 4>& a, const std::array<Quad, 4>& b) {
    Quad sum = a[0] * b[0];
    for (std::size_t axis = 1; axis < D; ++axis) sum += a[axis] * b[axis];
    return sum;
  }

  /// One bit for each of four pairs that is apart: what is not a number is not, and makes a force that is none, as in
  /// the scalar loop. `t`: branch and the fourth number in columns; `upright`: normals of planes.
  [[gnu::always_inline]] int apart(const std::array<Quad, 4>& t, std::array<Quad, 4> upright) const {
    if constexpr (kGeometry == Geometry::sphere_sphere) {
      Quad touch = t[3];
      if constexpr (kTraits.acts_at_distance) touch += kernel_.reach;
      return sign_bits(dot(t, t) >= touch * touch);
    } else if constexpr (kGeometry == Geometry::sphere_shell) {
      return sign_bits(t[3] > 0.0) & sign_bits(dot(t, t) <= t[3] * t[3]);
    } else {
      transpose(upright[0], upright[1], upright[2], upright[3]);
      return sign_bits(t[3] - dot(t, upright) <= 0.0);
    }
  }

  /// One bit for each of four pairs from place k on that is lent.
  [[nodiscard]] int lent([[maybe_unused]] std::int32_t k) const {
    int bits = 0;
    if constexpr (kTake == Take::own) {
      std::uint32_t flags = 0;
      std::memcpy(&flags, pass_.lent + k, sizeof flags);
      if (flags != 0)
        for (int l = 0; l < 4; ++l) bits |= static_cast<int>(flags >> (8 * l) & 1U) << l;
    }
    return bits;
  }

  /// Branch vector and the fourth number of every pair, and which touch. No branch depends on that: about one pair in
  /// three does, which no processor can guess.
  void find_touching(std::int32_t begin,
                     std::int32_t end) {  // NOLINT(readability-function-size): one hot loop
    const Slot* const first = list_.i.data();
    const Slot* const second = list_.j.data();
    const Sphere<D>* const spheres = s_.particles.sphere.data();
    const auto branch_of = [&](std::int32_t c) {
      const Quad a = place(spheres[u(first[c])]);
      const Quad b = place(spheres[u(second[c])]);
      Quad d = a - b;
      if constexpr (kPeriodic) d -= images_.shift[u(list_.image[u(c)])];
      if constexpr (kGeometry == Geometry::sphere_sphere) return with_fourth(d, a + b);
      return with_fourth(d, kGeometry == Geometry::sphere_shell ? b - a : a);
    };
    [[maybe_unused]] const Vec<D>* const normals = s_.particles.plane_normal.data();
    [[maybe_unused]] const Slot first_plane = s_.particles.first_plane();
    const auto upright_of = [&](std::int32_t c) {
      const Vec<D>& n = normals[second[u(c)] - first_plane];
      if constexpr (D == 3)
        return Quad{n[0], n[1], n[2], 0.0};
      else
        return Quad{n[0], n[1], 0.0, 0.0};
    };
    Quad* const record = block_.record.data();
    [[maybe_unused]] Quad* const upright = block_.upright_record.data();
    std::int32_t* const pair = block_.pair.data();
    [[maybe_unused]] std::int32_t* const number = block_.number.data();
    int n = 0;
    for (std::int32_t k = begin; k < end; k += 4) {
      const int valid = std::min(end - k, 4);
      std::array<Quad, 4> d;
      std::array<Quad, 4> normal{};
      std::array<std::int32_t, 4> c;
      for (int l = 0; l < 4; ++l) {
        c[u(l)] = place_of(std::min(k + l, end - 1));
        d[u(l)] = branch_of(c[u(l)]);
        if constexpr (kGeometry == Geometry::sphere_plane) normal[u(l)] = upright_of(c[u(l)]);
      }
      std::array<Quad, 4> t = d;
      transpose(t[0], t[1], t[2], t[3]);
      const int here = ((1 << valid) - 1) & ~lent(k);
      const int touch = ~apart(t, normal) & here;
      for (int l = 0; l < 4; ++l) {
        record[n] = d[u(l)];
        pair[n] = c[u(l)];
        if constexpr (kGeometry == Geometry::sphere_plane) upright[n] = normal[u(l)];
        if constexpr (kOrdered) number[n] = k + l;
        n += touch >> l & 1;
      }
      if constexpr (kTraits.has_tangential) note_touch(c, here, touch);
      if constexpr (kOrdered)
        if (pass_.touches != nullptr)
          for (int l = 0; l < valid; ++l) pass_.touches[k + l] = static_cast<std::uint8_t>(touch >> l & 1);
    }
    block_.touching = n;
    for (int pad = n; n > 0 && pad < n + 8; ++pad) {  // lanes without a contact repeat the last one
      record[pad] = record[n - 1];
      pair[pad] = pair[n - 1];
      if constexpr (kGeometry == Geometry::sphere_plane) upright[pad] = upright[n - 1];
    }
  }

  /// A contact that has opened forgets its history. `here`: one bit for each of the four that is looked at.
  void note_touch(const std::array<std::int32_t, 4>& c, int here, int touch) {
    if (pass_.history == History::none) return;
    if (pass_.history == History::next) {
      for (int l = 0; l < 4; ++l)
        if (((here & ~touch) >> l & 1) != 0) forget(list_.spring_next, list_.memory_next, list_.roll_next, u(c[u(l)]));
      return;
    }
    std::uint8_t* const touched = list_.touched.data();
    if constexpr (!kOrdered) {
      if (here == 15) {  // four flags in one word, which seldom changes
        std::uint32_t old = 0;
        std::memcpy(&old, touched + c[0], sizeof old);
        const std::uint32_t now = kFlags[u(touch)];
        if (old == now) return;
        std::memcpy(touched + c[0], &now, sizeof now);
        for (int l = 0; l < 4; ++l)
          if ((old & ~now) >> (8 * l) & 1U) forget(list_.spring, list_.memory, list_.roll, u(c[u(l)]));
        return;
      }
    }
    for (int l = 0; l < 4; ++l) {
      if ((here >> l & 1) == 0) continue;
      const std::size_t place = u(c[u(l)]);
      const bool now = (touch >> l & 1) != 0;
      if (touched[place] != 0 && !now) forget(list_.spring, list_.memory, list_.roll, place);
      touched[place] = static_cast<std::uint8_t>(now);
    }
  }

  static constexpr bool kRolls = has_roll_history<D>(kTraits);

  static void forget(std::vector<Stored<D>>& spring, std::vector<double>& memory, std::vector<Stored<D>>& roll,
                     std::size_t c) {
    spring[c] = {};
    if constexpr (kTraits.has_memory) memory[c] = 0.0;
    if constexpr (kRolls) roll[c] = {};
  }

  /// From records to rows, four contacts at a time.
  void gather() {
    const auto& p = s_.particles;
    const Slot* const first = list_.i.data();
    const Slot* const second = list_.j.data();
    const Sphere<D>* const spheres = p.sphere.data();
    const CrowdSum<D>* const sums = list_.particle_sum.data();
    const Stored<D>* const velocities = p.velocity.data();
    const StoredRot<D>* const spins = p.spin.data();
    const Stored<D>* const springs = list_.spring.data();
    const PairConstants* const all_constants = list_.constants.data();
    for (int g = 0; g < block_.touching; g += 4) {
      std::array<Quad, 4> branch, motion, spin_i, spin_j, spring, normal, roll;
      for (std::size_t l = 0; l < 4; ++l) {
        const std::size_t c = u(block_.pair[u(g) + l]);
        const std::size_t i = u(first[c]);
        const std::size_t j = u(second[c]);
        branch[l] = block_.record[u(g) + l];
        block_.a.v[u(g) + l] = all_constants[c].a;
        if constexpr (kTraits.needs_velocity || kTraits.is_crowd) block_.b.v[u(g) + l] = all_constants[c].b;
        if constexpr (kTraits.needs_velocity) {
          motion[l] = quad_of(velocities[i]) - quad_of(velocities[j]);
          if constexpr (kPeriodic) motion[l] -= images_.velocity[u(list_.image[c])];
        }
        if constexpr (kTraits.has_tangential) {
          spin_i[l] = with_fourth(quad_of(spins[i]), place(spheres[i]));
          spin_j[l] = with_fourth(quad_of(spins[j]), place(spheres[j]));
          spring[l] = quad_of(springs[c]);
        }
        if constexpr (kRolls) roll[l] = quad_of(list_.roll[c]);
        if constexpr (kTraits.is_crowd && !kTraits.has_tangential) {
          block_.radius_i.v[u(g) + l] = spheres[i].r;
          block_.radius_j.v[u(g) + l] = spheres[j].r;
        }
        if constexpr (kTraits.has_memory) block_.memory.v[u(g) + l] = list_.memory[c];
        if constexpr (kTraits.needs_particle_pass) {
          if (kernel_.sums.i) gather_sum(block_.sum_i, u(g) + l, sums[i]);
          if (kernel_.sums.j) gather_sum(block_.sum_j, u(g) + l, sums[j]);
        }
        if constexpr (kGeometry == Geometry::sphere_plane) normal[l] = block_.upright_record[u(g) + l];
      }
      transpose(branch[0], branch[1], branch[2], branch[3]);
      store_rows<D>(block_.branch, g, branch);
      store_quad(block_.fourth.v + g, branch[3]);
      if constexpr (kGeometry == Geometry::sphere_plane) {
        transpose(normal[0], normal[1], normal[2], normal[3]);
        store_rows<D>(block_.upright, g, normal);
      }
      if constexpr (kTraits.needs_velocity) {
        transpose(motion[0], motion[1], motion[2], motion[3]);
        store_rows<D>(block_.velocity, g, motion);
      }
      if constexpr (kTraits.has_tangential) {
        transpose(spin_i[0], spin_i[1], spin_i[2], spin_i[3]);
        transpose(spin_j[0], spin_j[1], spin_j[2], spin_j[3]);
        store_rows<kRot<D>>(block_.spin_i, g, spin_i);
        store_rows<kRot<D>>(block_.spin_j, g, spin_j);
        store_quad(block_.radius_i.v + g, spin_i[3]);
        store_quad(block_.radius_j.v + g, spin_j[3]);
        transpose(spring[0], spring[1], spring[2], spring[3]);
        store_rows<D>(block_.spring, g, spring);
      }
      if constexpr (kRolls) {
        transpose(roll[0], roll[1], roll[2], roll[3]);
        store_rows<D>(block_.roll, g, roll);
      }
    }
  }

  static void gather_sum(SumRows<D>& rows, std::size_t k, const CrowdSum<D>& sum) {
    rows.volume.v[k] = sum.volume;
    if constexpr (kTraits.directions_in_sums) {
      for (int a = 0; a < D; ++a) rows.first[static_cast<std::size_t>(a)].v[k] = sum.first[a];
      for (std::size_t a = 0; a < sum.second.size(); ++a) rows.second[a].v[k] = sum.second[a];
    }
    rows.gain.v[k] = sum.gain;
    rows.gain_slope.v[k] = sum.gain_slope;
  }

  System<D>& s_;
  ContactList<D>& list_;
  const Kernel<D> kernel_;
  const PairRange range_;
  const BlockPass<D> pass_;
  const Images<D, kPeriodic> images_;
  Block<D>& block_ = scratch<D>();
};

/// Forces of a range of pairs.
template <int D, LawTraits kTraits, Geometry kGeometry, bool kPeriodic, Take kTake>
class Loop : Gatherer<D, kTraits, kGeometry, kPeriodic, kTake> {
  using Base = Gatherer<D, kTraits, kGeometry, kPeriodic, kTake>;
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
      if constexpr (kTake != Take::all)
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

  /// Of number k of the block.
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

  /// The same for bodies of other threads.
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

/// The first half of the particle pass: what every contact takes from its bodies.
template <class Law, Geometry kGeometry, bool kPeriodic>
class Shares : Gatherer<3, LawTraits{.has_memory = Law::traits.memory_in_sums, .is_crowd = true}, kGeometry, kPeriodic,
                        Take::all> {
  using Base = Gatherer<3, LawTraits{.has_memory = Law::traits.memory_in_sums, .is_crowd = true}, kGeometry, kPeriodic,
                        Take::all>;
  using Base::block_, Base::list_, Base::u;

 public:
  Shares(System<3>& s, const Law& law, const PairRange& range, OwnBodies own)
      : Base(s, {&law, &take<3, kGeometry, Law>, 0.0, {}}, range, {}), law_(law), own_(own) {}

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
    const Vec<3> normal{{block_.normal[0].v[n], block_.normal[1].v[n], block_.normal[2].v[n]}};
    const Slot i = list_.i[c];
    const Slot j = list_.j[c];
    if (law_.i_is_soft && own_(i)) Law::add(block_.taken_i.v[n], -normal, list_.particle_sum[u(i)]);
    if (law_.j_is_soft && own_(j)) Law::add(block_.taken_j.v[n], normal, list_.particle_sum[u(j)]);
  }

  const Law& law_;
  OwnBodies own_;
};

/// Closes sums, each once, several at a time.
template <class Law>
class Closing {
 public:
  explicit Closing(const Law& law) : law_(law) {}

  void add(CrowdSum<3>& sum) {
    if (sum.ready || !(sum.square > 0.0)) return;
    sum.ready = true;
    waiting_[static_cast<std::size_t>(many_)] = &sum;
    volume_.v[many_] = law_.equivalent(sum);
    if (++many_ == kLanes) close();
  }
  void close() {
    for (int l = many_; l < kLanes; ++l) volume_.v[l] = volume_.v[0];
    CrowdSum<3, Lanes> sum;
    if (many_ > 0) sum.close(law_.form.pressure, volume_.at(0));
    for (int l = 0; l < many_; ++l) {
      waiting_[static_cast<std::size_t>(l)]->gain = sum.gain[static_cast<std::size_t>(l)];
      waiting_[static_cast<std::size_t>(l)]->gain_slope = sum.gain_slope[static_cast<std::size_t>(l)];
    }
    many_ = 0;
  }

 private:
  const Law& law_;
  int many_ = 0;
  std::array<CrowdSum<3>*, static_cast<std::size_t>(kLanes)> waiting_{};
  Row volume_{};
};

/// Opens law and geometry of a section for those that this number of dimensions knows.
template <int D, class Work>
void open(const System<D>& s, const ContactSection& section, Work&& work) {
  std::visit(
      [&]<class Law>(const Law& law) {
        using G = Geometry;
        if constexpr (!law_serves<Law, D>())
          throw std::logic_error("a law for another number of dimensions");
        else if (section.geometry == G::sphere_sphere)
          work(law, std::integral_constant<G, G::sphere_sphere>{});
        else if (section.geometry == G::sphere_shell)
          work(law, std::integral_constant<G, G::sphere_shell>{});
        else
          work(law, std::integral_constant<G, G::sphere_plane>{});
      },
      s.laws.law(section.law));
}

template <int D, LawTraits kTraits, Geometry kGeometry>
void run_loop(System<D>& s, const Kernel<D>& kernel, const PairRange& range, const BlockPass<D>& pass) {
  const auto run = [&]<Take kTake>(auto periodic) {
    Loop<D, kTraits, kGeometry, decltype(periodic)::value, kTake>(s, kernel, range, pass).run();
  };
  const auto with_order = [&](auto periodic) {
    if (range.order != nullptr)
      run.template operator()<Take::ordered>(periodic);
    else if (pass.lent != nullptr)
      run.template operator()<Take::own>(periodic);
    else
      run.template operator()<Take::all>(periodic);
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

template <>
void add_particle_shares(System<2>&, const ContactSection&, const PairRange&, OwnBodies) {}

template <>
void add_particle_shares(System<3>& s, const ContactSection& section, const PairRange& range, OwnBodies own) {
  open(s, section, [&]<class Law>(const Law& law, auto geometry) {
    constexpr Geometry kGeometry = decltype(geometry)::value;
    if constexpr (Law::traits.needs_particle_pass) {
      if (kGeometry == Geometry::sphere_sphere && s.cell.any_periodic())
        Shares<Law, kGeometry, true>(s, law, range, own).run();
      else
        Shares<Law, kGeometry, false>(s, law, range, own).run();
    }
  });
}

template <>
void close_particle_sums(System<2>&, const ContactSection&, const PairRange&, OwnBodies) {}

template <>
void close_particle_sums(System<3>& s, const ContactSection& section, const PairRange& range, OwnBodies own) {
  open(s, section, [&]<class Law>(const Law& law, auto) {
    if constexpr (Law::traits.needs_particle_pass) {
      Closing<Law> closing(law);
      for (std::int32_t c = range.begin; c < range.end; ++c)
        for (const Slot body : {s.contacts.i[at(c)], s.contacts.j[at(c)]})
          if (own(body)) closing.add(s.contacts.particle_sum[at(body)]);
      closing.close();
    }
  });
}

template <int D>
void particle_pass(System<D>& s) {
  if (s.contacts.particle_sum.empty()) return;
  std::fill(s.contacts.particle_sum.begin(), s.contacts.particle_sum.end(), CrowdSum<D>{});
  for (const ContactSection& section : s.contacts.sections)
    add_particle_shares<D>(s, section, {section.begin, section.end}, {});
  for (const ContactSection& section : s.contacts.sections)
    close_particle_sums<D>(s, section, {section.begin, section.end}, {});
}

template void block_loop<2>(System<2>&, const ContactSection&, const PairRange&, const BlockPass<2>&);
template void block_loop<3>(System<3>&, const ContactSection&, const PairRange&, const BlockPass<3>&);
template void block_loop<2>(System<2>&, const BlockPass<2>&);
template void block_loop<3>(System<3>&, const BlockPass<3>&);
template void particle_pass<2>(System<2>&);
template void particle_pass<3>(System<3>&);

}  // namespace softgrain
