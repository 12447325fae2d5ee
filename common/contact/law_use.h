// How far fitted laws are asked beyond what was measured.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cstdint>

#include "common/core/law_range.h"
#include "common/core/limits.h"

namespace softgrain {

/// How far fitted laws are used beyond the range they were measured in. Pair laws of a card count contacts by Delta,
/// multi-contact laws soft particles by the lost volume S of all their contacts (the pair form by that of each).
struct LawUse {
  std::int64_t evaluations = 0;  ///< contacts and particles that a fitted law serves
  std::int64_t beyond = 0;       ///< evaluations beyond the end of the range
  double max_range_ratio = 0.0;  ///< largest Delta or S over the end of its range; 1: at the end
  std::int64_t rejected = 0;     ///< evaluations beyond the range under laws that reject it (Extrapolation::error)
  std::int64_t clamped = 0;      ///< evaluations beyond the range under laws that are clamped there

  void add(double value_over_end, Extrapolation policy) {
    ++evaluations;
    max_range_ratio = larger_or_nan(max_range_ratio, value_over_end);
    if (value_over_end <= 1.0) return;
    ++beyond;
    rejected += policy == Extrapolation::error ? 1 : 0;
    clamped += policy == Extrapolation::clamp ? 1 : 0;
  }
  LawUse& operator+=(const LawUse& other) {
    evaluations += other.evaluations;
    beyond += other.beyond;
    max_range_ratio = larger_or_nan(max_range_ratio, other.max_range_ratio);
    rejected += other.rejected;
    clamped += other.clamped;
    return *this;
  }
};

}  // namespace softgrain
