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
  std::int64_t level = 0;      ///< 0: grains only
  double grain_percent = 0.0;  ///< volume of its own grains over that of the shell [%]
  double solid_percent = 0.0;  ///< volume of all grains, those in soft particles included, over that of the shell [%]
  std::optional<InnerSummary> inner;
  LevelLaw law;
  double resolved_grains = 0.0;
  Cost cost;  ///< its seconds are those of the wall
  LevelCurves curves;
  std::optional<double> distance_percent;   ///< distance to the law of the level below
  std::optional<double> noise_percent;      ///< what packings alone make of it
  std::optional<double> error_percent;      ///< standard error of its forces, that of the levels below in it
  std::optional<double> own_error_percent;  ///< standard error from its own packings alone
  std::optional<Sensitivity> sensitivity;   ///< sensitivity to the law below
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
  visit("mean", s.mean);
  visit("radius_low", s.radius_low);
  visit("radius_high", s.radius_high);
  visit("volume_percent", s.volume_percent);
  visit("next_volume", s.next_volume);
}

void fields(auto&& visit, Of<LevelLaw> auto& s) {
  visit("status", s.status);
  visit("error_cross", s.error_cross);
  for (std::size_t k = 0; k < s.parameters.size(); ++k) visit(kMultiContactParameters[k].key, s.parameters[k]);
}

void fields(auto&& visit, Of<LevelCurves> auto& s) {
  visit("overlap", s.overlap);
  visit("one", s.one);
  visit("cube", s.cube);
}

void fields(auto&& visit, Of<LevelChange> auto& c) {
  visit("configuration", c.configuration);
  visit("ratio", c.ratio);
  visit("error", c.error);
}

void fields(auto&& visit, Of<Sensitivity> auto& s) {
  visit("value", s.value);
  visit("error", s.error);
}

void fields(auto&& visit, Of<LevelSummary> auto& s) {
  visit("level", s.level);
  visit("grain_percent", s.grain_percent);
  visit("solid_percent", s.solid_percent);
  visit("inner", s.inner, kLeftOut);
  visit("law", s.law);
  visit("resolved_grains", s.resolved_grains);
  fields(visit, s.cost);
  visit("curves", s.curves);
  visit("distance_percent", s.distance_percent, kLeftOut);
  visit("noise_percent", s.noise_percent, kLeftOut);
  visit("error_percent", s.error_percent, kLeftOut);
  visit("own_error_percent", s.own_error_percent, kLeftOut);
  visit("sensitivity", s.sensitivity, kLeftOut);
  visit("changes", s.changes, kLeftOut);
}

void fields(auto&& visit, Of<FixedPoint> auto& s) {
  visit("reached", s.reached);
  visit("text", s.text);
  visit("level", s.level, kLeftOut);
}

void fields(auto&& visit, Of<FourDecades> auto& s) {
  visit("levels", s.levels);
  visit("radius_span", s.radius_span);
  visit("resolved_grains", s.resolved_grains);
  visit("resolved_contact_evaluations", s.resolved_contact_evaluations);
  visit("contact_evaluations", s.contact_evaluations);
}

void fields(auto&& visit, Of<CheckPoint> auto& p) {
  visit("overlap", p.overlap);
  visit("law", p.law);
  visit("law_error", p.law_error);
  visit("resolved", p.resolved);
  visit("resolved_error", p.resolved_error);
  visit("ratio", p.ratio);
  visit("ratio_error", p.ratio_error);
}

void fields(auto&& visit, Of<CheckSummary> auto& s) {
  auto& r = s.result;
  visit("packings", r.packings);
  visit("inner", r.inner);
  visit("grains", r.grains);
  visit("law_contact_evaluations", r.law_cost.contact_evaluations);
  visit("resolved_contact_evaluations", r.resolved_cost.contact_evaluations);
  visit("law_seconds", r.law_cost.seconds);
  visit("resolved_seconds", r.resolved_cost.seconds);
  visit("converged", r.converged);
  visit("points", r.points);
  visit("text", s.text);
}

void fields(auto&& visit, Of<HierarchySummary> auto& s) {
  fields(visit, s.head);
  visit("levels", s.levels);
  visit("four_decades", s.four_decades);
  visit("fixed_point", s.fixed_point);
  visit("check", s.check, kLeftOut);
}

namespace report {
struct RunData;
std::string hierarchy_section(const RunData& run);  ///< soft particles in soft particles, level by level
}  // namespace report

}  // namespace softgrain
