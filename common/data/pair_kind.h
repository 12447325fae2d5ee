// The two published cases of a contact with a soft particle.
#pragma once

#include <string>

namespace softgrain {

enum class PairKind {
  soft_solid,  ///< soft particle against a plane (a solid sphere of infinite radius)
  soft_soft    ///< two equal soft particles
};

inline constexpr PairKind kPairKinds[] = {PairKind::soft_solid, PairKind::soft_soft};

inline std::string to_string(PairKind kind) { return kind == PairKind::soft_solid ? "soft-solid" : "soft-soft"; }

}  // namespace softgrain
