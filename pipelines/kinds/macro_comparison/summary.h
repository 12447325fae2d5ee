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
  visit("stress_error", known(e.axial), Means{"relative L2 difference of the axial stress, per sample", "1"});
  visit("stress_error_of_mean", known(e.axial_of_mean),
        Means{"relative L2 difference of the mean curves over the samples", "1"});
  visit("end_stress_ratio", known(e.axial_end), Means{"axial stress over that of the twin at the end", "1"});
  visit("deviator_error", known(e.deviator),
        Means{"relative L2 difference of axial minus x stress after the preload", "1"});
  visit("strain_error", known(e.strains),
        Means{"relative L2 difference of the strains of axes that go by stress", "1"});
  visit("unloading_modulus_ratio", known(e.unloading), Means{"unloading modulus over that of the twin", "1"});
  visit("lateral_ratio_difference", known(e.lateral_ratio),
        Means{"lateral over axial stress at the end, minus that of the twin", "1"});
  visit("coordination_difference", known(e.coordination),
        Means{"coordination number of bodies at the end, minus that of the twin", "1"});
  visit("fabric_difference", known(e.fabric),
        Means{"fabric anisotropy of bodies at the end, minus that of the twin", "1"});
  visit("force_mean_ratio", known(e.force_mean), Means{"mean contact force over that of the twin", "1"});
  visit("force_distance", known(e.force_distance),
        Means{"Kolmogorov-Smirnov distance of the forces, each over its mean", "1"});
  visit("speedup_seconds", e.speedup_seconds, Means{"core seconds of the twin over those of the engine", "1"});
  visit("speedup_contact_evaluations", e.speedup_evaluations,
        Means{"contact evaluations of the twin over those of the engine", "1"});
}

inline std::optional<PlacesScore> known(const PlacesScore& p) {
  return p.solid.n > 0 ? std::optional(p) : std::nullopt;
}

void fields(auto&& visit, const PlacesScore& p) {
  visit("solid", known(p.solid), Means{"forces from solid grains over those of the twin", "1"});
  visit("wall", known(p.wall), Means{"forces from walls over those of the twin", "1"});
  visit("soft", known(p.soft), Means{"forces from soft particles over those of the twin", "1"});
}

void fields(auto&& visit, const EngineScore& s) {
  visit("engine", s.engine, Means{"name of the engine"});
  visit("samples", s.samples, Means{"number of usable samples", "1"});
  visit("axial_stress", known(s.axial), Means{"axial stress at the end", "Pa"});
  visit("lateral_ratio", known(s.lateral_ratio), Means{"lateral over axial stress at the end", "1"});
  visit("coordination", known(s.coordination), Means{"coordination number of bodies at the end", "1"});
  visit("fabric", known(s.fabric), Means{"fabric anisotropy of bodies at the end", "1"});
  visit("force_mean", known(s.force_mean), Means{"mean force of contacts between bodies at the end", "N"});
  visit("force_variation", known(s.force_variation), Means{"standard deviation of these forces over their mean", "1"});
  visit("contact_evaluations", s.contact_evaluations, Means{"contact evaluations per sample", "1"});
  visit("seconds", s.seconds, Means{"core seconds per sample", "s"});
  visit("noise", known(s.noise),
        Means{"relative difference of the axial stress that paths alone make of one run", "1"});
  visit("band_width", known(s.band_width), Means{"half of the 95 % band over the axial stress at the end", "1"});
  visit("coverage", known(s.coverage), Means{"share of the points of the shelled twin in the band", "1"});
  visit("coverage_at_end", known(s.coverage_end), Means{"share of the samples whose last point is in the band", "1"});
  visit("forces_at_twin_places", known(s.places),
        Means{"forces by law at the places of the twin, over those of the twin"});
  visit("against_shelled", known(s.shelled), Means{"against the shelled twin"});
  visit("against_free", known(s.free), Means{"against the twin without shells"});
}

/// What a sample of a scene is made of.
void fields(auto&& visit, Of<SceneFacts> auto& f) {
  visit("solid", f.solid, Means{"number of solid grains", "1"});
  visit("soft", f.soft, Means{"number of soft particles", "1"});
  visit("inner_grains", f.inner_grains, Means{"number of grains inside soft particles", "1"});
  visit("soft_share", f.soft_share, Means{"share of soft particles, by their shell, in the volume of all bodies", "1"});
  visit("body_fraction", f.body_fraction, Means{"volume of the bodies over that of the box", "1"});
  visit("solid_fraction", f.solid_fraction,
        Means{"volume of the grains over that of the box: a soft particle counts by its content", "1"});
  std::array radii{f.soft_radius_low, f.soft_radius_mean, f.soft_radius_high};
  visit("soft_radius", radii, Means{"smallest, mean and largest radius of the soft particles", "m"});
  visit("exponent", f.exponent.exponent,
        Means{"power-law exponent of the radii of all grains, by maximum likelihood", "1"});
  visit("exponent_error", f.exponent.standard_error, Means{"standard error of the exponent", "1"});
  visit("polydispersity", f.largest_over_smallest, Means{"largest over smallest of these radii", "1"});
}

struct ComparedScene {
  std::string name;
  std::vector<LawIdentity> laws;
  MacroTest test = MacroTest::oedometric;
  Construction construction{};
  double soft_share = 0.0;
  std::string file;
  std::vector<SceneFacts> samples;
  std::vector<EngineScore> engines;
  std::vector<BandRecord> bands{};
};

void fields(auto&& visit, Of<ComparedScene> auto& s) {
  visit("name", s.name, Means{"name of the scene"});
  visit("laws", s.laws, Means{"laws that were run"});
  visit("test", s.test, Means{"test"});
  visit("construction", s.construction, Means{"how the packing was made"});
  visit("soft_share", s.soft_share, Means{"share of soft particles in the volume of the bodies, as asked for", "1"});
  visit("file", s.file, Means{"file of its curves"});
  visit("samples", s.samples, Means{"what each sample is made of"});
  visit("engines", s.engines, Means{"results of each engine"});
  visit("bands", s.bands, Means{"bands of the laws that have error bars"});
}

/// comparison.json.
struct ComparedScenes {
  std::vector<ComparedScene> scenes;
};

void fields(auto&& visit, Of<ComparedScenes> auto& s) { visit("scenes", s.scenes, Means{"the scenes"}); }

struct MacroComparisonSummary {
  SummaryHead head;
  ComparedScenes compared;
};

void fields(auto&& visit, Of<MacroComparisonSummary> auto& s) {
  fields(visit, s.head);
  fields(visit, s.compared);
}

}  // namespace softgrain
