// Measured curves in dimensionless form, one row per packing: what the threshold fit and its bootstrap resample.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/data/measurements.h"

namespace softgrain {

/// ht = pi Rs alpha / 180 [m]: displacement of the grains at the shell when the particle turns by alpha degrees
/// [SP 1.4].
double tangential_displacement(double angle_deg, double shell_radius);

/// Whether two angles are the same but for rounding [degree].
bool same_angle(double a, double b);

/// Slope of the parallel force at ht = 0: least-squares line with a free intercept (prestrain) through the converged
/// points with |angle| <= angle_deg [N/m]. Empty with fewer than two different angles.
std::optional<double> initial_slope(const std::vector<TangentialPoint>& points, double angle_deg, double shell_radius);

/// (F(+angle) - F(-angle)) / (2 ht); with one sign only, against the state before rotation, which takes the prestrain
/// out as well [N/m]. Empty when the points are missing or not converged.
std::optional<double> secant(const std::vector<TangentialPoint>& points, double angle_deg, double shell_radius);

/// One quantity over overlap ratio and packing. Absent values are NaN.
struct CurveSamples {
  std::vector<double> delta;  ///< Delta, rising
  std::size_t packings = 0;
  std::vector<double> value;  ///< packings x delta, row-major; force/(E Rs^2) or stiffness/(E Rs)
  int left_out = 0;           ///< points that were measured but did not converge

  [[nodiscard]] double at(std::size_t packing, std::size_t k) const { return value[packing * delta.size() + k]; }
  [[nodiscard]] bool empty() const { return delta.empty(); }
};

/// Mean over packings per Delta.
struct CurveMeans {
  std::vector<double> delta;
  std::vector<double> mean;
  std::vector<double> deviation;  ///< sample standard deviation over packings; 0 for one packing
  std::vector<double> count;      ///< packings with a value
};

/// Means where packing i counts `multiplicity[i]` times (empty: once each). Deltas without any value keep count 0 and
/// mean 0.
CurveMeans means_of(const CurveSamples& samples, std::span<const int> multiplicity = {});

/// Error per single packing at each Delta: the deviation, but no less than a floor, because the scatter vanishes below
/// the threshold: `scatter_floor` times the pooled deviation (root of the mean square over Delta), and 1e-4 of the
/// largest mean.
std::vector<double> floored_deviations(const CurveMeans& means, double scatter_floor);

/// The runs and points that enter a curve.
struct CurveSelection {
  double delta_low = 0.0;
  double delta_high = std::numeric_limits<double>::infinity();
  double initial_angle_deg = 0.05;
  double secant_angle_deg = kSecantAngle;
};

using RunList = std::vector<const PackingRun*>;

CurveSamples normal_samples(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection);
CurveSamples initial_slope_samples(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection);
CurveSamples secant_samples(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection);

/// Overlaps at which bodies were turned and from which no stiffness follows.
struct LostTurns {
  std::size_t turns = 0;     ///< all, over all runs
  std::size_t lost = 0;      ///< those that give neither an initial slope nor a secant
  std::size_t short_of = 0;  ///< of the lost ones: none of their angles reaches that of the secant
};

LostTurns lost_turns(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection);

// How well single values of an experiment are known, when there are few samples or one.

/// Standard error of one value of a curve, given from outside.
struct GivenError {
  double delta = 0.0;
  double error = 0.0;  ///< standard error in the unit of the curve (dimensionless)
};

/// Error per single sample at each Delta, the largest of: the scatter between samples (mean square over five
/// neighbours, because two or three samples alone say little about it); the roughness of the curves (distance of a
/// point from the line through its two neighbours, mean square over a quarter of the curve); what was given; and
/// floors: `scatter_floor` times the pooled value, 1e-4 of the largest mean.
std::vector<double> experiment_errors(const CurveSamples& samples, const CurveMeans& means,
                                      const std::vector<GivenError>& given, double scatter_floor);

/// Number of neighbouring points over which residuals (samples x Delta, row-major, NaN where absent) stay correlated:
/// twice the first lag at which the autocorrelation within samples is below 0.3, at least 1, at most the longest
/// sample.
std::size_t correlation_length(const std::vector<double>& residuals, std::size_t samples);

}  // namespace softgrain
