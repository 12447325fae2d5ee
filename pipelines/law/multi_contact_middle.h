// One soft particle with its neighbours, asked through the law of the contact loop: for one state of overlaps, or for
// several side by side. Radius and modulus are 1: dimensionless [SP 1.6].
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/contact/make_laws.h"

namespace softgrain::law {

/// What presses on the soft particle in the middle.
struct MultiContactNeighbour {
  PartnerKind kind = PartnerKind::plane;
  double ratio = 0.0;  ///< its radius over that of the particle in the middle; not of planes
  Vec3 direction{};    ///< unit vector from the centre to it
};

/// The law of one form against each kind of neighbour, as the loop has it.
template <class Law>
struct MultiContactContacts {
  Law plane;
  Law solid;
  Law soft;

  [[nodiscard]] const Law& with(PartnerKind kind) const {
    if (kind == PartnerKind::plane) return plane;
    return kind == PartnerKind::solid ? solid : soft;
  }
};

/// f(contacts) with the type that the laws have.
template <class F>
void with_multi_contact_contacts(const MultiContactLaws& laws, F&& f) {
  std::visit(
      [&]<class Law>(const Law& plane) {
        if constexpr (Law::traits.is_multi_contact)
          f(MultiContactContacts<Law>{plane, std::get<Law>(laws.soft_solid), std::get<Law>(laws.soft_soft)});
      },
      laws.soft_plane);
}

/// What the loop would find at these overlaps: all contacts of the particle in the middle, one of each soft neighbour.
/// T as in common/core/lanes.h: a number, or several states side by side.
template <class Law, class T = double>
class MultiContactMiddle {
 public:
  /// `overlap`: h/R of every neighbour; below 0 it does not touch. All three must outlive this.
  MultiContactMiddle(const MultiContactContacts<Law>& laws, const std::vector<MultiContactNeighbour>& around,
                     const std::vector<T>& overlap)
      : laws_(laws), around_(around) {
    states_.reserve(around.size());
    for (std::size_t k = 0; k < around.size(); ++k) {
      const double radius = around[k].kind == PartnerKind::plane ? 0.0 : around[k].ratio;
      const Law& law = laws.with(around[k].kind);
      const PairConstants constants = law.pair_constants({1.0, radius, 0.0, 0.0});
      ContactState<3, T> s;
      s.overlap = largest<T>(overlap[k], 0.0);
      for (int c = 0; c < 3; ++c) s.normal[c] = T(-around[k].direction[c]);
      s.constants = {T(constants.a), T(constants.b)};
      s.radius_i = T(1.0);
      s.radius_j = T(radius);
      states_.push_back(s);
      add(law, s, true, own_);
    }
    if constexpr (Law::traits.needs_particle_pass) close(own_);
  }

  [[nodiscard]] ContactResponse<3, T> response(std::size_t k) const {
    const Law& law = laws_.with(around_[k].kind);
    ContactState<3, T> s = states_[k];
    MultiContactSum<3, T> other;
    if constexpr (Law::traits.needs_particle_pass) {
      if (around_[k].kind == PartnerKind::soft) {
        add(law, s, false, other);
        close(other);
      }
      s.sum_i = &own_;
      s.sum_j = &other;
    }
    return law.evaluate(s);
  }

  /// Equivalent volume of the particle in the middle; of the pair law the largest of its contacts.
  [[nodiscard]] T volume() const {
    if constexpr (Law::traits.needs_particle_pass) return equivalent(own_);
    T most(0.0);
    for (std::size_t k = 0; k < states_.size(); ++k)
      most = largest<T>(most, laws_.with(around_[k].kind).occupied_volume(states_[k], true));
    return most;
  }

 private:
  /// Share of a contact in the sums of one of its bodies.
  static void add(const Law& law, const ContactState<3, T>& s, bool of_i, MultiContactSum<3, T>& sum) {
    const T nu = law.occupied_volume(s, of_i);
    if constexpr (Law::kForm == LawForm::isotropic)
      sum.add(nu);
    else
      sum.add(nu, of_i ? -s.normal : s.normal);
  }
  [[nodiscard]] T equivalent(const MultiContactSum<3, T>& sum) const {
    if constexpr (Law::kForm == LawForm::isotropic) return sum.volume;
    return laws_.plane.form.equivalent_volume(sum);
  }
  void close(MultiContactSum<3, T>& sum) const { sum.close(laws_.plane.form.pressure, equivalent(sum)); }

  const MultiContactContacts<Law>& laws_;
  const std::vector<MultiContactNeighbour>& around_;
  MultiContactSum<3, T> own_;
  std::vector<ContactState<3, T>> states_;
};

}  // namespace softgrain::law
