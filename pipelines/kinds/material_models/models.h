// Models of a resolved material: what runs in the place of its grains.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "common/core/text.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_models/scene.h"
#include "pipelines/kinds/material_models/summary.h"

namespace softgrain {

/// One model of one variant.
struct ModelRun {
  const MaterialModel* model = nullptr;
  const VariantResult* truth = nullptr;
  std::vector<MacroCurve> curves;  ///< one per sample
  std::string refusal;             ///< why there are none
  std::string remark;              ///< what to mind about them
  /// Curves of draws of the card, one per draw and sample. Draws that are no law are left out.
  std::vector<std::vector<MacroCurve>> drawn{};
};

/// Curves of the substitutes of one variant as they are run, by split, smallest radius and sample: mapped ones are
/// these.
using SubstituteRuns = std::map<std::tuple<double, double, std::size_t>, MacroCurve>;

/// Throws what runs throw, but for a model that this material is none for (InputError, UnusableResult): then a refusal.
ModelRun run_model(const MaterialModel& model, const VariantResult& truth, const Run& run, SubstituteRuns& substitutes);

/// Grains below `split` of the largest that the variant may have.
struct CoarseAndFine {
  std::vector<MacroBody> coarse;
  double coarse_volume = 0.0;
  double fines_volume = 0.0;

  [[nodiscard]] double share() const { return fines_volume / (coarse_volume + fines_volume); }
};
CoarseAndFine parted(const MacroPacking& packing, double cut);

/// Coarse grains and soft particles that hold `volume` together, with radii of this distribution, largest first.
std::vector<MacroBody> with_shells(std::vector<MacroBody> coarse, const Grading& shells, double volume,
                                   std::uint64_t seed, std::size_t sample);

/// Places in a box of this volume, the radii of soft bodies times `scale`; springs are gone.
void bring_into_volume(MacroPacking& packing, double volume, double scale);

/// Whether the fines are not those of the card: their span, form and preparation; empty when they are. Fines are the
/// grains below the split of cells; where bodies are not parted, that of the card.
std::string other_fines(const MaterialModel& model, const MacroSpec& spec);

/// That the model draws sizes by an exponent that is not the material's, which has none; empty otherwise.
std::string assumed_exponent(const MaterialModel& model, const MacroSpec& spec);

/// The equation of state alone, along the strains of `truth`, from its start pressure p0 and solid fraction phi0:
/// x0 = (p0/EK)^(1/n), phi_J = (phi0 - x0)/(1 - x0) of the porosity form, lateral/axial = K0 as long as the volume
/// changes; by density phi_J is `onset` and p0 follows. Both forms of the card.
MacroCurve mean_field(const CellCard& card, const MacroCurve& truth, double pressure, double onset);

/// Stresses times [x_t/x_s]^n: the state x of the truth over that of the substitute at equal strains, both from the
/// same start pressure.
void map_by_state(const CellCard& card, const MacroCurve& truth, double pressure, MacroCurve& substitute);

/// phi_J of the mixture by the card: 1/(1 + e), e the pores of fines and coarse grains over their solid volume. With a
/// `preparation` e is times the factor of the card for it. Throws InputError where it has none.
double onset_by_card(const CellCard& card, double share, const std::string& preparation = "");

/// The preparation of the material, where it is that of the card or one that the card has a factor for; else empty:
/// that of the card stands for it.
std::string known_preparation(const CellCard& card, const MacroSpec& spec);

// Curves of models beside the truth.

/// Samples that truth and model came through to the end are compared, pair by pair, by their mean curves, point by
/// point; those that a model did not are named. Strain and stress of z are axial.
ModelScore score(const ModelRun& run, bool blind);

/// Square root of sum (model - truth)^2 over sum truth^2 of the points from `first` on. NaN where there is none.
double relative_difference(const std::vector<double>& model, const std::vector<double>& truth, std::size_t first);

TextTable table_of(const std::vector<ModelScore>& scores);
std::string console_summary(const std::vector<ModelScore>& scores);

}  // namespace softgrain
