#include "pipelines/kinds/inverse/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/statistics.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/inverse/summary.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/size_summary.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

/// Above this misfit per Delta the curve at the answer is not the target.
constexpr double kReached = 4.0;
/// Above this correlation two parameters are not told apart.
constexpr double kAlike = 0.9;

/// Mean and standard error over packings at each Delta; NaN where no packing gave a force.
ConfirmedCurve curve_of(const InverseEvaluation& e, std::size_t deltas) {
  ConfirmedCurve out;
  for (std::size_t j = 0; j < deltas; ++j) {
    Tally sample;
    for (std::size_t k = 0; k < e.packings; ++k)
      if (const double f = e.force[k * deltas + j]; !std::isnan(f)) sample.add(f);
    const MeanError m = sample.statistics();
    out.force.push_back(m.mean);
    out.error.push_back(m.error_or_zero());
  }
  return out;
}

std::vector<FoundParameter> parameters_of(const InverseSetup& setup, const InverseAnswer& a) {
  std::vector<FoundParameter> out;
  for (std::size_t k = 0; k < setup.search.size(); ++k) {
    const SearchParameter& p = setup.search[k];
    // The slope of the parameter over its coordinate turns the error of one into that of the other.
    const double slope = p.logarithmic ? p.value(a.u[k]) * std::log(p.high / p.low) : p.high - p.low;
    out.push_back({p.name,
                   p.value(a.u[k]),
                   {p.value(a.low[k]), p.value(a.high[k])},
                   slope * a.standard_error[k],
                   !a.open[k],
                   {p.low, p.high},
                   p.logarithmic});
  }
  return out;
}

std::vector<EvaluationSummary> evaluations_of(const InverseSetup& setup, const InverseResult& r) {
  std::vector<EvaluationSummary> out;
  for (const InverseEvaluation& e : r.evaluations) {
    EvaluationSummary& one = out.emplace_back();
    for (std::size_t k = 0; k < setup.search.size(); ++k) one.values.push_back(setup.search[k].value(e.u[k]));
    one.misfit = misfit_of(e, setup.target);
    one.force = curve_of(e, setup.target.delta.size()).force;
  }
  return out;
}

std::string evaluations_table(const InverseSetup& setup, const InverseResult& r) {
  std::string text;
  for (const SearchParameter& p : setup.search) text += p.name + ",";
  text += "misfit";
  for (const double d : setup.target.delta) text += fmt::format(",Fn({:.6g}) [N]", d);
  text += "\n";
  for (const InverseEvaluation& e : r.evaluations) {
    for (std::size_t k = 0; k < setup.search.size(); ++k) text += fmt::format("{:.9g},", setup.search[k].value(e.u[k]));
    text += fmt::format("{:.6g}", misfit_of(e, setup.target));
    for (const double f : curve_of(e, setup.target.delta.size()).force) text += fmt::format(",{:.9g}", f);
    text += "\n";
  }
  return text;
}

std::vector<std::string> remarks_of(const InverseSetup& setup, const InverseResult& r, double misfit) {
  std::vector<std::string> out = setup.remarks;
  const InverseAnswer& a = r.answer;
  const std::size_t d = setup.search.size();
  if (!(misfit <= kReached))
    out.push_back(
        fmt::format("the target is not reached: misfit per point {:.3g} with new packings, at most {} is good; widen "
                    "the ranges, or "
                    "search another parameter",
                    misfit, kReached));
  for (std::size_t k = 0; k < d; ++k)
    if (a.open[k])
      out.push_back(fmt::format("{}: the interval reaches the end of the range, the target does not close it",
                                setup.search[k].name));
  for (std::size_t k = 0; k < d; ++k)
    for (std::size_t l = k + 1; l < d; ++l)
      if (std::abs(a.correlation[k * d + l]) > kAlike)
        out.push_back(fmt::format("{} and {} are hardly told apart by this curve (correlation {:.2f})",
                                  setup.search[k].name, setup.search[l].name, a.correlation[k * d + l]));
  if (a.lack_of_fit > 2.0)
    out.push_back(
        fmt::format("the quadratic surface misses the evaluations near the answer by {:.1f} of their errors: "
                    "raise search.budget, or narrow the ranges",
                    a.lack_of_fit));
  if (r.not_converged > 0)
    out.push_back(fmt::format("{} of {} points were not reached or did not meet their criterion, and are left out",
                              r.not_converged, r.points));
  return out;
}

