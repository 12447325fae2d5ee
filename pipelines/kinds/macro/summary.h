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
  visit("file", s.file);
}

void fields(auto&& visit, Of<BandRecord> auto& b) {
  visit("engine", b.engine);
  visit("estimator", b.estimator);
  visit("draws", b.draws);
  visit("components", b.components);
  visit("runs", b.runs);
  visit("explained", b.explained);
  visit("origin", b.origin);
  visit("discrepancy", b.discrepancy);
  visit("discrepancy_origin", b.discrepancy_origin);
  visit("noise", b.noise);
}

void fields(auto&& visit, Of<BandedEnd> auto& e) {
  visit("of", e.of);
  visit("engine", e.engine);
  visit("strain", e.strain);
  visit("stress", e.stress);
  visit("low", e.low);
  visit("high", e.high);
  visit("law", e.law);
  visit("discrepancy", e.discrepancy);
  visit("samples", e.samples);
  visit("sample_count", e.count);
  visit("law_beyond_share", e.beyond);
  visit("determined", e.determined);
}

struct MacroRunSummary {
  SummaryHead head;
  std::optional<RunLaw> law;
  MacroSummary runs;
  std::optional<EngineUse> engine;
  std::vector<BandRecord> bands{};  ///< bands of the laws that have error bars
  std::vector<BandedEnd> band_ends{};
};

void fields(auto&& visit, Of<MacroRunSummary> auto& s) {
  fields(visit, s.head);
  visit("law", s.law, kLeftOut);
  fields(visit, s.runs);
  visit("engine", s.engine, kLeftOut);
  visit("bands", s.bands);
  visit("band_ends", s.band_ends);
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
