// What a macro scene came to: summary.json of its run, which the report reads back.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "macrosim/macro_spec.h"
#include "pipelines/kinds/macro/bands.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// The law that a run took, and the file that it stands in.
struct RunLaw {
  LawIdentity identity;
  std::string file;
};

void fields(auto&& visit, Of<RunLaw> auto& s) {
  fields(visit, s.identity);
  visit("file", s.file, Means{"file that the law stands in"});
}

void fields(auto&& visit, Of<BandRecord> auto& b) {
  visit("engine", b.engine, Means{"law whose band it is"});
  visit("estimator", b.estimator, Means{"how the band was estimated"});
  visit("draws", b.draws, Means{"number of draws", "1"});
  visit("components", b.components, Means{"number of principal components; 0: the band is of draws", "1"});
  visit("runs", b.runs, Means{"runs per sample beside the run itself", "1"});
  visit("explained", b.explained, Means{"share of the scatter of the law's forces that the components hold", "1"});
  visit("origin", b.origin, Means{"where the scatter of the law comes from"});
  visit("discrepancy", b.discrepancy,
        Means{"error of the form of the law: standard deviation of the logarithm of forces; null: not known", "1"});
  visit("discrepancy_origin", b.discrepancy_origin, Means{"where that error comes from"});
  visit("noise", b.noise, Means{"relative standard deviation of one run; 0: not run again", "1"});
}

void fields(auto&& visit, Of<BandedEnd> auto& e) {
  visit("of", e.of, Means{"quantity"});
  visit("engine", e.engine, Means{"law whose band it is"});
  visit("strain", e.strain, Means{"strain at the last point, of a stage that slides its shear strain", "1"});
  visit("stress", e.stress, Means{"mean over the samples", "Pa"});
  visit("low", e.low, Means{"lower end of the 95 % interval", "Pa"});
  visit("high", e.high, Means{"upper end of the 95 % interval", "Pa"});
  visit("law", e.law, Means{"part of the law in the half-width", "Pa"});
  visit("discrepancy", e.discrepancy, Means{"part of the form of the law in the half-width; null: not known", "Pa"});
  visit("samples", e.samples, Means{"part of the samples in the half-width; null with one", "Pa"});
  visit("sample_count", e.count, Means{"number of samples", "1"});
  visit("law_beyond_share", e.beyond,
        Means{"share of the uses of the law at this point beyond what was measured", "1"});
  visit("determined", e.determined, Means{"false where the interval would hold 0 too"});
}

struct MacroRunSummary {
  SummaryHead head;
  std::optional<RunLaw> law;
  MacroSummary runs;
  std::optional<EngineUse> engine;
  std::vector<BandRecord> bands{};
  std::vector<BandedEnd> band_ends{};
};

void fields(auto&& visit, Of<MacroRunSummary> auto& s) {
  fields(visit, s.head);
  visit("law", s.law, kLeftOut, Means{"law that the run took"});
  fields(visit, s.runs);
  visit("engine", s.engine, kLeftOut, Means{"program that moved the bodies, when it was another"});
  visit("bands", s.bands, Means{"bands of the laws that have error bars"});
  visit("band_ends", s.band_ends, Means{"stresses at the last point with their intervals"});
}

// Numbers and curves by which macro runs, and resolved materials, are set beside others.

/// Curves of all samples of one engine or material, and what it is called.
struct NamedCurves {
  std::string name;  ///< empty: there is nothing else
  std::vector<MacroCurve> curves;
};

/// The curves of each engine, in the order of the run; without names where there is one.
std::vector<NamedCurves> by_engine(const std::vector<MacroCurve>& curves);

/// Axial stress and lateral ratio at the end, means over the usable samples. Tests in stages also have moduli and
/// strength.
std::vector<RunValue> stress_values(const std::vector<NamedCurves>& all);

/// Axial stress over strain, mean over the usable samples that have all recorded points.
std::vector<RunCurve> stress_curves(const std::vector<NamedCurves>& all);

/// Why a test may begin under less stress than its preparation ended with: one sentence for every engine whose first
/// recorded points bear, in the mean of its samples, less than half of start_pressure E; the preparation itself meets
/// it to a third.
std::vector<std::string> first_point_remarks(const MacroSpec& spec, const std::vector<MacroCurve>& curves);

}  // namespace softgrain
