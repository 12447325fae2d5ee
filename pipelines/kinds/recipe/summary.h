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
  std::optional<double> youngs_modulus{};
  std::optional<double> poisson_ratio{};
  std::optional<double> friction{};
};

void fields(auto&& visit, Of<ConstituentSummary> auto& s) {
  visit("name", s.name, Means{"name of the constituent"});
  visit("mass_share", s.mass_share, Means{"share of the mass", "1"});
  visit("density", s.density, Means{"density of its grains", "kg/m^3"});
  visit("volume_share", s.volume_share, Means{"share of the solid volume", "1"});
  visit("E", s.youngs_modulus, kLeftOut, Means{"Young's modulus of its grains; absent: all grains are alike", "Pa"});
  visit("nu", s.poisson_ratio, kLeftOut, Means{"Poisson's ratio of its grains", "1"});
  visit("mu", s.friction, kLeftOut, Means{"friction of its grains", "1"});
}

/// Estimates by both forms, see LevelForms.
struct OnsetByForms {
  double levels = 0.0;
  double rods = 0.0;
  Estimate onset;  ///< the middle, and an interval that holds both
};

void fields(auto&& visit, Of<OnsetByForms> auto& s) {
  visit("levels", s.levels, Means{"solid fraction phi_J by the form of levels", "1"});
  visit("rods", s.rods, Means{"solid fraction phi_J by the form of rods", "1"});
  fields(visit, s.onset);
}

struct RecipeLevelSummary {
  std::int64_t level = 1;
  double diameter_low = 0.0;  ///< [m]
  double diameter_high = 0.0;
  double share = 0.0;
  double grains = 0.0;
  std::string packing;
  double onset = 0.0;
  OnsetByForms with_finer;
  /// Volume that everything finer takes up where it jams, over the voids of this level alone: above 1 its grains float
  /// in fines, below they bear and the fines have room. None for the finest.
  std::optional<double> filling;
};

void fields(auto&& visit, Of<RecipeLevelSummary> auto& s) {
  visit("level", s.level, Means{"number of the level; 1: the coarsest", "1"});
  visit("diameter_low", s.diameter_low, Means{"smallest diameter", "m"});
  visit("diameter_high", s.diameter_high, Means{"largest diameter", "m"});
  visit("volume_share", s.share, Means{"share of the solid volume of all levels", "1"});
  visit("grains_per_cubic_metre", s.grains, Means{"grains of the level in a cubic metre of the whole", "1/m^3"});
  visit("packing", s.packing, Means{"name of the measured packing"});
  visit("onset", s.onset, Means{"solid fraction phi_J of the level alone", "1"});
  visit("onset_with_finer", s.with_finer, Means{"solid fraction phi_J of the level with everything finer"});
  visit("filling", s.filling, kLeftOut,
        Means{"volume that everything finer takes up where it jams, over the voids of this level alone: above 1 its "
              "grains float in fines",
              "1"});
}

/// The coarsest levels with all their grains.
struct RecipeCheckSummary {
  std::int64_t levels = 0;
  std::int64_t grains = 0;
  double span = 1.0;
  Estimate measured;  ///< phi_J
  OnsetByForms predicted;
  bool weighs = true;
  double share_of_rods = 0.5;
  double outside = 0.0;
  /// K0 as predicted by mixtures of two levels, and of the samples; nothing in results of earlier versions.
  std::optional<PredictedValue> lateral_ratio;
};

void fields(auto&& visit, Of<RecipeCheckSummary> auto& s) {
  visit("levels", s.levels, Means{"number of levels with all their grains", "1"});
  visit("grains", s.grains, Means{"number of grains", "1"});
  visit("span", s.span, Means{"largest over smallest radius", "1"});
  visit("measured", s.measured.value, Means{"measured phi_J", "1"});
  visit("measured_standard_error", s.measured.standard_error, Means{"standard error of it", "1"});
  visit("predicted", s.predicted, Means{"predicted phi_J"});
  visit("weighs_forms", s.weighs, Means{"whether it tells which form does better; else the value is in the middle"});
  visit("share_of_rods", s.share_of_rods, Means{"share of rods in the value of the whole", "1"});
  visit("outside", s.outside, Means{"how far the measured value lies outside the interval", "1"});
  visit("K0", s.lateral_ratio, kLeftOut,
        Means{"lateral over axial stress as predicted by mixtures of two levels, and as measured"});
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
  visit("from", s.from, Means{"lower axial stress over E", "1"});
  visit("to", s.to, Means{"upper axial stress over E", "1"});
  visit("value", s.value, Means{"constrained modulus over E, of logarithmic strain", "1"});
  range_field(visit, "interval", s.low, s.high, Means{"95 % interval; null: not known", "1"});
}

