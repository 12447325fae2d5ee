// Where pressure begins in matter that nobody packs: from the onsets of its levels and of mixtures of two.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calibrate/equation_of_state_fit.h"
#include "calibrate/rod_packing.h"
#include "common/packing/grading.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/recipe/summary.h"

namespace softgrain {

/// Value of a curve with rising x by linear interpolation; the first or last value beyond its ends.
double straight(const std::vector<double>& x, const std::vector<double>& y, double at);

/// Onset of a packing with its error, beside what rods of its sizes fill.
struct RodOnset {
  const RodCurve* curve = nullptr;
  double onset = 0.0;
  double error = 1.0;
};

/// The gap with which rods come nearest to the onsets (least squares in units of the errors).
double fitted_gap(const std::vector<RodOnset>& packings);

/// phi_J of joined levels by both forms, and by the replicates of a fit.
struct FormReplicates {
  double levels = 0.0;
  double rods = 0.0;
  std::vector<double> by_levels;
  std::vector<double> by_rods;
};

/// phi_J of joined levels by two forms, each fitted to all packings that were measured (the check apart):
/// - levels: from the finest up, a level of solid volume V_c added to finer ones of V_f and void ratio e_f leaves
///   e = e_f (w + r)/(1 + r), r = V_f/V_c. w, the pores beside the coarse grains in units of e_f V_c, is that of the
///   level's mixtures with the next finer level alone, straight between their shares of fines (at 0 the coarse level by
///   itself), the last one beyond: pores that fines leave beside larger grains go with their own;
/// - rods: of all chords of all grains on a line (rod_packing.h), with one gap fitted to all onsets; widened by how far
///   these are about it.
/// The interval reaches from the lowest to the highest end of both; the value lies between them, in the middle until
/// lean() knows better.
class LevelForms {
 public:
  /// `fit`: groups by the names of the variants. Throws UnusableResult where a packing is not among them.
  LevelForms(const RecipeScene& scene, const StateFit& fit);
  ~LevelForms();
  LevelForms(const LevelForms&) = delete;
  LevelForms& operator=(const LevelForms&) = delete;

  /// `count` levels from `first` on, as they are in the whole; `widen`: both ends of the interval by as much. One
  /// alone is as it was measured.
  [[nodiscard]] OnsetByForms joined_onset(std::size_t first, std::size_t count, double widen = 0.0) const;
  /// The same by both forms, with every replicate of the fit.
  [[nodiscard]] FormReplicates by_both_forms(std::size_t first, std::size_t count) const;
  /// Moves the value of all that follows towards the form that comes nearer to what `count` levels from the coarsest on
  /// were measured to be: the share t of rods is the least of (phi - phi_levels - t (phi_rods - phi_levels))^2/s^2 + (t
  /// - 1/2)^2/tau^2, within 0 and 1, s the error of the measurement and the deviation of rods together, tau = 0.3.
  void lean(std::size_t count, double measured, double error);
  [[nodiscard]] double share_of_rods() const;
  /// Onset of a level alone, as measured.
  [[nodiscard]] double own_onset(std::size_t level) const;
  [[nodiscard]] double gap() const;
  [[nodiscard]] double rods_deviation() const;
  /// Onsets less those of the rods, by variant; NaN for the check and for what is no packing of its own.
  [[nodiscard]] std::vector<double> rod_residuals() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The model for the sizes of the whole, with one beta for all: that with which grains of one size pack as rods of this
/// gap do, beta = phi_1 (1 + 1/K). So it differs from our value by what it makes of sizes alone.
CompressibleModelSummary compressible_model(const Grading& sizes, double gap);

/// "0.701 (K = 4.1) and 0.722 (K = 9), with beta from grains of one size (0.585)".
std::string compressible_model_text(const CompressibleModelSummary& model);

}  // namespace softgrain
