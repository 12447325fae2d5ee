// How far fitted laws are asked beyond what was measured.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cstdint>

#include "common/core/law_range.h"
#include "common/core/limits.h"

namespace softgrain {

/// How far fitted laws are used beyond the range they were measured in. Pair laws of a card count contacts by Delta,
/// crowd laws soft particles by the lost volume S of all their contacts (the pair form by that of each).
struct LawUse {
  std::int64_t asked = 0;    ///< contacts and particles that a fitted law serves
  std::int64_t beyond = 0;   ///< of them, those beyond the end of their range
  double largest = 0.0;      ///< largest Delta or S over the end of its range; 1: at the end
  std::int64_t refused = 0;  ///< of those beyond, under laws that do not allow it (Beyond::error)
  std::int64_t clamped = 0;  ///< and under laws that are clamped there

  void add(double value_over_end, Beyond policy) {
    ++asked;
    largest = larger_or_nan(largest, value_over_end);
    if (value_over_end <= 1.0) return;
    ++beyond;
    refused += policy == Beyond::error ? 1 : 0;
    clamped += policy == Beyond::clamp ? 1 : 0;
  }
  LawUse& operator+=(const LawUse& other) {
    asked += other.asked;
    beyond += other.beyond;
    largest = larger_or_nan(largest, other.largest);
    refused += other.refused;
    clamped += other.clamped;
    return *this;
  }
};

}  // namespace softgrain
