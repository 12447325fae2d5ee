// The fit of a law: its settings, the fitted law as `softgrain calibrate` prints it, and what a fit to measurements of
// an experiment came to.
#pragma once

#include <string>

#include "calibrate/threshold_fit.h"
#include "common/io/scene.h"
#include "pipelines/law/law_json.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// Settings of a fit: table [calibrate] of a pipeline, and those of softgrain calibrate, for measurements of the
/// program and of an experiment alike. The caller finishes the table.
FitOptions read_fit_settings(const SceneTable& table);

// A fitted normal law as `softgrain calibrate` prints it.

/// Not measured: it follows from the law of the other kind of pair.
bool is_by_symmetry(const PairLaw& law);

/// "soft-solid: good", with the reason where it is not.
std::string verdict_text(const PairLaw& law);

/// "F = a D^b + c: a = 103 N [98.2, 107], ..." in newtons for the soft particle that was measured, and the force at the
/// end of the range. Intervals that are not known, and a threshold that does not show, are said to be so. Two lines.
std::string normal_law_text(const FitReport& report, const SoftParticleSpec& spec);

// What a fit to measurements of an experiment came to: summary.json of its run, which the report reads back.

/// The points of one sample that the report draws; `points` says how many were measured.
struct DrawnSample {
  PairKind kind = PairKind::soft_solid;
  std::string name;
  std::vector<double> delta;
  std::vector<double> force;  ///< [N]
  std::vector<double> error;
  std::optional<std::size_t> points;
  std::size_t tangential_points = 0;
};

void fields(auto&& visit, Of<DrawnSample> auto& s) {
  visit("kind", s.kind, Means{"kind of contact"});
  visit("name", s.name, Means{"name of the sample"});
  visit("delta", s.delta, Means{"overlap Delta = hn/Rs", "1"});
  visit("force", s.force, Means{"force", "N"});
  visit("error", s.error, kLeftOut, Means{"standard error of the force; null: not known", "N"});
  visit("points", s.points, Means{"number of points that were measured", "1"});
  visit("tangential_points", s.tangential_points, Means{"number of tangential points", "1"});
}

struct ExperimentSummary {
  SummaryHead head;
  std::vector<std::string> inputs;
  std::string relaxation;
  std::string intervals;
  std::map<std::string, PairLawSummary> laws;
  std::vector<DrawnSample> experiment;
};

void fields(auto&& visit, Of<ExperimentSummary> auto& s) {
  fields(visit, s.head);
  visit("inputs", s.inputs, Means{"files of the measurements"});
  visit("relaxation", s.relaxation, Means{"name of the relaxation, or \"experiment\""});
  visit("intervals", s.intervals, Means{"origin of the 95 % intervals"});
  visit("laws", s.laws, Means{"fitted laws, by kind of contact"});
  visit("experiment", s.experiment, Means{"the measured points"});
}

}  // namespace softgrain