SearchSummary search_of(const InverseSetup& setup, const InverseResult& r, double misfit) {
  ConfirmedCurve confirmed = curve_of(r.check, setup.target.delta.size());
  confirmed.packings = r.check.packings;
  confirmed.misfit = misfit;
  return {setup.kind,
          parameters_of(setup, r.answer),
          r.answer.correlation,
          setup.target,
          {r.answer.predicted, r.answer.misfit, r.answer.lack_of_fit},
          std::move(confirmed),
          setup.packings,
          r.answer.replicates,
          evaluations_of(setup, r),
          r.cost};
}

std::string console_summary(const InverseSetup& setup, const InverseResult& r, double misfit) {
  std::string text = fmt::format("{} evaluations of {} packings; the soft particle nearest to the target:\n",
                                 r.evaluations.size(), setup.packings);
  const InverseAnswer& a = r.answer;
  for (std::size_t k = 0; k < setup.search.size(); ++k) {
    const SearchParameter& p = setup.search[k];
    text += fmt::format("  {} = {:.4g} [{:.4g}, {:.4g}]{}\n", p.name, p.value(a.u[k]), p.value(a.low[k]),
                        p.value(a.high[k]), a.open[k] ? ", not closed within the range" : "");
  }
  return text + fmt::format("misfit per point with {} new packings: {:.2g} (1: as far as errors go)\n",
                            r.check.packings, misfit);
}

RunInputs inputs_of(const InverseSetup& setup) {
  // The target may stand in another file: what was kept for one serves no other.
  std::string target;
  for (std::size_t j = 0; j < setup.target.delta.size(); ++j)
    target += fmt::format("{:a} {:a} {:a}\n", setup.target.delta[j], setup.target.force[j], setup.target.error[j]);
  return {.seed = setup.measure.seed, .text = target + sizes_text(setup.measure.spec)};
}

Outcome run_inverse(const InverseSetup& setup, const Run& run) {
  InverseResult result;
  run.guard([&] { result = run_inverse_stage(setup, run); });
  save(result.confirmed, run.path("measurements.h5"), run.provenance);
  write_text_atomic(run.path("evaluations.csv"), evaluations_table(setup, result));

  const double misfit = misfit_of(result.check, setup.target);
  InverseSummary summary;
  summary.head = {
      misfit <= kReached ? RunStatus::good : RunStatus::not_usable, setup.title, remarks_of(setup, result, misfit), {}};
  summary.inverse = search_of(setup, result, misfit);
  summary.packings = summary_of(result.confirmed.packings);
  summary.head.sizes = summaries_of(shell_sizes(result.confirmed.spec, result.confirmed.packings));
  for (const char* file : {"measurements.h5", "evaluations.csv", "report.html"})
    summary.head.files[file] = run.path(file);
  return {json_of(summary), console_summary(setup, result, misfit)};
}

std::vector<RunValue> values_of(const report::RunData& run) {
  std::vector<RunValue> out;
  const auto search = run.summary_as<InverseSummary>().inverse;
  if (!search) return out;
  for (const FoundParameter& p : search->parameters) out.push_back({p.name, "", p.value, p.standard_error});
  out.push_back({"misfit of the confirmed curve", "", search->confirmed.misfit});
  return out;
}

NextSteps next_of(const report::RunData& run) {
  return {
      "The law of the soft particle that was found: `softgrain calibrate " + run.directory + "/measurements.h5`.",
      "Parameters whose interval does not close are not told by this curve: measure deeper, or fix one of them in the "
      "scene."};
}

}  // namespace

SceneKind inverse_kind() {
  return scene_kind(TypedKind<InverseSetup>{.name = "inverse",
                                            .command = "run",
                                            .read = read_inverse,
                                            .inputs = inputs_of,
                                            .run = run_inverse,
                                            .check = check_inverse,
                                            .results = {.files = {{.names = "evaluations\\.csv"}},
                                                        .sections = {{Part::answer, report::inverse_section}},
                                                        .values = values_of,
                                                        .next = next_of}});
}

}  // namespace softgrain