/// Oedometric compression from the start pressure; stresses over E.
struct RecipeCurve {
  std::string name;
  std::vector<double> strain, axial, lateral;
  std::vector<double> low, high;  ///< band of the axial stress; empty: not known
  std::string problem;
  std::optional<SecantModulus> modulus{};
};

void fields(auto&& visit, Of<RecipeCurve> auto& s) {
  visit("name", s.name, Means{"name of the curve"});
  visit("strain", s.strain, Means{"axial strain", "1"});
  visit("axial", s.axial, Means{"axial stress over E", "1"});
  visit("lateral", s.lateral, Means{"lateral stress over E", "1"});
  visit("axial_low", s.low, Means{"lower end of the 95 % band of the axial stress", "1"});
  visit("axial_high", s.high, Means{"upper end of the 95 % band of the axial stress", "1"});
  visit("problem", s.problem, Means{"why the curve ends, or is not there"});
  visit("constrained_modulus", s.modulus, kLeftOut, Means{"constrained modulus between two stresses"});
}

/// A level of the shell hierarchy.
struct ShellLevelSummary {
  std::int64_t level = 0;  ///< 0: the finest
  double diameter_low = 0.0;
  double diameter_high = 0.0;
  double force = 0.0;
  double grains = 0.0;
};

void fields(auto&& visit, Of<ShellLevelSummary> auto& s) {
  visit("level", s.level, Means{"number of the level; 0: the finest", "1"});
  visit("diameter_low", s.diameter_low, Means{"smallest diameter", "m"});
  visit("diameter_high", s.diameter_high, Means{"largest diameter", "m"});
  visit("force_over_E_Rs2", s.force, Means{"force of one plane at h/Rs = 0.2 over E Rs^2", "1"});
  visit("grains", s.grains, Means{"number of grains that one soft particle stands for", "1"});
}

/// The compressible packing model (de Larrard 1999) for the sizes of the whole, which is a model of others: solid
/// fraction with a beta for which grains of one size pack as they do here.
struct CompressibleModelSummary {
  double one_size = 0.0;
  double poured = 0.0;
  double vibrated_pressed = 0.0;
};

void fields(auto&& visit, Of<CompressibleModelSummary> auto& s) {
  visit("solid_fraction_of_one_size", s.one_size, Means{"solid fraction of grains of one size", "1"});
  visit("solid_fraction_K_4_1", s.poured, Means{"solid fraction of the whole, poured (K = 4.1)", "1"});
  visit("solid_fraction_K_9", s.vibrated_pressed,
        Means{"solid fraction of the whole, vibrated and pressed (K = 9)", "1"});
}

/// The whole at a recorded point of its stages.
struct RecipePoint {
  std::string stage;
  double axial = 0.0;
  Estimate strain;
  Estimate lateral_ratio;
  Estimate void_ratio;
};

void fields(auto&& visit, Of<RecipePoint> auto& p) {
  visit("stage", p.stage, Means{"stage that ends at the point or leads to it"});
  visit("axial_stress", p.axial, Means{"axial stress", "Pa"});
  visit("axial_strain", p.strain, Means{"nominal strain from the start of the test", "1"});
  visit("K0", p.lateral_ratio, Means{"lateral over axial stress", "1"});
  visit("void_ratio", p.void_ratio, Means{"void ratio", "1"});
}

/// The whole in a stage; moduli in Pa, of logarithmic strain. `measured`: of samples with all its grains.
struct RecipeStageSummary {
  std::string name;
  StageKind kind = StageKind::oedometric;
  double stress_end = 0.0;
  double stress_from = 0.0;  ///< interval of secant and index [Pa]: falls in an unloading
  double stress_to = 0.0;
  PredictedValue secant;
  PredictedValue tangent_begin;
  PredictedValue tangent_end;
  PredictedValue index;
  PredictedValue lateral_ratio;  ///< K0 at the end
  PredictedValue void_ratio;

  /// "Cc" or "Cs".
  [[nodiscard]] const char* index_name() const { return kind == StageKind::oedometric ? "Cc" : "Cs"; }
};

