// What a recipe came to: summary.json of its run, which the report reads back.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/kinds/material_law/summary.h"

namespace softgrain {

struct ConstituentSummary {
  std::string name;
  double mass_share = 0.0;
  double density = 0.0;
  double volume_share = 0.0;
  std::optional<double> youngs_modulus{};  ///< E of its grains [Pa]; empty, as the next two: all grains are alike
  std::optional<double> poisson_ratio{};
  std::optional<double> friction{};
};

void fields(auto&& visit, Of<ConstituentSummary> auto& s) {
  visit("name", s.name);
  visit("mass_share", s.mass_share);
  visit("density", s.density);
  visit("volume_share", s.volume_share);
  visit("E", s.youngs_modulus, kLeftOut);
  visit("nu", s.poisson_ratio, kLeftOut);
  visit("mu", s.friction, kLeftOut);
}

/// Estimates by both forms, see LevelForms.
struct OnsetByForms {
  double levels = 0.0;
  double rods = 0.0;
  Estimate onset;  ///< the middle, and an interval that holds both
};

void fields(auto&& visit, Of<OnsetByForms> auto& s) {
  visit("levels", s.levels);
  visit("rods", s.rods);
  fields(visit, s.onset);
}

struct RecipeLevelSummary {
  std::int64_t level = 1;
  double diameter_low = 0.0;  ///< [m]
  double diameter_high = 0.0;
  double share = 0.0;       ///< share of the solid volume of all levels
  double grains = 0.0;      ///< grains of the level in a cubic metre of the whole
  std::string packing;      ///< name of the measured packing
  double onset = 0.0;       ///< phi_J of the level alone
  OnsetByForms with_finer;  ///< phi_J of it and everything finer
  /// Volume that everything finer takes up where it jams, over the voids of this level alone: above 1 its grains float
  /// in fines, below they bear and the fines have room. None for the finest.
  std::optional<double> filling;
};

void fields(auto&& visit, Of<RecipeLevelSummary> auto& s) {
  visit("level", s.level);
  visit("diameter_low", s.diameter_low);
  visit("diameter_high", s.diameter_high);
  visit("volume_share", s.share);
  visit("grains_per_cubic_metre", s.grains);
  visit("packing", s.packing);
  visit("onset", s.onset);
  visit("onset_with_finer", s.with_finer);
  visit("filling", s.filling, kLeftOut);
}

/// The coarsest levels with all their grains.
struct RecipeCheckSummary {
  std::int64_t levels = 0;
  std::int64_t grains = 0;
  double span = 1.0;
  Estimate measured;  ///< phi_J
  OnsetByForms predicted;
  bool weighs = true;          ///< whether it tells which form does better; else the value is in the middle
  double share_of_rods = 0.5;  ///< share of rods in the value of the whole, see LevelForms::lean
  double outside = 0.0;        ///< how far the measured one lies outside the interval, which intervals are widened by
  /// K0 as predicted by mixtures of two levels, and of the samples; nothing in results of earlier versions.
  std::optional<PredictedValue> lateral_ratio;
};

void fields(auto&& visit, Of<RecipeCheckSummary> auto& s) {
  visit("levels", s.levels);
  visit("grains", s.grains);
  visit("span", s.span);
  visit("measured", s.measured.value);
  visit("measured_standard_error", s.measured.standard_error);
  visit("predicted", s.predicted);
  visit("weighs_forms", s.weighs);
  visit("share_of_rods", s.share_of_rods);
  visit("outside", s.outside);
  visit("K0", s.lateral_ratio, kLeftOut);
}

/// Constrained modulus between two axial stresses, over logarithmic strain; all over E. NaN: an end of the band does
/// not go through both.
struct SecantModulus {
  double from = 0.0;
  double to = 0.0;
  double value = 0.0;
  double low = kNaN;
  double high = kNaN;
};

void fields(auto&& visit, Of<SecantModulus> auto& s) {
  visit("from", s.from);
  visit("to", s.to);
  visit("value", s.value);
  range_field(visit, "interval", s.low, s.high);
}

/// Oedometric compression from the start pressure; stresses over E.
struct RecipeCurve {
  std::string name;
  std::vector<double> strain, axial, lateral;
  std::vector<double> low, high;  ///< band of the axial stress; empty: not known
  std::string problem;            ///< why it ends, or is not there
  std::optional<SecantModulus> modulus{};
};

void fields(auto&& visit, Of<RecipeCurve> auto& s) {
  visit("name", s.name);
  visit("strain", s.strain);
  visit("axial", s.axial);
  visit("lateral", s.lateral);
  visit("axial_low", s.low);
  visit("axial_high", s.high);
  visit("problem", s.problem);
  visit("constrained_modulus", s.modulus, kLeftOut);
}

/// A level of the shell hierarchy.
struct ShellLevelSummary {
  std::int64_t level = 0;  ///< 0: the finest
  double diameter_low = 0.0;
  double diameter_high = 0.0;
  double force = 0.0;   ///< force of one plane at h/Rs = 0.2, over E Rs^2
  double grains = 0.0;  ///< number of grains that one soft particle represents
};

void fields(auto&& visit, Of<ShellLevelSummary> auto& s) {
  visit("level", s.level);
  visit("diameter_low", s.diameter_low);
  visit("diameter_high", s.diameter_high);
  visit("force_over_E_Rs2", s.force);
  visit("grains", s.grains);
}

/// The compressible packing model (de Larrard 1999) for the sizes of the whole, which is a model of others: solid
/// fraction with a beta for which grains of one size pack as they do here.
struct CompressibleModelSummary {
  double one_size = 0.0;          ///< solid fraction of grains of one size, by rods with the gap of the packings here
  double poured = 0.0;            ///< solid fraction of the whole with K = 4.1
  double vibrated_pressed = 0.0;  ///< solid fraction of the whole with K = 9
};

void fields(auto&& visit, Of<CompressibleModelSummary> auto& s) {
  visit("solid_fraction_of_one_size", s.one_size);
  visit("solid_fraction_K_4_1", s.poured);
  visit("solid_fraction_K_9", s.vibrated_pressed);
}

/// The whole at a recorded point of its stages.
struct RecipePoint {
  std::string stage;   ///< stage that ends at the point or leads to it
  double axial = 0.0;  ///< axial stress [Pa]
  Estimate strain;     ///< nominal, from the start of the test
  Estimate lateral_ratio;
  Estimate void_ratio;
};

void fields(auto&& visit, Of<RecipePoint> auto& p) {
  visit("stage", p.stage);
  visit("axial_stress", p.axial);
  visit("axial_strain", p.strain);
  visit("K0", p.lateral_ratio);
  visit("void_ratio", p.void_ratio);
}

/// The whole in a stage; moduli in Pa, of logarithmic strain. `measured`: of samples with all its grains.
struct RecipeStageSummary {
  std::string name;
  StageKind kind = StageKind::oedometric;
  double stress_end = 0.0;   ///< axial stress at the end of the stage [Pa]
  double stress_from = 0.0;  ///< interval of secant and index [Pa]: falls in an unloading
  double stress_to = 0.0;
  PredictedValue secant;         ///< constrained modulus over the interval
  PredictedValue tangent_begin;  ///< constrained modulus at the first point: of an unloading the stiffest
  PredictedValue tangent_end;    ///< at the last point
  PredictedValue index;          ///< Cc; of an unloading and a reloading Cs
  PredictedValue lateral_ratio;  ///< K0 at the end
  PredictedValue void_ratio;     ///< at the end

