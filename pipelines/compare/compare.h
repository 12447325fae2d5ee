// Error norms and cost of macro runs: a candidate (law) against a reference (resolved twin, or another run).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/data/macro_result.h"

namespace softgrain {

/// A reference that is zero: what is relative to it is not defined.
struct ZeroReference : InputError {
  using InputError::InputError;
};

/// Relative L2 difference of two piecewise linear curves over their common range of x:
/// sqrt( int (a - b)^2 dx / int b^2 dx ), b the reference; integrals exact on the union of both grids.
/// Throws InputError when a curve is shorter than two points, x does not increase, a value is not finite, there is no
/// common range; ZeroReference when the reference is zero on it. Units cancel.
double relative_difference(const std::vector<double>& candidate_x, const std::vector<double>& candidate_y,
                           const std::vector<double>& reference_x, const std::vector<double>& reference_y);

/// Value of a piecewise linear curve inside its range.
double interpolate_linear(const std::vector<double>& x, const std::vector<double>& y, double at);

/// A column of one curve at the recorded points of another one of the same test: at the same strain, in tests in
/// stages where match_stages() has them together; NaN where the curve does not come.
std::vector<double> values_at_points(const MacroCurve& of, const std::vector<double>& column, const MacroCurve& points);

/// One sample seen by both sides.
struct SampleComparison {
  std::int64_t sample = 0;
  MacroTest test{};
  double strain_low = 0.0;  ///< common range of strain
  double strain_high = 0.0;
  double shear_low = kNaN;  ///< common range of the shear strain, of tests with stages that slide; NaN without them
  double shear_high = kNaN;
  /// Relative L2 difference of the axial stress over strain; in tests in stages over match_stages(), of the stages that
  /// do not impose it: NaN where all do.
  double axial_difference = 0.0;
  double lateral_difference = 0.0;    ///< L2 difference of the lateral stress; NaN where it was not recorded or is zero
  double deviator_difference = kNaN;  ///< tests in stages: L2 difference of the deviator
  double strain_difference = kNaN;    ///< L2 difference of the strains of axes that go by stress; NaN where none does
  double unloading_ratio = kNaN;      ///< mean over the stages that unload: modulus over that of the reference
  bool axial_imposed = false;         ///< whether some stage imposes the axial stress
  bool end_imposed = false;           ///< whether the last stage imposes it
  double axial_end_ratio = 0.0;  ///< candidate over reference at the end of the common range; NaN where it is imposed
  double lateral_end_ratio = 0.0;
  double lateral_stress_ratio_candidate = 0.0;  ///< lateral over axial stress at the end of the common range
  double lateral_stress_ratio_reference = 0.0;
  double in_band = 0.0;      ///< share of the reference's axial stresses in the candidate's 95 % band; NaN: it has none
  double end_in_band = 0.0;  ///< 1 or 0: whether the last of them is in the band; NaN: there is no band
  double band_width = 0.0;   ///< half width of the band over the stress, at the candidate's end; NaN: there is no band
  Cost candidate_cost;
  Cost reference_cost;
};

struct Comparison {
  std::vector<SampleComparison> samples;
  std::vector<std::string> left_out;   ///< one sentence for each sample that could not be compared
  std::vector<std::string> undefined;  ///< one for each side that carries no stress, so that ratios are not defined
  MeanError axial_difference;          ///< mean over the samples, as are those below
  MeanError lateral_difference;
  MeanError strain_difference;
  MeanError deviator_difference;
  MeanError unloading_ratio;
  MeanError axial_end_ratio;
  MeanError lateral_stress_ratio_candidate;
  MeanError lateral_stress_ratio_reference;
  MeanError in_band;  ///< share in the band; of no sample where the candidate has no error bars
  MeanError end_in_band;
  MeanError band_width;
  double speedup_seconds = 0.0;  ///< reference over candidate, summed over samples; NaN when not recorded
  double speedup_contact_evaluations = 0.0;
};

/// Pairs the curves by test and sample. Curves marked unusable, or without a partner, are left out and named.
/// Throws InputError when nothing remains to compare, or when one side holds the same test and sample twice.
Comparison compare_curves(const std::vector<MacroCurve>& candidate, const std::vector<MacroCurve>& reference);

/// What is said first of a comparison: of tests in stages what these do not impose, deviator, strains and unloading
/// moduli before the axial stress, of others the axial stress. Only what there is.
struct ComparedQuantity {
  std::string what;
  MeanError value;
  bool is_ratio = false;  ///< else a relative difference
};
std::vector<ComparedQuantity> headline_of(const Comparison& comparison);

/// Share of the reference's axial stresses that lie in the 95 % band of the candidate, at the candidate's points where
/// both have values, the test does not impose them, and the reference bears 5 % of its largest or more; `end`: the last
/// of these points alone. NaN: the candidate has no band, or there are no such points.
double share_in_band(const MacroCurve& candidate, const MacroCurve& reference, bool end);

/// Half the width of the band over the axial stress, at the end; NaN without band.
double end_band_width(const MacroCurve& curve);

/// The curves of one engine.
std::vector<MacroCurve> curves_of(const std::vector<MacroCurve>& curves, const std::string& engine);

}  // namespace softgrain
