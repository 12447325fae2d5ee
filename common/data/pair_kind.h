// The two published cases of a contact with a soft particle.
#pragma once

#include "common/core/enum_names.h"

namespace softgrain {

enum class PairKind {
  soft_solid,  ///< soft particle against a plane (a solid sphere of infinite radius)
  soft_soft    ///< two equal soft particles
};

inline constexpr PairKind kPairKinds[] = {PairKind::soft_solid, PairKind::soft_soft};

template <>
inline constexpr auto enum_names<PairKind> = enum_name_list<PairKind>({{PairKind::soft_solid, "soft-solid"},
                                                                       {PairKind::soft_soft, "soft-soft"}});

}  // namespace softgrain
