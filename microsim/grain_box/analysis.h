// What follows from a run, or from a scene before it runs.
#pragma once

#include <string>
#include <vector>

#include "microsim/grain_box/record.h"

namespace softgrain {

/// Interval moduli near one stress of the loading phase: means of K and G over the intervals that end within 10 % of
/// it, with standard errors from their scatter, and the mean normal force there, by which the publication explains the
/// order of K with the pressure of generation.
struct ModuliAt {
  double pressure = 0.0;  ///< stress asked for [Pa]
  double bulk = 0.0;      ///< K [Pa]; NaN with fewer than 3 intervals, as the others
  double bulk_error = 0.0;
  double shear = 0.0;
  double shear_error = 0.0;
  double force = 0.0;  ///< mean normal force over sigma_c, times the stress asked for [N]
  double force_error = 0.0;
  std::size_t points = 0;
};
[[nodiscard]] ModuliAt moduli_at(const GrainBoxResult& result, double pressure);

/// Means over the arrangements of one pack: K, G and the mean normal force at a stress, and the sliding share at the
/// end of the loading. Standard errors are over arrangements. NaN where fewer than two of them have a value.
struct OverArrangements {
  std::string pack;
  std::size_t arrangements = 0;  ///< number of arrangements that came to their end
  std::vector<ModuliAt> moduli;  ///< means at comparison_stresses(); `points` counts arrangements
  double sliding = 0.0;
  double sliding_error = 0.0;
};
/// One entry for every pack that has two arrangements or more, in the order of the results.
[[nodiscard]] std::vector<OverArrangements> over_arrangements(const std::vector<GrainBoxResult>& results);

/// Round stresses within the loading of all packs, at which their moduli are set side by side [Pa].
[[nodiscard]] std::vector<double> comparison_stresses(const std::vector<GrainBoxResult>& results);

/// sigma_c at which G, averaged over 10 intervals, is smallest with friction on (generation and loading): before,
/// contacts begin to slide one after the other; after, the pack stiffens with stress. NaN with fewer than 10 intervals
/// [Pa].
[[nodiscard]] double pressure_of_smallest_shear(const GrainBoxResult& result);

/// Largest ratio of a stress to sigma_c in the loading phase.
[[nodiscard]] double largest_over_pressure(const GrainBoxResult& result, double BoxPoint::*stress);

/// Sums over all points.
[[nodiscard]] StepEffort total_effort(const GrainBoxState& state);

/// Estimates by the effective medium with a solid fraction of 0.63 and 6 contacts per grain, for `check`.
struct GrainBoxForecast {
  double box_length = 0.0;     ///< geometric mean side when jammed [m]
  double increments = 0.0;     ///< number of increments of the loading
  double overlap_ratio = 0.0;  ///< h/R of a mean contact at the largest stress
  double contacts = 0.0;
  double bytes = 0.0;
};
[[nodiscard]] GrainBoxForecast forecast(const GrainBoxSpec& spec);

}  // namespace softgrain
