#include "pipelines/kinds/inverse/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/statistics.h"
#include "common/io/json_number.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/inverse/stage.h"
#include "pipelines/run/run.h"
#include "pipelines/run/run_summary.h"

namespace softgrain {

namespace {

using nlohmann::json;

/// Above this misfit per Delta the curve at the answer is not the target.
constexpr double kReached = 4.0;
/// Above this correlation two parameters are not told apart.
constexpr double kAlike = 0.9;

/// Mean and standard error over packings at each Delta; NaN where no packing gave a force.
struct Curve {
  std::vector<double> mean;
  std::vector<double> error;
};

Curve curve_of(const InverseEvaluation& e, std::size_t deltas) {
  Curve out;
  for (std::size_t j = 0; j < deltas; ++j) {
    Tally sample;
    for (std::size_t k = 0; k < e.packings; ++k)
      if (const double f = e.force[k * deltas + j]; !std::isnan(f)) sample.add(f);
    const MeanError m = sample.statistics();
    out.mean.push_back(m.mean);
    out.error.push_back(m.error_or_zero());
  }
  return out;
}

json numbers(const std::vector<double>& values) {
  json out = json::array();
  for (const double x : values) out.push_back(number_or_null(x));
  return out;
}

json parameters_json(const InverseSetup& setup, const InverseAnswer& a) {
  json out = json::array();
  for (std::size_t k = 0; k < setup.search.size(); ++k) {
    const SearchParameter& p = setup.search[k];
    // The slope of the parameter over its coordinate turns the error of one into that of the other.
    const double slope = p.logarithmic ? p.value(a.u[k]) * std::log(p.high / p.low) : p.high - p.low;
    out.push_back({{"name", p.name},
                   {"value", p.value(a.u[k])},
                   {"interval", {p.value(a.low[k]), p.value(a.high[k])}},
                   {"standard_error", slope * a.standard_error[k]},
                   {"closed", !a.open[k]},
                   {"range", {p.low, p.high}},
                   {"logarithmic", p.logarithmic}});
  }
  return out;
}

json evaluations_json(const InverseSetup& setup, const InverseResult& r) {
  json out = json::array();
  for (const InverseEvaluation& e : r.evaluations) {
    json values = json::array();
    for (std::size_t k = 0; k < setup.search.size(); ++k) values.push_back(setup.search[k].value(e.u[k]));
    out.push_back({{"values", values},
                   {"misfit", number_or_null(misfit_of(e, setup.target))},
                   {"force", numbers(curve_of(e, setup.target.delta.size()).mean)}});
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
    for (const double f : curve_of(e, setup.target.delta.size()).mean) text += fmt::format(",{:.9g}", f);
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

json inverse_json(const InverseSetup& setup, const InverseResult& r, double misfit) {
  const Curve check = curve_of(r.check, setup.target.delta.size());
  return {
      {"contact", to_string(setup.kind)},
      {"parameters", parameters_json(setup, r.answer)},
      {"correlation", r.answer.correlation},
      {"target", {{"delta", setup.target.delta}, {"force", setup.target.force}, {"error", setup.target.error}}},
      {"discrepancy", setup.target.discrepancy},
      {"surface",
       {{"force", numbers(r.answer.predicted)}, {"misfit", r.answer.misfit}, {"lack_of_fit", r.answer.lack_of_fit}}},
      {"confirmed",
       {{"force", numbers(check.mean)},
        {"error", numbers(check.error)},
        {"packings", r.check.packings},
        {"misfit", number_or_null(misfit)}}},
      {"packings", setup.packings},
      {"replicates", r.answer.replicates},
      {"evaluations", evaluations_json(setup, r)},
      {"loop_passes", r.cost.loop_passes},
      {"contact_evaluations", r.cost.contact_evaluations},
      {"core_seconds", r.cost.seconds}};
}

std::string people_text(const InverseSetup& setup, const InverseResult& r, double misfit) {
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

ExitStatus run_inverse(const Scene& scene, const CommonOptions& options) {
  const InverseSetup setup = read_inverse(scene);
  // The target may stand in another file: what was kept for one serves no other.
  std::string target;
  for (std::size_t j = 0; j < setup.target.delta.size(); ++j)
    target += fmt::format("{:a} {:a} {:a}\n", setup.target.delta[j], setup.target.force[j], setup.target.error[j]);
  const Run run(scene, options, "run", setup.measure.seed, {.text = target});
  InverseResult result;
  run.context.guard([&] { result = run_inverse_stage(setup, run); });
  save(result.confirmed, run.path("measurements.h5"), run.provenance);
  write_text_atomic(run.path("evaluations.csv"), evaluations_table(setup, result));

  const double misfit = misfit_of(result.check, setup.target);
  const std::vector<std::string> remarks = remarks_of(setup, result, misfit);
  json summary;
  summary["status"] = misfit <= kReached ? "good" : "not usable";
  summary["title"] = setup.title;
  summary["inverse"] = inverse_json(setup, result, misfit);
  summary["packings"] = packings_json(result.confirmed);
  summary["remarks"] = remarks;
  for (const char* file : {"measurements.h5", "evaluations.csv", "report.html"})
    summary["files"][file] = run.path(file);
  std::string people = people_text(setup, result, misfit);
  for (const std::string& remark : remarks) people += "note: " + remark + "\n";
  return run.finish(std::move(summary), people);
}

}  // namespace

SceneKind inverse_kind() {
  return {.name = "inverse",
          .command = "run",
          .run = run_inverse,
          .check = [](const Scene& scene, const std::string&, Findings& out) { check_inverse(scene, out); },
          .read = [](const Scene& scene) { (void)read_inverse(scene); }};
}

}  // namespace softgrain