  /// "Cc" or "Cs".
  [[nodiscard]] const char* index_name() const { return kind == StageKind::oedometric ? "Cc" : "Cs"; }
};

void fields(auto&& visit, Of<RecipeStageSummary> auto& s) {
  visit("name", s.name);
  visit("kind", s.kind);
  visit("axial_stress_end", s.stress_end);
  visit("interval_from", s.stress_from);
  visit("interval_to", s.stress_to);
  visit("modulus_secant", s.secant);
  visit("modulus_begin", s.tangent_begin);
  visit("modulus_end", s.tangent_end);
  visit("compression_index", s.index);
  visit("K0_end", s.lateral_ratio);
  visit("void_ratio_end", s.void_ratio);
}

/// The whole under [[stage]]; empty without them. Stresses in Pa.
struct RecipeStages {
  std::vector<RecipeStageSummary> stages;
  std::vector<RecipePoint> points;
};

void fields(auto&& visit, Of<RecipeStages> auto& s) {
  visit("stages", s.stages);
  visit("points", s.points);
}

struct RecipeOutcome {
  std::vector<ConstituentSummary> constituents;
  std::vector<RecipeLevelSummary> levels;
  double span = 1.0;
  double gap = 0.0;             ///< gap of the rods
  double rods_deviation = 0.0;  ///< root mean square of the onsets about them
  std::optional<Estimate> onset;
  std::optional<Estimate> solid_fraction;  ///< solid fraction at the start pressure
  Estimate lateral_ratio;                  ///< K0 at the end of the test, predicted: never that of the check
  double grains_per_cubic_metre = 0.0;
  double resolved_grains = 0.0;       ///< grains of a sample with a hundred grains above a third of the largest radius
  double resolved_evaluations = 0.0;  ///< contact evaluations of that sample, from those of preparation and test here
  std::optional<RecipeCheckSummary> check;
  std::vector<RecipeCurve> curves;
  std::vector<ShellLevelSummary> shells;
  std::optional<CompressibleModelSummary> compressible_model;
  std::optional<RecipeStages> staged;  ///< with [[stage]]
};

void fields(auto&& visit, Of<RecipeOutcome> auto& s) {
  visit("constituents", s.constituents);
  visit("levels", s.levels);
  visit("span", s.span);
  visit("rods_gap", s.gap);
  visit("rods_deviation", s.rods_deviation);
  visit("onset", s.onset, kLeftOut);
  visit("solid_fraction_start", s.solid_fraction, kLeftOut);
  visit("K0", s.lateral_ratio);
  visit("grains_per_cubic_metre", s.grains_per_cubic_metre);
  visit("resolved_grains", s.resolved_grains);
  visit("resolved_contact_evaluations", s.resolved_evaluations);
  visit("check", s.check, kLeftOut);
  visit("curves", s.curves);
  visit("shells", s.shells);
  visit("compressible_packing_model", s.compressible_model, kLeftOut);
  visit("staged", s.staged, kLeftOut);
}

struct RecipeSummary {
  MaterialSummary material;
  CellLawSummary law;
  RecipeOutcome recipe;
};

void fields(auto&& visit, Of<RecipeSummary> auto& s) {
  fields(visit, s.material);
  visit("cell_law", s.law);
  visit("recipe", s.recipe);
}

}  // namespace softgrain
