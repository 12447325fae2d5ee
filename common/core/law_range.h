// What fitted laws are called, how good they are, and what they do beyond the range they were measured in.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <limits>

#include "common/core/words.h"

namespace softgrain {

/// How contacts of one soft particle know of each other.
enum class Crowd {
  pair,        ///< not at all: no sums, no pass over particles
  bag,         ///< one pressure: M = 1
  directional  ///< M(c) = m0 - m1 c - m2 c^2
};

template <>
inline constexpr auto words<Crowd> =
    word_list<Crowd>({{Crowd::pair, "pair"}, {Crowd::bag, "bag"}, {Crowd::directional, "directional"}});

/// What came of a fit.
enum class LawStatus { good, no_threshold_crossing, underdetermined, inaccurate, not_run };

template <>
inline constexpr auto words<LawStatus> = word_list<LawStatus>({{LawStatus::good, "good"},
                                                               {LawStatus::no_threshold_crossing,
                                                                "no threshold crossing"},
                                                               {LawStatus::underdetermined, "underdetermined"},
                                                               {LawStatus::inaccurate, "inaccurate"},
                                                               {LawStatus::not_run, "not run"}});

/// Whether there is a law at all: one that the data do not determine is still one, and its status says so.
constexpr bool has_numbers(LawStatus status) {
  return status == LawStatus::good || status == LawStatus::underdetermined;
}

/// What to do when a law is asked outside what was measured.
enum class RangePolicy { reject, clamp };

template <>
inline constexpr auto words<RangePolicy> = word_list<RangePolicy>({{RangePolicy::reject, "reject"},
                                                                   {RangePolicy::clamp, "clamp"}});

/// Beyond the range of a law; either way the contacts beyond are counted and the run says so.
enum class Beyond {
  error,        ///< the run ends there, not usable
  clamp,        ///< force and stiffness stay as they are at the end of the range
  extrapolate,  ///< the formula goes on
};

template <>
inline constexpr auto words<Beyond> =
    word_list<Beyond>({{Beyond::error, "error"}, {Beyond::clamp, "clamp"}, {Beyond::extrapolate, "extrapolate"}});

/// End of the measured range in the variable of the law (Delta of a pair law, lost volume of a crowd law).
struct LawRange {
  double end = std::numeric_limits<double>::infinity();
  Beyond beyond = Beyond::extrapolate;

  /// Where the loop cuts the variable off; infinite unless the law is clamped.
  [[nodiscard]] double clamp_at() const {
    return beyond == Beyond::clamp ? end : std::numeric_limits<double>::infinity();
  }
};

}  // namespace softgrain
