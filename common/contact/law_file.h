// The laws of a scene as text, numbers as the contact loop takes them: for other engines, which evaluate the very same
// functions (macrosim/lammps).
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <string>
#include <utility>
#include <vector>

#include "common/contact/law_set.h"

namespace softgrain {

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
