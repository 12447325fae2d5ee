// What a reverse search came to: summary.json of its run, which the report reads back.
#pragma once

#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/data/fields.h"
#include "pipelines/kinds/inverse/scene.h"
#include "pipelines/results/summary.h"

namespace softgrain {

struct FoundParameter {
  std::string name;
  double value = 0.0;
  std::array<double, 2> interval{};  ///< 95 %
  double standard_error = 0.0;       ///< standard error from the curvature of the surface
  bool closed = false;               ///< the interval ends within the range
  std::array<double, 2> range{};
  bool logarithmic = false;
};

/// One point of the search; misfit NaN where it gave no whole curve.
struct EvaluationSummary {
  std::vector<double> values;
  double misfit = 0.0;
  std::vector<double> force;  ///< mean at each Delta [N]
};

struct SurfaceSummary {
  std::vector<double> force;
  double misfit = 0.0;
  double lack_of_fit = 0.0;
};

/// The answer, measured with packings that the search has not seen.
struct ConfirmedCurve {
  std::vector<double> force;
  std::vector<double> error;
  std::size_t packings = 0;
  double misfit = 0.0;
  std::vector<std::int64_t> counts{};  ///< packings with a force at each Delta; empty: as in earlier runs, all

  /// 95 % interval of the mean at Delta number j; NaN: of one packing nothing is known.
  [[nodiscard]] std::pair<double, double> interval(std::size_t j) const {
    const auto n = j < counts.size() ? counts[j] : static_cast<std::int64_t>(packings);
    if (n < 2) return {kNaN, kNaN};
    return student_interval(force[j], error[j], static_cast<double>(n - 1));
  }
};

struct SearchSummary {
  PairKind contact = PairKind::soft_solid;
  std::vector<FoundParameter> parameters;
  std::vector<double> correlation;  ///< parameters x parameters
  InverseTarget target;
  SurfaceSummary surface;
  ConfirmedCurve confirmed;
  std::int64_t packings = 0;  ///< packings of each evaluation
  int replicates = 0;
  std::vector<EvaluationSummary> evaluations;
  Cost cost;  ///< its seconds are those of cores
};

struct InverseSummary {
  SummaryHead head;
  std::optional<SearchSummary> inverse;
  PackingsSummary packings;
};

void fields(auto&& visit, Of<FoundParameter> auto& s) {
  visit("name", s.name);
  visit("value", s.value);
  visit("interval", s.interval);
  visit("standard_error", s.standard_error);
  visit("closed", s.closed);
  visit("range", s.range);
  visit("logarithmic", s.logarithmic);
}

void fields(auto&& visit, Of<EvaluationSummary> auto& s) {
  visit("values", s.values);
  visit("misfit", s.misfit);
  visit("force", s.force);
}

void fields(auto&& visit, Of<InverseTarget> auto& s) {
  visit("delta", s.delta);
  visit("force", s.force);
  visit("error", s.error);
}

void fields(auto&& visit, Of<SurfaceSummary> auto& s) {
  visit("force", s.force);
  visit("misfit", s.misfit);
  visit("lack_of_fit", s.lack_of_fit);
}

void fields(auto&& visit, Of<ConfirmedCurve> auto& s) {
  visit("force", s.force);
  visit("error", s.error);
  visit("packings", s.packings);
  visit("misfit", s.misfit);
  visit("counts", s.counts, kLeftOut);
}

void fields(auto&& visit, Of<SearchSummary> auto& s) {
  visit("contact", s.contact);
  visit("parameters", s.parameters);
  visit("correlation", s.correlation);
  visit("target", s.target);
  visit("discrepancy", s.target.discrepancy);
  visit("surface", s.surface);
  visit("confirmed", s.confirmed);
  visit("packings", s.packings);
  visit("replicates", s.replicates);
  visit("evaluations", s.evaluations);
  visit("loop_passes", s.cost.loop_passes);
  visit("contact_evaluations", s.cost.contact_evaluations);
  visit("core_seconds", s.cost.seconds);
}

void fields(auto&& visit, Of<InverseSummary> auto& s) {
  fields(visit, s.head);
  visit("inverse", s.inverse);
  visit("packings", s.packings);
}

namespace report {
struct RunData;
std::string inverse_section(const RunData& run);  ///< the soft particle that gives a target curve
}  // namespace report

}  // namespace softgrain
