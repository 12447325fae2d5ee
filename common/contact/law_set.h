// The laws of a scene and which pair of materials uses which; and laws as text. The variant is opened once per section
// of the contact list, never per contact.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <concepts>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/contact/cohesive_disk.h"
#include "common/contact/hertz_mindlin.h"
#include "common/contact/linear_spring.h"
#include "common/contact/soft_contact.h"
#include "common/contact/soft_multi_contact.h"

namespace softgrain {

/// Every contact law that the loop is compiled for.
using AnyLaw =
    std::variant<HertzMindlin<Tangential::none, false>, HertzMindlin<Tangential::none, true>,
                 HertzMindlin<Tangential::mindlin, false>, HertzMindlin<Tangential::mindlin, true>,
                 HertzMindlin<Tangential::rescaled, false>, HertzMindlin<Tangential::rescaled, true>, LinearSpring,
                 SoftContact, SoftUnloading, SoftMultiContact<LawForm::pair, false>,
                 SoftMultiContact<LawForm::pair, true>, SoftMultiContact<LawForm::isotropic, false>,
                 SoftMultiContact<LawForm::isotropic, true>, SoftMultiContact<LawForm::directional, false>,
                 SoftMultiContact<LawForm::directional, true>, SoftMultiContact<LawForm::pair, false, true>,
                 SoftMultiContact<LawForm::pair, true, true>, SoftMultiContact<LawForm::isotropic, false, true>,
                 SoftMultiContact<LawForm::isotropic, true, true>, SoftMultiContact<LawForm::directional, false, true>,
                 SoftMultiContact<LawForm::directional, true, true>, CohesiveDisk<false, false>,
                 CohesiveDisk<true, false>, CohesiveDisk<true, true>, HertzMindlin<Tangential::mindlin, false, true>,
                 HertzMindlin<Tangential::mindlin, true, true>, HertzMindlin<Tangential::rescaled, false, true>,
                 HertzMindlin<Tangential::rescaled, true, true>, LinearSpringLaw<true>>;

/// A law of a law card.
using CardLaw = std::variant<SoftContact, SoftUnloading>;

inline AnyLaw any_law(const CardLaw& law) {
  return std::visit([](const auto& one) { return AnyLaw(one); }, law);
}

/// What every law is: traits, constants of a pair, and a force for a number or for several side by side; and what it
/// says of itself is there. impact_time(bodies, speed) bounds the time step: how long two bodies touch that meet at
/// this speed [s], infinite where the stiffness alone bounds it.
template <class Law>
concept ContactLaw = std::is_same_v<const LawTraits, decltype(Law::traits)> &&
                     (Law::traits.needs_velocity || !Law::traits.has_tangential) &&
                     requires(const Law& law, const PairBodies& bodies,
                              const ContactState<Law::traits.dimension == 2 ? 2 : 3>& state,
                              MultiContactSum<Law::traits.dimension == 2 ? 2 : 3>& sum) {
  { law.pair_constants(bodies) } -> std::same_as<PairConstants>;
  { law.impact_time(bodies, 1.0) } -> std::same_as<double>;
  { law.evaluate(state) } -> std::same_as<ContactResponse<Law::traits.dimension == 2 ? 2 : 3>>;
  requires !Law::traits.has_onset || requires {
    { law.onset(bodies) } -> std::same_as<double>;
  };
  requires !Law::traits.acts_at_distance || requires {
    { law.reach() } -> std::same_as<double>;
    { law.stiffest(1.0) } -> std::same_as<double>;
  };
  requires !Law::traits.is_fitted || requires {
    { law.soft_sides() } -> std::same_as<SoftSides>;
  };
  requires !Law::traits.stores_energy || requires {
    { law.stored_energy(0.0, PairConstants{}) } -> std::same_as<double>;
  };
  requires !Law::traits.needs_particle_pass || requires {
    law.share(state, true, sum);
    law.finish(sum);
  };
  requires !Law::traits.is_multi_contact || requires {
    { law.form } -> std::convertible_to<MultiContactForm>;
  };
};

/// Whether a law knows this number of dimensions.
template <class Law, int D>
constexpr bool law_serves() {
  return Law::traits.dimension == 0 || Law::traits.dimension == D;
}

template <class... Laws>
constexpr bool are_contact_laws(const std::variant<Laws...>*) {
  return (ContactLaw<Laws> && ...);
}
static_assert(are_contact_laws(static_cast<const AnyLaw*>(nullptr)));

inline SoftSides soft_sides(const AnyLaw& any) {
  return std::visit([](const auto& law) { return soft_sides_of(law); }, any);
}

inline LawTraits traits_of(const AnyLaw& any) {
  return std::visit([]<class Law>(const Law&) { return Law::traits; }, any);
}

/// The cheapest Hertz law that does what the coefficients ask for: no friction, no history; no damping, no dashpot.
/// Only contacts with friction resist rolling.
inline AnyLaw hertz_law(const HertzCoefficients& k, Tangential tangential) {
  const auto with_rolling = [&]<Tangential kTangential, bool kDamped>() -> AnyLaw {
    if (k.rolling.friction > 0.0) return HertzMindlin<kTangential, kDamped, true>{k};
    return HertzMindlin<kTangential, kDamped>{k};
  };
  const auto with_friction = [&]<Tangential kTangential>() -> AnyLaw {
    return k.damping > 0.0 ? with_rolling.template operator()<kTangential, true>()
                           : with_rolling.template operator()<kTangential, false>();
  };
  if (tangential == Tangential::mindlin) return with_friction.template operator()<Tangential::mindlin>();
  if (tangential == Tangential::rescaled) return with_friction.template operator()<Tangential::rescaled>();
  if (k.damping > 0.0) return HertzMindlin<Tangential::none, true>{k};
  return HertzMindlin<Tangential::none, false>{k};
}
inline AnyLaw hertz_law(const HertzCoefficients& k, bool rescaled) {
  if (k.friction == 0.0) return hertz_law(k, Tangential::none);
  return hertz_law(k, rescaled ? Tangential::rescaled : Tangential::mindlin);
}

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
    if (laws_.size() == kMostLaws)
      throw std::length_error("more than " + std::to_string(kMostLaws) + " contact laws in one system");
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

// The laws of a scene as text, numbers as the contact loop takes them: for other engines, which evaluate the very same
// functions (macrosim/lammps).

enum class LawType { hertz, linear, soft, multi_contact, cohesive };

template <>
inline constexpr auto enum_names<LawType> = enum_name_list<LawType>({{LawType::hertz, "hertz"},
                                                                     {LawType::linear, "linear"},
                                                                     {LawType::soft, "soft"},
                                                                     {LawType::multi_contact, "multi-contact"},
                                                                     {LawType::cohesive, "cohesive"}});

template <>
inline constexpr auto enum_names<Tangential> = enum_name_list<Tangential>({{Tangential::none, "none"},
                                                                           {Tangential::mindlin, "mindlin"},
                                                                           {Tangential::rescaled, "rescaled"}});

/// Name and law.
using LawFileEntry = std::pair<std::string, AnyLaw>;

/// TOML with one [[law]] per law. Every number is written so that it reads back to the same bits.
std::string laws_text(const std::vector<LawFileEntry>& laws);

/// The laws of such a text, in its order; `origin` is what messages call it. Throws InputError.
std::vector<LawFileEntry> parse_laws(const std::string& text, const std::string& origin);

/// The law for the two bodies of the pair in the opposite order.
AnyLaw mirrored(const AnyLaw& law);

}  // namespace softgrain
