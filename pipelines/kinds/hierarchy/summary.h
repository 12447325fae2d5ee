// What a hierarchy came to: summary.json of its run, which the report reads back.
#pragma once

#include "common/data/fields.h"
#include "pipelines/kinds/hierarchy/level.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// Soft particles inside one of the level: their mean number, radii over Rs, share of the volume; volume of the grains
/// of the next level in them over that of the level's own.
struct InnerSummary {
  double mean = 0.0;
  double radius_low = 0.0;
  double radius_high = 0.0;
  double volume_percent = 0.0;
  double next_volume = 0.0;
};

struct LevelLaw {
  LawStatus status = LawStatus::good;
  double error_cross = 0.0;
  std::array<double, kMultiContactParameters.size()> parameters{};  ///< values in the order of kMultiContactParameters
};

/// Forces per plane of one plane and of six over the overlap [E Rs^2].
struct LevelCurves {
  std::vector<double> overlap;
  std::vector<double> one;
  std::vector<double> cube;
};

struct LevelSummary {
  std::int64_t level = 0;  ///< 0: grains only
  double grain_percent = 0.0;
  double solid_percent = 0.0;
  std::optional<InnerSummary> inner;
  LevelLaw law;
  double resolved_grains = 0.0;
  Cost cost;  ///< its seconds are those of the wall
  LevelCurves curves;
  std::optional<double> distance_percent;
  std::optional<double> noise_percent;
  std::optional<double> error_percent;
  std::optional<double> own_error_percent;
  std::optional<Sensitivity> sensitivity;
  std::vector<LevelChange> changes;
};

struct FixedPoint {
  bool reached = false;
  std::string text;
  std::optional<std::int64_t> level;
};

struct FourDecades {
  std::int64_t levels = 0;
  double radius_span = 0.0;
  double resolved_grains = 0.0;
  double resolved_contact_evaluations = 0.0;
  double contact_evaluations = 0.0;
};

/// The resolved check, and what it says in words.
struct CheckSummary {
  CheckResult result;
  std::string text;
};

struct HierarchySummary {
  SummaryHead head;
  std::vector<LevelSummary> levels;
  FourDecades four_decades;
  std::optional<FixedPoint> fixed_point;
  std::optional<CheckSummary> check;
};

void fields(auto&& visit, Of<InnerSummary> auto& s) {
  visit("mean", s.mean, Means{"mean number of soft particles inside one of the level", "1"});
  visit("radius_low", s.radius_low, Means{"smallest radius of these over Rs", "1"});
  visit("radius_high", s.radius_high, Means{"largest radius of these over Rs", "1"});
  visit("volume_percent", s.volume_percent, Means{"their share of the volume of the shell", "%"});
  visit("next_volume", s.next_volume,
        Means{"volume of the grains of the level below in them over that of the level's own grains", "1"});
}

void fields(auto&& visit, Of<LevelLaw> auto& s) {
  visit("status", s.status, Means{"whether the law is usable"});
  visit("error_cross", s.error_cross, Means{"relative error of forces in cross-validation", "1"});
  for (std::size_t k = 0; k < s.parameters.size(); ++k)
    visit(kMultiContactParameters[k].key, s.parameters[k], Means{"number of the law, see law tables", "1"});
}

void fields(auto&& visit, Of<LevelCurves> auto& s) {
  visit("overlap", s.overlap, Means{"overlap h/Rs", "1"});
  visit("one", s.one, Means{"force of one plane", "E Rs^2"});
  visit("cube", s.cube, Means{"force per plane of six planes", "E Rs^2"});
}

void fields(auto&& visit, Of<LevelChange> auto& c) {
  visit("configuration", c.configuration, Means{"configuration of neighbours"});
  visit("ratio", c.ratio, Means{"force of the level over that of the level below", "1"});
  visit("error", c.error, Means{"standard error over packings, of the paired ratio of means", "1"});
}

void fields(auto&& visit, Of<Sensitivity> auto& s) {
  visit("value", s.value, Means{"relative change of the forces of a level over that of the law below", "1"});
  visit("error", s.error, Means{"its standard error", "1"});
}

