// What a material came to: summary.json of its run, which the report reads back.
#pragma once

#include "pipelines/kinds/material/equation.h"
#include "pipelines/kinds/material/prediction.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// Results of the samples of one variant.
struct MaterialVariantSummary {
  std::string name;
  std::string file;  ///< file of its curves
  std::int64_t grains = 0;
  double youngs_modulus = 0.0;  ///< Young's modulus of its grains [Pa]; 0: as the summary says
  double size_ratio = 0.0;      ///< largest over smallest radius
  Preparation preparation = Preparation::frictionless;
  double friction = 0.0;
  std::optional<double> rolling_friction;  ///< mu_r; empty: grains roll freely
  std::optional<MeanError> solid_fraction_start;
  std::optional<MeanError> rattlers_start;
  std::optional<MeanError> coordination_start;
  EngineSummary runs;
};

void fields(auto&& visit, Of<MaterialVariantSummary> auto& s) {
  visit("name", s.name);
  visit("file", s.file);
  visit("grains", s.grains);
  visit("E", s.youngs_modulus);
  visit("size_ratio", s.size_ratio);
  visit("preparation", s.preparation);
  visit("mu", s.friction);
  visit("mu_r", s.rolling_friction, kLeftOut);
  visit("solid_fraction_start", s.solid_fraction_start, kLeftOut);
  visit("rattlers_start", s.rattlers_start, kLeftOut);
  visit("coordination_start", s.coordination_start, kLeftOut);
  fields(visit, s.runs);
}

struct MaterialSummary {
  SummaryHead head;
  std::optional<double> youngs_modulus;  ///< E of the grains of all variants [Pa]; empty: they differ
  std::vector<MaterialVariantSummary> variants;
  std::optional<EquationSummary> equation;
  std::vector<PredictionSummary> predictions;
  std::optional<EngineUse> engine;
};

void fields(auto&& visit, Of<MaterialSummary> auto& s) {
  fields(visit, s.head);
  visit("E", s.youngs_modulus, kLeftOut);
  visit("variants", s.variants);
  visit("equation_of_state", s.equation, kLeftOut);
  visit("predictions", s.predictions, kLeftOut);
  visit("engine", s.engine, kLeftOut);
}

/// E of the grains of a variant [Pa].
inline double modulus_of(const MaterialSummary& s, const MaterialVariantSummary& v) {
  return v.youngs_modulus > 0.0 ? v.youngs_modulus : s.youngs_modulus.value_or(0.0);
}

}  // namespace softgrain
