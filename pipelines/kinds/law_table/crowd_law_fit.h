// Law tables out of crowd measurements: what a scene of kind law-table and softgrain calibrate do once the measurements
// are there.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibrate/crowd_fit.h"
#include "common/data/crowd_law.h"
#include "common/io/scene.h"
#include "pipelines/kinds/law_table/crowd_scene.h"

namespace softgrain {

struct CrowdLawFit {
  LawTable table;
  std::vector<std::string> remarks;
  bool usable = true;  ///< every recorded point came to rest, and the best law of every entry is good
};

/// "12.1 % on what was held out", or that nothing was; "9.6 % leaving one out", or that there was but one.
std::string held_out_text(const CrowdLaw& law);
std::string cross_text(const CrowdLaw& law);

/// Reads `discrepancy`, `replicates`, `min_packings` and `largest_error`. Throws BadInput.
CrowdFitOptions read_crowd_fit(const SceneTable& t);

/// Mistakes of a scene of which there would be no fit: too few packings, no plane alone. `calibrate`: the table of
/// `fit`.
void require_law_of_crowds(const SceneTable& root, const CrowdSetup& setup, const SceneTable& calibrate,
                           const CrowdFitOptions& fit);

/// Fits `data` and adds an entry at the solid fraction of its packings, between those that are there. `target`: wanted
/// standard error of mean forces, for the remarks. Throws BadInput when the table has an entry at this solid fraction,
/// and what fit_crowd_laws() throws.
void add_entry(CrowdLawFit& fit, const CrowdMeasurements& data, const CrowdFitOptions& options, double target);

/// All entries with forms, parameters and errors.
nlohmann::json entries_json(const LawTable& table);

/// A few lines per entry.
std::string entries_text(const LawTable& table);

}  // namespace softgrain
