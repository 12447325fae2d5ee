// A recipe under stages of given stresses: from what its packings do to the curve of the whole, in Pa.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/text.h"
#include "common/io/scene.h"
#include "pipelines/kinds/recipe/law.h"

namespace softgrain {

/// Reads [[stage]] of a recipe: oedometric stages to stresses, unloading, reloading and cycles. `modulus_is_known`: as
/// of read_stages() of macro/stages.h. Throws InputError.
void read_recipe_stages(const SceneTable& root, MacroSpec& spec, bool modulus_is_known);

/// Isotropic compression to the mean stress that stages reach at K0 = 1/2, then shear at constant volume to a
/// logarithmic strain: the test that the friction of cells is fitted to, in place of one that begins at a strain.
void shear_at_stress(MacroSpec& spec, double shear_strain);

/// Highest axial stress that stages go to [Pa]; 0 without stages.
double highest_stress(const MacroSpec& spec);

/// "from 50 kPa, oedometric to 1 MPa, unload to 200 kPa".
std::string stages_text(const MacroSpec& spec);

/// A curve as far as its first stage goes: what laws without unloading are fitted to.
MacroCurve first_stage_of(MacroCurve curve);

/// One packing under all stages, mean over its usable samples: its state x (state_of_phi) and its stresses [Pa].
struct StatePath {
  std::string name;
  std::vector<double> state;
  std::vector<double> axial;
  std::vector<double> lateral;
};

struct StatePaths {
  StateForm form = StateForm::porosity;
  std::vector<StageRecord> stages;
  std::vector<double> stage;  ///< of every point, as MacroCurve::stage
  std::vector<StatePath> packings;
  /// Packing whose lateral stress is that of the whole, lateral_packing(); empty: the mean of all.
  std::optional<std::size_t> lateral_of;
};

/// Paths of all packings but the check with samples that came to the end of all stages.
StatePaths paths_of(const RecipeScene& scene, const std::vector<VariantResult>& results, const StateFit& states);

/// The whole with this onset, if it answered as one packing: phi follows from x, strain from phi, stresses are those of
/// the packing.
MacroCurve carried_over(const StatePaths& paths, const StatePath& packing, double onset);

/// All that `stages` of the summary say. Each quantity is taken of carried_over() for every packing. Its value is the
/// mean (of the lateral stress: that of paths.lateral_of); its interval holds the ends of the onset, and besides 1.96
/// standard deviations of the packings. `resolved`: samples with all grains of the whole, if there are any.
RecipeStages whole_under_stages(const StatePaths& paths, const Estimate& onset,
                                const std::vector<MacroCurve>& resolved = {});

/// Lateral over axial stress where the stress is highest, in the form that the card and lateral_ratio() take; a
/// deviation that is not known is infinite.
ResponseShape shape_of_stages(const RecipeStages& stages);

/// Strain and stresses over E, for the curves that laws of the coarsest level are set beside.
RecipeCurve curve_of_stages(const RecipeStages& stages, double modulus);

/// What stages are compared and swept by.
struct StageQuantity {
  std::string name;  ///< with that of its stage: "K0 at the end, unload"
  const char* unit;  ///< empty: a plain number
  Estimate value;
};

/// Constrained modulus [Pa], K0, void ratio and Cc or Cs of a stage.
std::vector<StageQuantity> quantities_of(const RecipeStageSummary& stage);

/// One row per recorded point: stresses in Pa, everything with its interval.
TextTable stages_table(const RecipeStages& stages);

}  // namespace softgrain
