// From measurements to the threshold power laws of a contact, with honest uncertainty.
//
//   f(D) = 0 (D < delta), a D^b + c (D >= delta), c = -a delta^b          [SP 1.5], D = hn/Rs, f = Fn/(E Rs^2)
//
// jointly for the normal force, the initial slope of kt/(E Rs) and its secant, with one delta. Points are weighted by
// one over the sample standard deviation over packings at their Delta (floored, see floored_deviations). Standard
// errors come from a covariance whose clusters are packings; 95 % intervals from a bootstrap over packings.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrate/curve_samples.h"
#include "calibrate/threshold_model.h"
#include "common/data/law_card.h"
#include "common/data/measurements.h"

namespace softgrain {

struct FitOptions {
  std::string relaxation;  ///< relaxation whose runs are fitted; empty: the only one present
  double delta_low = 0.0;  ///< fitted range of Delta
  double delta_high = std::numeric_limits<double>::infinity();
  double initial_angle_deg = 0.05;         ///< largest |angle| of the initial slope [degree]
  std::optional<double> secant_angle_deg;  ///< angle of the secant [degree]; empty: as default_secant_angle() says
  double noise_floor = 1e-6;               ///< means below this (dimensionless) count as zero force
  double scatter_floor = 0.02;             ///< smallest weight-giving deviation, as a share of the pooled deviation
  int min_packings = 5;   ///< fewest packings for an interval; the published protocol asks for at least seven
  int replicates = 1000;  ///< replicates of the bootstrap; 0: none (the law is then marked underdetermined)
  std::uint64_t seed = 0;
  /// Measured outside, in few samples or one: errors of single values by experiment_errors() instead of the scatter
  /// alone, and with fewer than min_packings samples intervals from residuals.
  bool experiment = false;
  std::vector<GivenError> given_errors;  ///< errors of the normal force over E Rs^2, when the experiment states them
  /// Delta of each sample below which its readings made the zero of the force (0: not so); a redrawn sample is set to
  /// zero again.
  std::vector<double> zeroed_below{};
  bool subtract_offset = true;  ///< experiment: whether constant forces without contact (ForceOffset) are taken off
};

/// The angle of the secant that a law takes for kt [degree]: at kSecantAngle soft particles on a plane have the
/// published stiffness; of two soft particles the secant at 0.5 degree is taken where it was measured, else that at
/// kSecantAngle. Of an experiment it is kSecantAngle for both, at which its forces are read.
double default_secant_angle(PairKind kind, const std::vector<const PackingRun*>& runs);

/// What a fit found beside the law itself.
struct FitReport {
  PairLaw law;
  std::vector<std::array<double, 7>> replicates;  ///< bootstrap, order of kLawParameterNames, parameters of a D^b + c
  int replicates_failed = 0;    ///< resamples whose fit did not converge or was rank-deficient; not among `replicates`
  int replicates_at_bound = 0;  ///< among `replicates`, with an exponent or the upper end of delta at its bound
  int normal_left_out = 0;      ///< normal points that were measured but not converged
  int tangential_left_out = 0;  ///< tangential points that were measured but not converged
  int iterations = 0;           ///< iterations of the optimiser over all intervals of delta
  bool from_residuals = false;  ///< replicates are of residuals, not of packings
  std::size_t drawn_packings = 0;  ///< packings that replicates were drawn from; widens intervals where these are few
  std::string fit_message;         ///< why the optimiser ended
};

/// Fits one pair kind. status of the law:
///   "good"; "no threshold crossing" (no mean force clearly above the noise floor: above it and above two standard
///   errors); "underdetermined" (best values are in the card, but must not be used: the reason says why); "not run" (no
///   such data).
/// `quality` is the chi^2 tail probability of the packing means above threshold. Means at neighbouring Delta come from
/// the same packings and move together, so it is a guide, not a test of level; 0 without degrees of freedom or scatter.
/// Throws InputError for options out of range or an ambiguous relaxation.
FitReport fit_pair_law(const Measurements& data, PairKind kind, const FitOptions& options = {});

/// Fits every pair kind present. Throws InputError when nothing matches the relaxation asked for.
LawCard calibrate(const Measurements& data, const FitOptions& options = {}, std::vector<FitReport>* reports = nullptr);

/// Bands on an even grid up to the end of the fitted range, for the curves that were fitted; nothing without
/// replicates.
void add_bands(PairLaw& law, const FitReport& report);

/// The law and its 95 % band at one Delta (dimensionless).
struct Band {
  double delta = 0.0;
  double value = 0.0;
  double low = 0.0;   ///< 2.5 % quantile over bootstrap replicates; -infinity without replicates
  double high = 0.0;  ///< 97.5 %
};

/// a, b and delta are nearly degenerate: judge a law by this band, not by their intervals.
std::vector<Band> law_band(const FitReport& report, LawCurve curve, std::span<const double> deltas);

/// The relaxation that options and data agree on. Throws InputError.
std::string chosen_relaxation(const Measurements& data, const FitOptions& options);

// The parts of a law card that follow from data, fit and replicates: descriptions, estimates with intervals, goodness
// of fit.

using LawSamples = std::array<CurveSamples, kLawCurves>;
using LawMeans = std::array<CurveMeans, kLawCurves>;

/// Range, counts, table and largest grain overlap of the data behind a law.
void describe_data(const RunList& runs, const LawSamples& samples, const LawMeans& means, FitReport& report);

/// One curve's law from its parameters (order of kLawParameterNames): standard errors from report.law.covariance
/// (infinite when `errors_known` is false), intervals from report.replicates (infinite when there are none).
ThresholdPowerLaw estimated_law(const FitReport& report, const std::array<double, 7>& parameters, std::size_t curve,
                                bool errors_known);

/// chi^2 per degree of freedom of the packing means above threshold, and its tail probability; both 0 without freedom.
void fill_goodness(const FitCurves& curves, const JointParameters& found, double noise_floor, PairLaw& law);

}  // namespace softgrain
