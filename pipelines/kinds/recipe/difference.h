// What a change of the mix does: two recipes with one set of packings, models and random numbers.
#pragma once

#include <string>
#include <vector>

#include "calibrate/equation_of_state_fit.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/report/run_data.h"
#include "pipelines/results/paired_summary.h"

namespace softgrain {

/// Share of the solid volume that has another size in the other distribution, 0 to 1: half of the sum over sizes of
/// the differences of volume shares.
double moved_share(const Grading& a, const Grading& b);

/// One packing of two recipes, in the place where both have it.
struct PackingPair {
  double a = 0.0;       ///< onset in A
  double b = 0.0;       ///< onset in B; a where both are the same packing
  double rods_a = 0.0;  ///< onset of its sizes by rods
  double rods_b = 0.0;
};

/// The same with the scatter shared out: what a packing lies above or below its rods hardly changes with a small change
/// of its sizes, unlike the scatter of packings, which no common random numbers take away. So both get the mean of the
/// two residuals, and what remains of a - b is rods_a - rods_b. `change` (in units of the onset) is how much the
/// residual may have changed: half of it goes to either side.
PackingPair with_common_residual(PackingPair pair, double change);

/// Differences of two runs of recipes, see KindResults::differences. Errors are paired where the scenes differ in
/// nothing but their mix (constituents, or sizes of grains) and have the same levels by number:
/// - one equation of state is fitted to the packings of both, those that are in both only once;
/// - one gap of the rods; residuals about them are shared (with_common_residual); they may change with the mix by
///   `slope` times moved_share(), the slope being that between neighbouring mixtures of two levels (root mean square,
///   without the scatter that replicates have);
/// - both ways of joining levels give a difference, replicate by replicate; the interval holds both intervals, the
/// value
///   lies between by the mean of both shares of rods.
/// K0 is measured for each mix alone: its difference has the error of independent samples, none where A and B share
/// the packing. Constrained moduli are between the same stresses, with one mean correction for relaxed packings.
PairedSummary recipe_differences(const report::RunData& a, const report::RunData& b,
                                 const std::vector<std::string>& keys);

}  // namespace softgrain
