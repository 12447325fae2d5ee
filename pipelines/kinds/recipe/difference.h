// What a change of the mix does: differences of two recipes, and how sure they are.
#pragma once

#include <string>
#include <vector>

#include "pipelines/report/run_data.h"
#include "pipelines/results/paired_summary.h"

namespace softgrain {

/// Differences of two runs of recipes, see KindResults::differences: A - B of the values of the runs. Where the scenes
/// differ in nothing but their mix (constituents, or sizes of grains) and have the same number of levels, packings that
/// are in both, to the last bit, count once and their scatter cancels (PairedOnsets); all others scatter
/// independently. Otherwise errors are those of independent runs, and the reason is given.
/// Constrained moduli are between the same stresses. Their errors have besides: the error of the difference of K0, and
/// that of the mean correction for relaxed packings, for packings that are not in both. The difference of K0 has the
/// scatter of the samples of both packings that stand for the whole, and neighbour_slope() of K0 times moved_share().
PairedSummary recipe_differences(const report::RunData& a, const report::RunData& b,
                                 const std::vector<std::string>& keys);

}  // namespace softgrain