void fields(auto&& visit, Of<LevelSummary> auto& s) {
  visit("level", s.level, Means{"number of the level; 0: grains only", "1"});
  visit("grain_percent", s.grain_percent, Means{"volume of its own grains over that of the shell", "%"});
  visit("solid_percent", s.solid_percent,
        Means{"volume of all grains, those in soft particles included, over that of the shell", "%"});
  visit("inner", s.inner, kLeftOut, Means{"the soft particles inside; none at level 0"});
  visit("law", s.law, Means{"the fitted law"});
  visit("resolved_grains", s.resolved_grains, Means{"grains that one soft particle of the level stands for", "1"});
  fields(visit, s.cost);
  visit("curves", s.curves, Means{"forces by the law"});
  visit("distance_percent", s.distance_percent, kLeftOut, Means{"distance to the law of the level below", "%"});
  visit("noise_percent", s.noise_percent, kLeftOut, Means{"what packings alone make of that distance", "%"});
  visit("error_percent", s.error_percent, kLeftOut,
        Means{"standard error of the forces, that of the levels below included", "%"});
  visit("own_error_percent", s.own_error_percent, kLeftOut,
        Means{"standard error of the forces from its own packings alone", "%"});
  visit("sensitivity", s.sensitivity, kLeftOut, Means{"sensitivity to the law below"});
  visit("changes", s.changes, kLeftOut, Means{"forces against those of the level below"});
}

void fields(auto&& visit, Of<FixedPoint> auto& s) {
  visit("reached", s.reached, Means{"whether the law stopped changing"});
  visit("text", s.text, Means{"what is to be said of it"});
  visit("level", s.level, kLeftOut, Means{"level from which the law no longer changes", "1"});
}

void fields(auto&& visit, Of<FourDecades> auto& s) {
  visit("levels", s.levels, Means{"number of levels", "1"});
  visit("radius_span", s.radius_span, Means{"largest over smallest radius of all grains", "1"});
  visit("resolved_grains", s.resolved_grains,
        Means{"grains that one soft particle of the coarsest level stands for", "1"});
  visit("resolved_contact_evaluations", s.resolved_contact_evaluations,
        Means{"estimated contact evaluations with all these grains", "1"});
  visit("contact_evaluations", s.contact_evaluations, Means{"contact evaluations that the levels took", "1"});
}

void fields(auto&& visit, Of<CheckPoint> auto& p) {
  visit("overlap", p.overlap, Means{"overlap h/Rs", "1"});
  visit("law", p.law, Means{"force by law", "E Rs^2"});
  visit("law_error", p.law_error, Means{"its standard error", "E Rs^2"});
  visit("resolved", p.resolved, Means{"force with all grains", "E Rs^2"});
  visit("resolved_error", p.resolved_error, Means{"its standard error", "E Rs^2"});
  visit("ratio", p.ratio, Means{"force by law over the resolved one", "1"});
  visit("ratio_error", p.ratio_error, Means{"standard error of the paired ratio of means", "1"});
}

void fields(auto&& visit, Of<CheckSummary> auto& s) {
  auto& r = s.result;
  visit("packings", r.packings, Means{"number of packings", "1"});
  visit("inner", r.inner, Means{"mean number of soft particles inside", "1"});
  visit("grains", r.grains, Means{"mean number of grains of a resolved run", "1"});
  visit("law_contact_evaluations", r.law_cost.contact_evaluations, Means{"contact evaluations by law", "1"});
  visit("resolved_contact_evaluations", r.resolved_cost.contact_evaluations,
        Means{"contact evaluations with all grains", "1"});
  visit("law_seconds", r.law_cost.seconds, Means{"core seconds by law", "s"});
  visit("resolved_seconds", r.resolved_cost.seconds, Means{"core seconds with all grains", "s"});
  visit("converged", r.converged, Means{"whether all states converged"});
  visit("points", r.points, Means{"forces at the overlaps"});
  visit("text", s.text, Means{"what is to be said of it"});
}

void fields(auto&& visit, Of<HierarchySummary> auto& s) {
  fields(visit, s.head);
  visit("levels", s.levels, Means{"the levels, finest first"});
  visit("four_decades", s.four_decades, Means{"the hierarchy as a whole"});
  visit("fixed_point", s.fixed_point, Means{"whether the law stops changing from level to level"});
  visit("check", s.check, kLeftOut, Means{"two levels with all their grains"});
}

namespace report {
struct RunData;
std::string hierarchy_section(const RunData& run);  ///< soft particles in soft particles, level by level
}  // namespace report

}  // namespace softgrain
