// What every engine of one macro scene got right and what it cost, against both resolved twins.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/core/statistics.h"
#include "common/data/macro_result.h"
#include "pipelines/compare/compare.h"

namespace softgrain {

/// Differences of one engine from one twin, over the samples that both ran usably.
struct TwinErrors {
  std::size_t pairs = 0;  ///< samples that both ran usably
  bool staged = false;    ///< the test is one in stages: what these impose does not count in the differences
  MeanError axial;        ///< relative L2 difference of the axial stress, as relative_difference, per sample
  /// Relative L2 difference of the mean curves over the samples. Its error is that of a curve off by the standard error
  /// of the mean paired difference at every point.
  MeanError axial_of_mean;
  MeanError axial_end;           ///< axial stress over that of the twin, at the end
  MeanError deviator;            ///< shear and stages: relative L2 difference of axial minus x stress after the preload
  MeanError strains;             ///< stages: relative L2 difference of the strains of axes that go by stress
  MeanError unloading;           ///< stages: unloading modulus over that of the twin
  MeanError lateral_ratio;       ///< lateral over axial stress at the end, minus that of the twin
  MeanError coordination;        ///< coordination number of bodies at the end, minus that of the twin
  MeanError fabric;              ///< fabric anisotropy of bodies at the end, minus that of the twin
  MeanError force_mean;          ///< mean contact force over that of the twin
  MeanError force_distance;      ///< Kolmogorov-Smirnov distance of the forces, each over its mean
  double speedup_seconds = 0.0;  ///< twin over engine, summed over samples; NaN when not recorded
  double speedup_evaluations = 0.0;
};

/// A law at the places of the shelled twin: sums of the normal forces on soft particles over those of the twin, all
/// recorded points together.
struct PlacesScore {
  MeanError solid;
  MeanError wall;
  MeanError soft;
};

struct EngineScore {
  std::string engine;
  std::size_t samples = 0;  ///< number of usable samples
  /// Relative L2 difference of the axial stress of one run from the same one with strains that differ in the twelfth
  /// digit, over sqrt(2): what paths alone make of one run. Empty: not run.
  MeanError noise;
  PlacesScore places;
  MeanError band_width;     ///< half of the 95 % band over the axial stress at the end; empty: no bands
  MeanError coverage;       ///< share of the points of the shelled twin in the band, from 5 % of its largest stress on
  MeanError coverage_end;   ///< share of the samples whose last point is in the band
  MeanError axial;          ///< axial stress at the end [Pa]
  MeanError lateral_ratio;  ///< lateral over axial stress at the end
  MeanError coordination;   ///< coordination number of bodies at the end
  MeanError fabric;         ///< fabric anisotropy of bodies at the end
  MeanError force_mean;     ///< mean force of contacts between bodies at the end [N]
  MeanError force_variation;  ///< standard deviation of these forces over their mean
  double contact_evaluations =
      0.0;               ///< per sample; a multi-contact law's visits to a contact count each: there are two
  double seconds = 0.0;  ///< per sample
  TwinErrors shelled;    ///< against the shelled twin; empty means (n = 0) when there is none
  TwinErrors free;

  [[nodiscard]] std::optional<Twin> twin() const { return parse_enum<Twin>(engine); }
};

/// One score per engine, in the order in which engines first appear. Unusable curves count nowhere; differences that
/// cannot be had (no twin, zero stress) are left out of the means.
std::vector<EngineScore> score_engines(const std::vector<MacroCurve>& curves);

/// The difference that is said first, and that laws are ordered by: what the test does not impose.
ComparedQuantity headline_of(const TwinErrors& errors);

/// Mean and coefficient of variation (sample deviation over mean); NaN without forces.
std::pair<double, double> mean_and_variation(const std::vector<double>& forces);

/// Largest difference of the cumulative distributions of two samples of values; NaN when one is empty or holds
/// a NaN.
double kolmogorov_smirnov(std::vector<double> a, std::vector<double> b);

/// Column names and cells of the score table, the same for Markdown, CSV and the report. Values as plain numbers.
struct ScoreTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};
ScoreTable score_table(const std::vector<EngineScore>& scores);

}  // namespace softgrain
