// The law of the whole: one equation of state from its onset, and the cell law of its coarsest level among all fines.
#pragma once

#include <string>
#include <vector>

#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_law/fit.h"
#include "pipelines/kinds/recipe/onset.h"

namespace softgrain {

/// The cell law fitted to the coarsest level, the next one and their mixtures.
MaterialLaw fit_coarsest(const RecipeScene& scene, const std::vector<VariantResult>& results,
                         const std::optional<StateFit>& states, std::uint64_t seed);

/// The same among everything finer: e_J is theirs by `fines`, and w_inf goes with it, as pores of LevelForms do.
CellCard among_all_fines(const RecipeScene& scene, const CellCard& coarsest, const OnsetByForms& fines);

/// K0 at the end of the compression: of the check, or of the packings whose shares come nearest; and its range over all.
struct LateralRatio {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};
LateralRatio lateral_ratio(const RecipeScene& scene, const std::vector<VariantResult>& results);

/// What the whole is: for the card and the curve.
struct WholeLaw {
  StateForm form = StateForm::porosity;
  Estimate modulus;   ///< K
  Estimate exponent;  ///< n
  Estimate onset;     ///< phi_J
  double modulus_scatter = 0.0;  ///< of K among packings, over K
  LateralRatio lateral;
  double start_pressure = 0.0;  ///< over E
  double pressure_low = 0.0;    ///< over E, of the fit
  double pressure_high = 0.0;
};

/// phi at the start pressure, by the onset and its ends.
Estimate solid_fraction_of(const WholeLaw& law);

/// Oedometric compression from the start pressure, `steps` points to `strain`: p by phi = phi_0/(1 - strain), axial
/// stress 3 p/(1 + 2 K0). The band holds the ends of the onset, twice the scatter of K and the range of K0.
RecipeCurve curve_of(const WholeLaw& law, double strain, std::int64_t steps);

/// Writes the card as TOML, for people and programs. Atomic. Throws FileTrouble.
void write_material_card(const RecipeScene& scene, const WholeLaw& law, const std::string& path,
                         const Provenance& provenance);

}  // namespace softgrain
