// What fitted laws are called, how good they are, what they do beyond the range they were measured in, and how far
// they are asked beyond it.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cstdint>
#include <limits>

#include "common/core/enum_names.h"
#include "common/core/limits.h"

namespace softgrain {

/// The form of a law: how contacts of one soft particle depend on each other.
enum class LawForm {
  pair,        ///< not at all: no sums, no pass over particles
  isotropic,   ///< one pressure: M = 1
  directional  ///< M(c) = m0 - m1 c - m2 c^2
};

template <>
inline constexpr auto enum_names<LawForm> = enum_name_list<LawForm>({{LawForm::pair, "pair"},
                                                                     {LawForm::isotropic, "isotropic"},
                                                                     {LawForm::directional, "directional"}});

/// What came of a fit.
enum class LawStatus { good, no_threshold_crossing, underdetermined, inaccurate, not_run };

template <>
inline constexpr auto enum_names<LawStatus> =
    enum_name_list<LawStatus>({{LawStatus::good, "good"},
                               {LawStatus::no_threshold_crossing, "no threshold crossing"},
                               {LawStatus::underdetermined, "underdetermined"},
                               {LawStatus::inaccurate, "inaccurate"},
                               {LawStatus::not_run, "not run"}});

/// Largest residual r of an unloading branch (UnloadingBranch) that is fitted, read and drawn. Unloading is about
/// 1/(1 - r) times as steep as loading, and as much shorter are time steps: a contact that gives back nothing has no
/// stiffness.
inline constexpr double kLargestResidual = 0.98;

/// Smallest exponent m of an unloading branch (UnloadingBranch) with the residual r with which no cycle gives back more
/// than it took. Along the branch work is stored and given back; where loading goes on at Delta_max the stored energy,
/// F (1 - r) (Delta_max - delta)/(m + 1), must grow by no more than the work of loading. With F' (D - delta)/F <= B =
/// max(1, b), b the exponent of loading, that is so at any depth where (1 - r) (1 + B) <= 1 + m. At least 1: a contact
/// of finite stiffness.
constexpr double least_unloading_exponent(double residual, double loading_exponent) {
  const double bend = loading_exponent > 1.0 ? loading_exponent : 1.0;
  const double least = (1.0 - residual) * (1.0 + bend) - 1.0;
  return least > 1.0 ? least : 1.0;
}

/// Whether there is a law at all: one that the data do not determine is still one, and its status says so.
constexpr bool has_numbers(LawStatus status) {
  return status == LawStatus::good || status == LawStatus::underdetermined;
}

/// What to do when a law is asked outside what was measured.
enum class RangePolicy { reject, clamp };

template <>
inline constexpr auto enum_names<RangePolicy> = enum_name_list<RangePolicy>({{RangePolicy::reject, "reject"},
                                                                             {RangePolicy::clamp, "clamp"}});

/// What happens beyond the range of a law. In every case the contacts beyond are counted and the run reports them.
enum class Extrapolation {
  error,        ///< the run ends there, not usable
  clamp,        ///< force and stiffness stay as they are at the end of the range
  extrapolate,  ///< the formula goes on
};

template <>
inline constexpr auto enum_names<Extrapolation> = enum_name_list<Extrapolation>(
    {{Extrapolation::error, "error"}, {Extrapolation::clamp, "clamp"}, {Extrapolation::extrapolate, "extrapolate"}});

/// End of the measured range in the variable of the law (Delta of a pair law, lost volume of a multi-contact law).
struct LawRange {
  double end = std::numeric_limits<double>::infinity();
  Extrapolation beyond = Extrapolation::extrapolate;

  /// Where the loop cuts the variable off; infinite unless the law is clamped.
  [[nodiscard]] double clamp_at() const {
    return beyond == Extrapolation::clamp ? end : std::numeric_limits<double>::infinity();
  }
};

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