void fields(auto&& visit, Of<RecipeStageSummary> auto& s) {
  visit("name", s.name, Means{"name of the stage"});
  visit("kind", s.kind, Means{"kind of the stage"});
  visit("axial_stress_end", s.stress_end, Means{"axial stress at the end of the stage", "Pa"});
  visit("interval_from", s.stress_from, Means{"axial stress at which the interval of secant and index begins", "Pa"});
  visit("interval_to", s.stress_to, Means{"axial stress at which it ends", "Pa"});
  visit("modulus_secant", s.secant, Means{"constrained modulus over the interval, of logarithmic strain", "Pa"});
  visit("modulus_begin", s.tangent_begin, Means{"constrained modulus at the first point", "Pa"});
  visit("modulus_end", s.tangent_end, Means{"constrained modulus at the last point", "Pa"});
  visit("compression_index", s.index, Means{"Cc; of an unloading and a reloading Cs", "1"});
  visit("K0_end", s.lateral_ratio, Means{"lateral over axial stress at the end", "1"});
  visit("void_ratio_end", s.void_ratio, Means{"void ratio at the end", "1"});
}

/// The whole under [[stage]]; empty without them. Stresses in Pa.
struct RecipeStages {
  std::vector<RecipeStageSummary> stages;
  std::vector<RecipePoint> points;
};

void fields(auto&& visit, Of<RecipeStages> auto& s) {
  visit("stages", s.stages, Means{"the stages of the test"});
  visit("points", s.points, Means{"its recorded points"});
}

struct RecipeOutcome {
  std::vector<ConstituentSummary> constituents;
  std::vector<RecipeLevelSummary> levels;
  double span = 1.0;
  double gap = 0.0;
  double rods_deviation = 0.0;
  std::optional<Estimate> onset;
  std::optional<Estimate> solid_fraction;
  Estimate lateral_ratio;  ///< K0 at the end of the test, predicted: never that of the check
  double grains_per_cubic_metre = 0.0;
  double resolved_grains = 0.0;
  double resolved_evaluations = 0.0;
  std::optional<RecipeCheckSummary> check;
  std::vector<RecipeCurve> curves;
  std::vector<ShellLevelSummary> shells;
  std::optional<CompressibleModelSummary> compressible_model;
  std::optional<RecipeStages> staged;  ///< with [[stage]]
};

void fields(auto&& visit, Of<RecipeOutcome> auto& s) {
  visit("constituents", s.constituents, Means{"the constituents"});
  visit("levels", s.levels, Means{"levels of sizes, coarsest first"});
  visit("span", s.span, Means{"largest over smallest radius of the whole", "1"});
  visit("rods_gap", s.gap, Means{"gap of the rods", "1"});
  visit("rods_deviation", s.rods_deviation, Means{"root mean square deviation of the onsets from the rods", "1"});
  visit("onset", s.onset, kLeftOut, Means{"solid fraction phi_J of the whole", "1"});
  visit("solid_fraction_start", s.solid_fraction, kLeftOut, Means{"solid fraction at the start pressure", "1"});
  visit("K0", s.lateral_ratio, Means{"predicted lateral over axial stress at the end of the test", "1"});
  visit("grains_per_cubic_metre", s.grains_per_cubic_metre, Means{"grains in a cubic metre of the whole", "1/m^3"});
  visit("resolved_grains", s.resolved_grains,
        Means{"grains of a sample with a hundred grains above a third of the largest radius", "1"});
  visit("resolved_contact_evaluations", s.resolved_evaluations,
        Means{"contact evaluations of that sample, estimated", "1"});
  visit("check", s.check, kLeftOut, Means{"the coarsest levels with all their grains"});
  visit("curves", s.curves, Means{"oedometric compression from the start pressure"});
  visit("shells", s.shells, Means{"levels of the shell hierarchy"});
  visit("compressible_packing_model", s.compressible_model, kLeftOut,
        Means{"the compressible packing model for the same sizes"});
  visit("staged", s.staged, kLeftOut, Means{"the whole under the stages of the scene"});
}

struct RecipeSummary {
  MaterialSummary material;
  CellLawSummary law;
  RecipeOutcome recipe;
};

void fields(auto&& visit, Of<RecipeSummary> auto& s) {
  fields(visit, s.material);
  visit("cell_law", s.law, Means{"the law of cells"});
  visit("recipe", s.recipe, Means{"the whole, predicted"});
}

}  // namespace softgrain
