// Which points of the ranges of several keys a sweep with --sample runs: Latin hypercube, Sobol sequence, Saltelli's
// design for Sobol indices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/enum_names.h"

namespace softgrain {

enum class SampleForm { lhs, sobol, saltelli };

template <>
inline constexpr auto enum_names<SampleForm> = enum_name_list<SampleForm>({{SampleForm::lhs, "lhs"},
                                                                           {SampleForm::sobol, "sobol"},
                                                                           {SampleForm::saltelli, "saltelli"}});

struct SampleDesign {
  SampleForm form = SampleForm::lhs;
  std::size_t points = 0;  ///< N; Saltelli's design has N (k + 2) runs for k keys
  std::uint64_t seed = 0;

  [[nodiscard]] std::string text() const;  ///< "lhs:20"
  [[nodiscard]] std::size_t runs(std::size_t keys) const;
};

/// "lhs:20", "sobol:64", "saltelli:32". Throws InputError.
SampleDesign read_design(const std::string& text, std::uint64_t seed);

/// Points in the unit cube, each coordinate in (0, 1), one per key.
///   lhs: one point in each of N strata of every coordinate, paired at random (McKay, Beckman and Conover 1979,
///   doi:10.2307/1268522).
///   sobol: the Sobol sequence from its origin on, with a random digital shift: its first points are the design of a
///   smaller N, and 2^m points are even in every coordinate.
///   saltelli: for each point of a Sobol sequence of 2 k columns the point A, the point B, and A with one coordinate
///   after the other from B (Saltelli et al. 2010, doi:10.1016/j.cpc.2009.09.018).
/// Throws InputError for more keys than a Sobol sequence has columns.
std::vector<std::vector<double>> unit_points(const SampleDesign& design, std::size_t keys);

// A key that is given as a range.

struct SweptRange {
  double low = 0.0;
  double high = 0.0;
  bool logarithmic = false;
  std::string unit{};  ///< that of the text; empty: none
  bool whole = false;  ///< the key takes whole numbers
};

/// "0.1..0.8", "1e6..1e8:log", "0.1..1 MPa" as a range; none for what is no such text. `problem`: what is wrong with
/// it.
std::optional<SweptRange> range_of(const std::string& text, std::string& problem);

/// The value at a share u of the range, in (0, 1), as --set takes it. Whole numbers are equally likely, both ends
/// included (logarithmic: by the logarithm of what they stand for, [n, n + 1)).
std::string value_at(const SweptRange& range, double u);

/// Whether a key takes whole numbers alone; `value` is one that it may have.
using TakesWholeNumbers = std::function<bool(const std::string& key, const std::string& value)>;

}  // namespace softgrain
