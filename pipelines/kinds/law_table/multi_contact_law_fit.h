// Law tables out of multi-contact measurements: what a scene of kind law-table and softgrain calibrate do once the
// measurements are there.
#pragma once

#include <string>
#include <vector>

#include "calibrate/multi_contact_fit.h"
#include "common/data/multi_contact_law.h"
#include "common/io/scene.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/kinds/law_table/summary.h"

namespace softgrain {

struct MultiContactLawFit {
  LawTable table;
  std::vector<std::string> remarks;
  std::vector<std::string> warnings{};  ///< what may make the law wrong for its purpose
  bool usable = true;  ///< every recorded point is in equilibrium, and the best law of every entry is good
};

/// "12.1 % on what was held out", or that nothing was; "9.6 % leaving one out", or that there was but one.
std::string held_out_text(const MultiContactLaw& law);
std::string cross_text(const MultiContactLaw& law);

/// Reads `discrepancy`, `replicates`, `min_packings` and `largest_error`. Throws InputError.
MultiContactFitOptions read_multi_contact_fit(const SceneTable& t);

/// Mistakes of a scene of which there would be no fit: too few packings, no plane alone. `calibrate`: the table of
/// `fit`.
void require_law_of_multi_contact(const SceneTable& root, const MultiContactSetup& setup, const SceneTable& calibrate,
                                  const MultiContactFitOptions& fit);

/// Fits `data` and adds an entry at the solid fraction of its packings, between those that are there. `target`: wanted
/// standard error of mean forces, for the remarks. Throws InputError when the table has an entry at this solid
/// fraction, and what fit_multi_contact_laws() throws. Returns the solid fraction.
double add_entry(MultiContactLawFit& fit, const MultiContactMeasurements& data, const MultiContactFitOptions& options,
                 double target);

/// All entries with forms, parameters and errors.
std::vector<EntrySummary> summaries_of(const LawTable& table);

/// A few lines per entry.
std::string entries_text(const LawTable& table);

}  // namespace softgrain
