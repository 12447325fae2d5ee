// The threshold fit for curves that were measured in an experiment.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibrate/threshold_fit.h"
#include "common/data/force_curves.h"

namespace softgrain {

/// What is fitted: curves at common overlaps.
struct PreparedCurves {
  Measurements data;  ///< one "packing" per sample, relaxation "experiment"
  std::vector<GivenError> errors;
  std::string note;  ///< what was done to the points; empty: they are used as they stand
};

/// Samples that were measured at different overlaps are interpolated linearly to common ones (as many as the median
/// sample has, at most 60), never beyond their own range. Samples with more than 120 points are averaged in as many
/// even bins of Delta.
PreparedCurves prepare_curves(const ForceCurves& curves);

/// Mean force [N] over samples at the overlaps of prepare_curves(); `deviation` holds the standard error of the mean:
/// the given one with one sample, the larger of that and of scatter over samples otherwise (0: nothing is known).
CurveMeans mean_curve(const ForceCurves& curves);

/// What follows of the tangential forces of an experiment; `why` of the overlaps that say no stiffness, empty: all do.
struct TurnsVerdict {
  bool none = false;  ///< tangential forces were measured, and no overlap says a stiffness
  std::string why;
};

/// `options` as for the fit.
TurnsVerdict judge_turns(const ForceCurves& curves, const FitOptions& options);

struct ExperimentFit {
  LawCard card;
  std::vector<ForceCurves> curves;  ///< curves as they were fitted, without the offsets that were found
  std::vector<FitReport> reports;
  std::vector<std::string> remarks;
};

/// Fits every pair kind, and the unloading branch of those that were unloaded. A constant force that is read without
/// contact is taken off first, and said; a curve that asks for one which its readings do not determine makes the law
/// underdetermined, and so do tangential forces that say no stiffness. `mirror`: a kind that was not measured follows
/// from the other one, by symmetry: two equal soft particles that press on each other are each pressed on a plane at
/// half the overlap and turned by half the angle,
///   F_soft-soft(D) = F_soft-solid(D/2), kt_soft-soft(D, 2 angle) = kt_soft-solid(D/2, angle)/2;
/// an unloading branch is the same for both, as its numbers are shares of the depth.
/// Grains of two particles that interlock are not in this; its law is marked "underdetermined" and says so. There is
/// none where it would lie beyond what a law of two bodies can be: a remark says so.
ExperimentFit fit_experiment(const std::vector<ForceCurves>& curves, const FitOptions& options, bool mirror);

/// Numbers (kLawParameterNames) of the law that follows by that symmetry from those of the kind that was measured.
std::array<double, 7> mirrored_numbers(const std::array<double, 7>& numbers, PairKind measured);

// A constant force that an experiment reads without contact: a load cell that was not set to zero, the weight of a
// plate. It is seen in readings before touch and below the threshold, where a soft particle bears nothing.

struct ForceOffset {
  std::size_t sample = 0;    ///< index
  double force = 0.0;        ///< mean of the readings without force [N]
  double error = 0.0;        ///< its standard error [N]
  double below = 0.0;        ///< Delta that they lie below
  std::size_t readings = 0;  ///< how many there are
  bool determined = true;    ///< false: neither they nor the shape of the curve tell
};

/// The offsets of samples that have one: the mean over at least three readings without force differs from zero by more
/// than Student's t of 99.9 %; or, with fewer such readings, a law with an offset fits far better than one without.
/// Then it is determined where all thresholds that fit give the same offset to 1 % of the largest force.
std::vector<ForceOffset> force_offsets(const ForceCurves& curves);

/// Subtracts the determined ones from all forces of their samples, with one remark for all of them, and one for the
/// others, which are not determined. Returns all.
std::vector<ForceOffset> subtract_offsets(ForceCurves& curves);

/// Whether overlaps may not count from first touch: readings begin far from zero, in steps of the curve, and at least
/// five of them are without contact. Empty: no doubt.
std::string touch_doubt(const ForceCurves& curves);

}  // namespace softgrain
