// What laws and twins came to on several macro scenes: comparison.json and summary.json, which the report reads back.
#pragma once

#include "macrosim/constructed_packing.h"
#include "macrosim/macro_spec.h"
#include "pipelines/compare/macro_scores.h"
#include "pipelines/kinds/macro/summary.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// Null where there is no value.
inline std::optional<MeanError> known(const MeanError& m) { return m.n > 0 ? std::optional(m) : std::nullopt; }
inline std::optional<TwinErrors> known(const TwinErrors& e) { return e.pairs > 0 ? std::optional(e) : std::nullopt; }

void fields(auto&& visit, const TwinErrors& e) {
  visit("stress_error", known(e.axial));
  visit("stress_error_of_mean", known(e.axial_of_mean));
  visit("end_stress_ratio", known(e.axial_end));
  visit("deviator_error", known(e.deviator));
  visit("strain_error", known(e.strains));
  visit("unloading_modulus_ratio", known(e.unloading));
  visit("lateral_ratio_difference", known(e.lateral_ratio));
  visit("coordination_difference", known(e.coordination));
  visit("fabric_difference", known(e.fabric));
  visit("force_mean_ratio", known(e.force_mean));
  visit("force_distance", known(e.force_distance));
  visit("speedup_seconds", e.speedup_seconds);
  visit("speedup_contact_evaluations", e.speedup_evaluations);
}

inline std::optional<PlacesScore> known(const PlacesScore& p) {
  return p.solid.n > 0 ? std::optional(p) : std::nullopt;
}

void fields(auto&& visit, const PlacesScore& p) {
  visit("solid", known(p.solid));
  visit("wall", known(p.wall));
  visit("soft", known(p.soft));
}

void fields(auto&& visit, const EngineScore& s) {
  visit("engine", s.engine);
  visit("samples", s.samples);
  visit("axial_stress", known(s.axial));
  visit("lateral_ratio", known(s.lateral_ratio));
  visit("coordination", known(s.coordination));
  visit("fabric", known(s.fabric));
  visit("force_mean", known(s.force_mean));
  visit("force_variation", known(s.force_variation));
  visit("contact_evaluations", s.contact_evaluations);
  visit("seconds", s.seconds);
  visit("noise", known(s.noise));
  visit("band_width", known(s.band_width));
  visit("coverage", known(s.coverage));
  visit("coverage_at_end", known(s.coverage_end));
  visit("forces_at_twin_places", known(s.places));
  visit("against_shelled", known(s.shelled));
  visit("against_free", known(s.free));
}

/// What a sample of a scene is made of.
void fields(auto&& visit, Of<SceneFacts> auto& f) {
  visit("solid", f.solid);
  visit("soft", f.soft);
  visit("inner_grains", f.inner_grains);
  visit("soft_share", f.soft_share);
  visit("body_fraction", f.body_fraction);
  visit("solid_fraction", f.solid_fraction);
  std::array radii{f.soft_radius_low, f.soft_radius_mean, f.soft_radius_high};
  visit("soft_radius", radii);
  visit("exponent", f.exponent.exponent);
  visit("exponent_error", f.exponent.standard_error);
  visit("polydispersity", f.largest_over_smallest);
}

struct ComparedScene {
  std::string name;
  std::vector<LawIdentity> laws;
  MacroTest test = MacroTest::oedometric;
  Construction construction{};
  double soft_share = 0.0;
  std::string file;  ///< file of its curves
  std::vector<SceneFacts> samples;
  std::vector<EngineScore> engines;
  std::vector<BandRecord> bands{};
};

void fields(auto&& visit, Of<ComparedScene> auto& s) {
  visit("name", s.name);
  visit("laws", s.laws);
  visit("test", s.test);
  visit("construction", s.construction);
  visit("soft_share", s.soft_share);
  visit("file", s.file);
  visit("samples", s.samples);
  visit("engines", s.engines);
  visit("bands", s.bands);
}

/// comparison.json.
struct ComparedScenes {
  std::vector<ComparedScene> scenes;
};

void fields(auto&& visit, Of<ComparedScenes> auto& s) { visit("scenes", s.scenes); }

struct MacroComparisonSummary {
  SummaryHead head;
  ComparedScenes compared;
};

void fields(auto&& visit, Of<MacroComparisonSummary> auto& s) {
  fields(visit, s.head);
  fields(visit, s.compared);
}

}  // namespace softgrain
