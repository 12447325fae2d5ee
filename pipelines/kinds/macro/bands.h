// Error bars of macro runs: the scene run with draws of its law, and with what the form of the law may be off.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_band.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/law/law_draws.h"

namespace softgrain {

/// What the band of one law came from.
struct BandRecord {
  std::string engine;
  BandEstimator estimator{};
  std::int64_t draws = 0;
  std::int64_t components = 0;  ///< 0: of draws
  std::int64_t runs = 0;        ///< per sample, beside the run itself
  double explained = 1.0;       ///< share of the scatter of the law's forces that the components hold
  std::string origin;
  double discrepancy = 0.0;  ///< error of the form of law: standard deviation of the logarithm of forces; NaN: unknown
  std::string discrepancy_origin;
  double noise = 0.0;  ///< relative standard deviation of one run; 0: not run again
};

/// Runs what the bands of these laws need on all samples, and adds them to their curves (common/data/macro_band.h).
/// Bands of a law that has none to draw from: InputError before any run (see law_draws).
std::vector<BandRecord> add_bands(const MacroRuns& runs, const std::vector<LawDraws>& laws, const Run& run,
                                  std::vector<MacroCurve>& curves);

/// The draws of all laws that a scene wants bands of; empty where it wants none.
std::vector<LawDraws> draws_for(const MacroSetup& setup, const LawSources& sources, const std::vector<NamedLaws>& laws,
                                double contents_fraction);

/// Mean over the samples of an engine at its last point, with the parts of its 95 % interval: half-widths [Pa].
struct BandedEnd {
  BandOf of = BandOf::axial;
  std::string engine;
  double strain = 0.0;                 ///< strain_at_end()
  const char* strain_name = "strain";  ///< what it is called
  double stress = 0.0;
  double low = 0.0;
  double high = 0.0;
  double law = 0.0;
  double discrepancy = 0.0;  ///< NaN: unknown
  double samples = 0.0;      ///< Student's, of the mean over samples; NaN with one
  std::int64_t count = 0;    ///< number of samples
  double beyond = 0.0;       ///< share of the uses of the law at this point beyond what was measured
  /// False where the interval would hold 0 too: nothing is known of a stress but that it is not larger. Ends are NaN.
  bool determined = true;
};

/// The BandedEnd of every engine that has bands.
std::vector<BandedEnd> banded_ends(const std::vector<MacroCurve>& curves);

/// "law: axial stress at strain 0.2: 1234 Pa, 95 % 1100 to 1380 (law 4 %, discrepancy 8 %, samples 5 %)".
std::string banded_text(const BandedEnd& end);

/// All of them, and what they came from.
std::string bands_text(const std::vector<BandRecord>& bands, const std::vector<BandedEnd>& ends);

/// A warning for every engine that was asked for a band and has none at its last point.
std::vector<std::string> missing_bands(const std::vector<BandRecord>& bands, const std::vector<BandedEnd>& ends);

}  // namespace softgrain
