// Onset of pressure (phi_J) of spans that nobody can resolve, from that of smaller ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibrate/equation_of_state_fit.h"

namespace softgrain {

/// void_power: 1 - phi_J = c r^-b, the void fraction falls by one factor for each factor in the span r = r_max/r_min
/// (Brouwers 2006, PRE 74, 031309, derives it for power-law gradings, with b from the gap-free two-size packing).
/// saturating: phi_J = phi_inf - a r^-b, phi_inf <= 1: what fines of ever smaller size can still fill is a share of the
/// volume that itself falls as a power of r (number of grains ~ r^-(1 + D), D < 3: volume below r_min ~ r_min^(3 - D)).
/// The first is the second with phi_inf = 1, its upper end: a real mixture lies between that and no growth at all.
/// Both rise fastest at small spans, where real mixtures rise slowest: a little spread of the sizes changes a packing
/// by the square of the spread. The other two begin as slowly. void_ratio: ln(1/phi_J - 1) = ln c - b [sqrt(L^2 + w^2)
/// - w], L = ln r: the void ratio, pores over solid, is even in L about equal spheres and falls as a power of r beyond
/// a span of e^w. rods: phi_J of equal spheres and of any mixture by rods on a line (rod_packing.h) with one gap; for
/// power laws.
enum class OnsetForm { void_power, saturating, void_ratio, rods };
std::string to_string(OnsetForm form);

struct OnsetFormFit {
  OnsetForm form = OnsetForm::void_power;
  bool usable = false;
  std::string message = "not run";
  std::vector<double> parameters;  ///< ln c, b; phi_inf, a, b; ln c, b, w; gap
  double chi2 = 0.0;               ///< sum of squared residuals in units of the errors
  /// Probability of a chi2 as large (F test, errors known with the degrees of the fit); 1 without freedom.
  double probability = 1.0;
  Estimate onset;  ///< onset at the span asked for
};

struct OnsetExtrapolation {
  bool usable = false;
  std::string message = "not run";
  double span = 1.0;                ///< span asked for
  double largest_span = 1.0;        ///< largest span that is fitted
  std::vector<OnsetFormFit> forms;  ///< forms in the order of OnsetForm
  /// Middle of the forms that the data allow; the interval reaches from the lowest to the highest of theirs, so it
  /// holds the difference of the forms too.
  Estimate onset;
  /// phi_J at the span by every usable form, of every replicate.
  std::vector<std::vector<double>> replicates;
};

struct OnsetOptions {
  std::vector<std::string> groups;  ///< groups that are used (one preparation); empty: all
  double exponent = 0.0;            ///< b of the power law P(r) ~ r^-b that all groups have; 0: none, and no rods
  double refused_below = 0.01;      ///< probability below which a form is not used
};

/// phi_J of a span that was measured elsewhere.
struct KnownOnset {
  double span = 1.0;
  double value = 0.0;
  double standard_error = 0.0;
};

/// `fit` with these onsets as groups without samples, for extrapolate_onset(). Their replicates are normal, independent
/// of those of the fit, and of the width of `standard_error` as extrapolate_onset() draws them. Throws InputError for a
/// fit that is not usable or has no errors, a span that is not finite or below 1, a value outside of 0 to 1 and an
/// error that is not positive.
StateFit with_known_onsets(const StateFit& fit, const std::vector<KnownOnset>& known, std::uint64_t seed);

/// Fits all forms to the onsets of the groups, each with the weight of its error, and to every replicate of the fit.
/// Replicates are drawn away from the estimate by Student's over the normal 97.5 % quantile, as intervals of the fit
/// are. A form needs as many groups of different span as it has parameters, and is refused where its chi^2 is too
/// improbable; the saturating one only together with the void power that it contains. Throws InputError for a fit that
/// is not usable or has no errors, groups that are unknown or fewer than two of different span, a span that is not
/// finite or below 1. Not usable: all forms are refused.
OnsetExtrapolation extrapolate_onset(const StateFit& fit, double span, const OnsetOptions& options = {});

}  // namespace softgrain
