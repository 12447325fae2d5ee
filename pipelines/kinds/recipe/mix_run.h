// Two runs of recipes that differ in their mix: what was measured, which packings are in both, and what the change of
// the mix does, with its error.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/recipe/paired_replicates.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/recipe/summary.h"
#include "pipelines/report/run_data.h"
#include "pipelines/results/paired_summary.h"

namespace softgrain {

/// Two recipes that errors cannot be paired of; says why.
struct NotPaired : InputError {
  using InputError::InputError;
};

/// A run of a recipe: scene, summary, and the curves of its packings by variant.
struct MixRun {
  RecipeScene scene;
  RecipeSummary summary;
  std::vector<VariantResult> results;

  [[nodiscard]] const MaterialVariant& variant(std::size_t v) const { return scene.material.variants[v]; }
};

/// Throws NotPaired where files or a law are missing, InputError, IoError.
MixRun load_mix(const report::RunData& data);

/// Throws NotPaired where one of the keys that differ says more than what is mixed: how it is packed, tested or fitted.
void require_one_protocol(const std::vector<std::string>& keys);

/// Throws NotPaired where the runs have different numbers of levels.
void require_alike(const MixRun& a, const MixRun& b);

/// Packings of B that are packings of A, to the last bit: name in B, name in A.
std::map<std::string, std::string> shared_packings(const MixRun& a, const MixRun& b);

/// The curves behind the equation of state of a run and their fit, as the run made it. Throws NotPaired where it is not
/// usable.
FittedCurves fit_again(const MixRun& run);

/// Options of that fit.
StateFitOptions state_options(const MixRun& run);

/// Share of the solid volume that has another size in the other distribution, 0 to 1: half of the sum over sizes of
/// the differences of volume shares.
double moved_share(const Grading& a, const Grading& b);

/// How fast a number of packings changes from one mixture of two neighbouring levels to the next, in units of the share
/// of fines: root mean square over all steps of both runs. The scatter of packings is in it: taken out, what is left
/// of few packings would often be 0.
struct NeighbourSlope {
  double value = 0.0;
  double steps = 0.0;  ///< number of steps in one run, taken as degrees of freedom: packings may be in both
};
/// `of_a`, `of_b`: the number by variant; steps from or to one that is not finite are left out.
NeighbourSlope neighbour_slope(const RecipeScene& a, const std::vector<double>& of_a, const RecipeScene& b,
                               const std::vector<double>& of_b);

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
