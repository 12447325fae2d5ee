// What a fit to measurements of an experiment came to: summary.json of its run, which the report reads back.
#pragma once

#include "pipelines/law/law_json.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// The points of one sample that the report draws; `points` says how many were measured.
struct DrawnSample {
  PairKind kind = PairKind::soft_solid;
  std::string name;
  std::vector<double> delta;
  std::vector<double> force;  ///< [N]
  std::vector<double> error;  ///< errors of the force; NaN: not known; empty: none was given
  std::optional<std::size_t> points;
  std::size_t tangential_points = 0;
};

void fields(auto&& visit, Of<DrawnSample> auto& s) {
  visit("kind", s.kind);
  visit("name", s.name);
  visit("delta", s.delta);
  visit("force", s.force);
  visit("error", s.error, kLeftOut);
  visit("points", s.points);
  visit("tangential_points", s.tangential_points);
}

struct ExperimentSummary {
  SummaryHead head;
  std::vector<std::string> inputs;
  std::string relaxation;
  std::string intervals;  ///< origin of the 95 % intervals
  std::map<std::string, PairLawSummary> laws;
  std::vector<DrawnSample> experiment;
};

void fields(auto&& visit, Of<ExperimentSummary> auto& s) {
  fields(visit, s.head);
  visit("inputs", s.inputs);
  visit("relaxation", s.relaxation);
  visit("intervals", s.intervals);
  visit("laws", s.laws);
  visit("experiment", s.experiment);
}

}  // namespace softgrain
