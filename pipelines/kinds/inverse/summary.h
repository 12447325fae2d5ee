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
  double standard_error = 0.0;
  bool closed = false;
  std::array<double, 2> range{};
  bool logarithmic = false;
};

/// One point of the search; misfit NaN where it gave no whole curve.
struct EvaluationSummary {
  std::vector<double> values;
  double misfit = 0.0;
  std::vector<double> force;
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
  std::vector<std::int64_t> counts{};

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
  std::int64_t packings = 0;
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
  visit("name", s.name, Means{"key of the parameter"});
  visit("value", s.value, Means{"value of the best fit", "SI unit of the key"});
  visit("interval", s.interval, Means{"95 % interval", "SI unit of the key"});
  visit("standard_error", s.standard_error,
        Means{"standard error from the curvature of the surface", "SI unit of the key"});
  visit("closed", s.closed, Means{"whether the interval ends within the range"});
  visit("range", s.range, Means{"range that was searched", "SI unit of the key"});
  visit("logarithmic", s.logarithmic, Means{"whether the range is logarithmic"});
}

void fields(auto&& visit, Of<EvaluationSummary> auto& s) {
  visit("values", s.values, Means{"values of the parameters", "SI units of the keys"});
  visit("misfit", s.misfit, Means{"misfit to the target; null: no whole curve", "1"});
  visit("force", s.force, Means{"mean force at each Delta", "N"});
}

void fields(auto&& visit, Of<InverseTarget> auto& s) {
  visit("delta", s.delta, Means{"overlaps Delta of the target", "1"});
  visit("force", s.force, Means{"forces of the target", "N"});
  visit("error", s.error, Means{"standard errors of these forces", "N"});
}

void fields(auto&& visit, Of<SurfaceSummary> auto& s) {
  visit("force", s.force, Means{"forces of the fitted surface at the optimum", "N"});
  visit("misfit", s.misfit, Means{"misfit there", "1"});
  visit("lack_of_fit", s.lack_of_fit,
        Means{"root mean square distance of means near the optimum from the surface, over their errors", "1"});
}

void fields(auto&& visit, Of<ConfirmedCurve> auto& s) {
  visit("force", s.force, Means{"mean forces of packings that the search has not seen", "N"});
  visit("error", s.error, Means{"their standard errors", "N"});
  visit("packings", s.packings, Means{"number of these packings", "1"});
  visit("misfit", s.misfit, Means{"misfit of these forces", "1"});
  visit("counts", s.counts, kLeftOut, Means{"packings with a force at each Delta", "1"});
}

void fields(auto&& visit, Of<SearchSummary> auto& s) {
  visit("contact", s.contact, Means{"kind of contact"});
  visit("parameters", s.parameters, Means{"parameters that were searched"});
  visit("correlation", s.correlation, Means{"correlation of the parameters, row by row", "1"});
  visit("target", s.target, Means{"target curve"});
  visit("discrepancy", s.target.discrepancy, Means{"relative error of the target that all its forces share", "1"});
  visit("surface", s.surface, Means{"the fitted surface at the optimum"});
  visit("confirmed", s.confirmed, Means{"the answer, measured again"});
  visit("packings", s.packings, Means{"packings of each evaluation", "1"});
  visit("replicates", s.replicates, Means{"replicates of the intervals", "1"});
  visit("evaluations", s.evaluations, Means{"points of the search"});
  visit("loop_passes", s.cost.loop_passes, Means{"passes over all contacts", "1"});
  visit("contact_evaluations", s.cost.contact_evaluations, Means{"evaluations of contact laws", "1"});
  visit("core_seconds", s.cost.seconds, Means{"core seconds", "s"});
}

void fields(auto&& visit, Of<InverseSummary> auto& s) {
  fields(visit, s.head);
  visit("inverse", s.inverse, Means{"the search"});
  visit("packings", s.packings, Means{"packings of the confirming measurement"});
}

namespace report {
struct RunData;
std::string inverse_section(const RunData& run);  ///< the soft particle that gives a target curve
}  // namespace report

}  // namespace softgrain
