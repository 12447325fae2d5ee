// Fit of the equation of state of packings without shells: pressure over solid fraction, for many spans at once. Its
// two forms are those of StateForm (common/data/cell_card.h): p/E = K x^n beyond the onset phi_J.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibrate/least_squares.h"
#include "calibrate/state_curves.h"
#include "common/core/statistics.h"

namespace softgrain {

/// Samples that share their onset: those of one span and preparation. All numbers are without unit.
struct StateGroup {
  std::string name;
  double span = 1.0;  ///< largest over smallest radius
  int samples = 0;
  int points = 0;
  Estimate onset;            ///< phi_J with K and n of all groups
  double own_modulus = 0.0;  ///< K with this group's own K (n shared): for the test of the collapse
};

struct StateFitOptions {
  StateForm form = StateForm::porosity;
  int replicates = 400;    ///< refits to drawn residuals, for errors and intervals
  std::uint64_t seed = 1;  ///< of these draws
};

struct StateFit {
  bool usable = false;
  std::string message = "not run";
  LeastSquaresFit fit;             ///< parameters ln K, n, phi_J of the groups
  Estimate modulus;                ///< K, over E
  Estimate exponent;               ///< n
  std::vector<StateGroup> groups;  ///< groups by span, then name
  double pressure_deviation =
      0.0;  ///< rms of ln(p/p_fit) within samples (each at its own onset): how well the form holds
  double sample_deviation = 0.0;  ///< standard deviation of the onsets of samples within their groups
  /// Degrees of freedom of the intervals: samples less groups; where one K for all is refused, groups less one if that
  /// is fewer.
  int degrees = 0;
  double modulus_scatter = 0.0;       ///< standard deviation over mean of own_modulus
  double collapse_probability = 0.0;  ///< probability of a scatter between groups as large as this if K is the same for
                                      ///< all; below 0.05 it hardly is
  bool one_modulus = true;            ///< whether one K for all groups is not refused
  std::vector<std::vector<double>> replicates;  ///< ln K, n, phi_J of the groups
  int left_out = 0;                             ///< points without pressure

  /// The group of this name; null without one.
  [[nodiscard]] const StateGroup* find(const std::string& name) const {
    for (const StateGroup& g : groups)
      if (g.name == name) return &g;
    return nullptr;
  }
};

/// Least squares of phi at given p: near the onset pressures vanish and samples differ by their onsets above all, a
/// shift in phi that is the same at every pressure. Points with p <= 0 lie below the onset, of which they tell nothing
/// more. Points of one sample belong together, so errors come from samples: the residual curve of each sample (over ln
/// p, about a fit with K of its own for every group) is a unit, and replicates (bootstrap of residuals, Efron and
/// Tibshirani 1993, ch. 9, ISBN 0412042312) put curves drawn from all samples with
/// replacement on the fitted model, scaled by sqrt(N/(N - G)) for the N samples that determined G onsets, and fit
/// again. Intervals are Student's, N - G degrees. This takes the scatter to be alike in all groups; a group of one
/// sample then has an error too. Whether K is the same for all
/// is judged by the ln K of single samples: their scatter between groups against that within (F test). Where one K is
/// refused (probability below 0.05), groups are the units: replicates give every group a K of its own, drawn with the
/// deviation of ln K between groups, intervals have G - 1 degrees (or N - G), and that of K is of the K of another
/// packing of this kind: it holds the deviation between packings beside the error of their mean.
/// Throws InputError for curves that read_state_curves refuses and options out of range. Not usable with the reason: no
/// convergence, fewer than three points more than numbers, n at the end of what is tried. An interval of K that is
/// wider than a factor of a hundred to either side (K is not determined) or of three, and errors that are infinite with
/// one sample in every group, are in the message.
StateFit fit_equation_of_state(const std::vector<StateCurve>& curves, const StateFitOptions& options = {});

}  // namespace softgrain
