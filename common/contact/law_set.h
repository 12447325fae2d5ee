// The laws of a scene and which pair of materials uses which. The variant is opened once per section of the contact
// list, never per contact.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cstdint>
#include <stdexcept>
#include <variant>
#include <vector>

#include "common/contact/cohesive_disk.h"
#include "common/contact/hertz_mindlin.h"
#include "common/contact/linear_spring.h"
#include "common/contact/soft_contact.h"
#include "common/contact/soft_crowd.h"

namespace softgrain {

/// Every contact law that the loop is compiled for.
using AnyLaw =
    std::variant<HertzMindlin<Tangential::none, false>, HertzMindlin<Tangential::none, true>,
                 HertzMindlin<Tangential::mindlin, false>, HertzMindlin<Tangential::mindlin, true>,
                 HertzMindlin<Tangential::rescaled, false>, HertzMindlin<Tangential::rescaled, true>, LinearSpring,
                 SoftContact, SoftCrowd<Crowd::pair, false>, SoftCrowd<Crowd::pair, true>, SoftCrowd<Crowd::bag, false>,
                 SoftCrowd<Crowd::bag, true>, SoftCrowd<Crowd::directional, false>, SoftCrowd<Crowd::directional, true>,
                 CohesiveDisk<false, false>, CohesiveDisk<true, false>, CohesiveDisk<true, true>>;

/// Whether a law knows this number of dimensions; all do but those that name one.
template <class Law, int D>
constexpr bool law_serves() {
  if constexpr (requires { Law::dimension; }) return Law::dimension == D;
  return true;
}

/// The cheapest Hertz law that does what the coefficients ask for: no friction, no history; no damping, no dashpot.
AnyLaw hertz_law(const HertzCoefficients& coefficients, bool rescaled);

class LawSet {
 public:
  static constexpr std::int32_t kNoContact = -1;  ///< the pair passes through itself
  static constexpr std::size_t kMostLaws = 64;    ///< a scene with more has lost its way

  explicit LawSet(std::int32_t materials = 0)
      : materials_(materials),
        table_(static_cast<std::size_t>(materials) * static_cast<std::size_t>(materials), kNoContact) {}

  /// `law` serves bodies i of material m1 with j of m2 (and the reverse unless `ordered`).
  void set(std::int32_t m1, std::int32_t m2, const AnyLaw& law, bool ordered = false) {
    use(m1, m2, add(law), ordered);
  }

  /// A law for use() by several pairs of materials: they share sections of the contact list.
  std::int32_t add(const AnyLaw& law) {
    if (laws_.size() == kMostLaws) throw std::length_error("more than 64 contact laws in one system");
    laws_.push_back(law);
    return size() - 1;
  }
  void use(std::int32_t m1, std::int32_t m2, std::int32_t law, bool ordered = false) {
    table_[at(m1, m2)] = law;
    if (!ordered) table_[at(m2, m1)] = law;
  }

  [[nodiscard]] std::int32_t index(std::int32_t m1, std::int32_t m2) const { return table_[at(m1, m2)]; }
  [[nodiscard]] const AnyLaw& law(std::int32_t index) const { return laws_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(laws_.size()); }
  [[nodiscard]] std::int32_t materials() const { return materials_; }

 private:
  [[nodiscard]] std::size_t at(std::int32_t m1, std::int32_t m2) const {
    if (m1 < 0 || m2 < 0 || m1 >= materials_ || m2 >= materials_)
      throw std::out_of_range("material without a law table row");
    return static_cast<std::size_t>(m1) * static_cast<std::size_t>(materials_) + static_cast<std::size_t>(m2);
  }

  std::int32_t materials_ = 0;
  std::vector<std::int32_t> table_;
  std::vector<AnyLaw> laws_;
};

}  // namespace softgrain
