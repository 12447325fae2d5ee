// What a material came to: summary.json of its run, which the report reads back.
#pragma once

#include "pipelines/kinds/material/equation.h"
#include "pipelines/kinds/material/prediction.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// Results of the samples of one variant.
struct MaterialVariantSummary {
  std::string name;
  std::string file;
  std::int64_t grains = 0;
  double youngs_modulus = 0.0;
  double size_ratio = 0.0;
  Preparation preparation = Preparation::frictionless;
  double friction = 0.0;
  std::optional<double> rolling_friction;
  std::optional<MeanError> solid_fraction_start;
  std::optional<MeanError> rattlers_start;
  std::optional<MeanError> coordination_start;
  EngineSummary runs;
};

void fields(auto&& visit, Of<MaterialVariantSummary> auto& s) {
  visit("name", s.name, Means{"name of the variant"});
  visit("file", s.file, Means{"file of its curves"});
  visit("grains", s.grains, Means{"number of grains of a sample", "1"});
  visit("E", s.youngs_modulus, Means{"Young's modulus of its grains; 0: as the summary says", "Pa"});
  visit("size_ratio", s.size_ratio, Means{"largest over smallest radius", "1"});
  visit("preparation", s.preparation, Means{"how samples were prepared"});
  visit("mu", s.friction, Means{"friction between grains", "1"});
  visit("mu_r", s.rolling_friction, kLeftOut, Means{"rolling friction; absent: grains roll freely", "1"});
  visit("solid_fraction_start", s.solid_fraction_start, kLeftOut, Means{"solid fraction at the start", "1"});
  visit("rattlers_start", s.rattlers_start, kLeftOut, Means{"share of rattlers at the start", "1"});
  visit("coordination_start", s.coordination_start, kLeftOut, Means{"coordination number at the start", "1"});
  fields(visit, s.runs);
}

struct MaterialSummary {
  SummaryHead head;
  std::optional<double> youngs_modulus;
  std::vector<MaterialVariantSummary> variants;
  std::optional<EquationSummary> equation;
  std::vector<PredictionSummary> predictions;
  std::optional<EngineUse> engine;
};

void fields(auto&& visit, Of<MaterialSummary> auto& s) {
  fields(visit, s.head);
  visit("E", s.youngs_modulus, kLeftOut,
        Means{"Young's modulus of the grains of all variants; absent: they differ", "Pa"});
  visit("variants", s.variants, Means{"the variants"});
  visit("equation_of_state", s.equation, kLeftOut, Means{"pressure over solid fraction"});
  visit("predictions", s.predictions, kLeftOut, Means{"responses at spans that nobody resolves"});
  visit("engine", s.engine, kLeftOut, Means{"program that moved the bodies, when it was another"});
}

/// E of the grains of a variant [Pa].
inline double modulus_of(const MaterialSummary& s, const MaterialVariantSummary& v) {
  return v.youngs_modulus > 0.0 ? v.youngs_modulus : s.youngs_modulus.value_or(0.0);
}

}  // namespace softgrain
