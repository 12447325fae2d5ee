// The law of the whole: one equation of state from its onset, and the cell law of its coarsest level among all fines.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_law/fit.h"
#include "pipelines/kinds/recipe/onset.h"

namespace softgrain {

/// The cell law fitted to the coarsest level, the next one and their mixtures.
MaterialLaw fit_coarsest(const RecipeScene& scene, const std::vector<VariantResult>& results,
                         const std::optional<StateFit>& states, std::uint64_t seed);

/// Why there is no cell law, what is missing without it, and what to do; `shells`: a shell law was asked for too.
std::string no_cell_law_text(const std::vector<std::string>& problems, bool staged, bool shells);

/// Density of the grains of the whole, mean over their solid volume [kg/m^3].
double grain_density(const RecipeScene& scene);

/// The card of the coarsest level among everything finer: e_J is that of `fines`, and w_inf goes with it, as pores of
/// LevelForms do.
CellCard among_all_fines(const RecipeScene& scene, const CellCard& coarsest, const OnsetByForms& fines);

/// How packings answer the test, beside the equation of state: over the strain the pressure of each over that of its
/// own onset from the start pressure on (a packing at rest is softer at first), and lateral over axial stress.
struct ResponseShape {
  std::vector<double> strain;
  std::vector<double> factor;            ///< mean over packings
  std::vector<double> factor_deviation;  ///< standard deviation over them
  std::vector<double> ratio;             ///< lateral over axial stress of lateral_packing()
  std::vector<double> ratio_deviation;   ///< standard deviation over all packings
};

/// The variant whose K0 is taken for that of the first `count` levels: the mixture of the two coarsest levels with the
/// nearest share of fines. Never the check, which the prediction is held against.
std::size_t lateral_packing(const RecipeScene& scene, std::size_t count);

/// Of all packings but the check.
ResponseShape shape_of(const RecipeScene& scene, const std::vector<VariantResult>& results, const StateFit& states);

/// What the whole is: for the card and the curve.
struct WholeLaw {
  StateForm form = StateForm::porosity;
  Estimate modulus;   ///< K
  Estimate exponent;  ///< n
  Estimate onset;     ///< phi_J
  ResponseShape shape;
  double start_pressure = 0.0;  ///< start pressure over E
  double pressure_low = 0.0;    ///< lowest pressure of the fit over E
  double pressure_high = 0.0;   ///< highest pressure of the fit over E
};

/// phi at the start pressure, by the onset and its ends.
Estimate solid_fraction_of(const WholeLaw& law);

/// Oedometric compression from the start pressure, `steps` points to `strain`: p by phi = phi_0/(1 - strain) times the
/// factor of the shape, axial stress 3 p/(1 + 2 K0); beyond the strain that was measured the shape stays. The band
/// holds the ends of the onset, and of factor and ratio twice their deviations among packings; it has NaN
/// where the pressure is beyond that of the fit, and is empty where the onset has no interval.
RecipeCurve curve_of(const WholeLaw& law, double strain, std::int64_t steps);

/// Sets the constrained moduli of all curves between the same two axial stresses over E; zeros: from half the stress
/// where the lower end of the first one's band ends to that. A curve that does not go through both has none. Returns
/// the two stresses.
std::array<double, 2> set_moduli(std::vector<RecipeCurve>& curves, std::array<double, 2> interval);

/// Pressures this little above those of the fit are not yet called extrapolated.
inline constexpr double kHardlyBeyond = 1.05;

/// Lateral over axial stress where the shape ends, the interval by the deviation among packings. Where that is not
/// finite, the error is not known.
Estimate lateral_ratio(const ResponseShape& shape);

/// Lateral over axial stress (K0) of the usable samples of a packing: at the end of the test, with stages where the
/// axial stress is highest.
std::vector<double> end_ratios(const VariantResult& packing);

/// K0 of the first `count` levels there: of lateral_packing(), with the deviation among all packings but the check.
Estimate predicted_lateral_ratio(const RecipeScene& scene, const std::vector<VariantResult>& results,
                                 std::size_t count);

/// Writes the card as TOML, for people and programs. Atomic. Throws IoError.
void write_material_card(const RecipeScene& scene, const WholeLaw& law, const std::string& path,
                         const Provenance& provenance);

}  // namespace softgrain
