// A reverse search: packings measured at points of the box, each kept as it is finished, and what it came to.
#include "pipelines/kinds/inverse/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/fields.h"
#include "common/io/interrupt.h"
#include "common/io/progress.h"
#include "common/io/text_file.h"
#include "microsim/measure.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/inverse/summary.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/run.h"
#include "pipelines/run/size_summary.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

/// All evaluations of a search and the confirming one.
struct InverseResult {
  std::vector<InverseEvaluation> evaluations;
  InverseAnswer answer;
  Measurements confirmed;   ///< measurements at the answer, with packings that the search has not seen
  InverseEvaluation check;  ///< `confirmed` as curves
  Cost cost;                ///< total cost
  std::int64_t not_converged = 0;
  std::int64_t points = 0;
};

/// Packings of the confirming evaluation: numbers that no search uses.
constexpr std::int64_t kConfirmOffset = std::int64_t{1} << 24;

/// One packing at one point of the box.
struct Task {
  std::string name;
  std::vector<double> u;
  std::int64_t packing = 0;  ///< number in the random streams: the same ones at every point
};

struct TaskResult {
  std::vector<NormalPoint> normal;  ///< fewer than were asked for when the run came to an early end
  Cost cost;
};

void write_result(const h5::Group& group, const Task& task, const TaskResult& r) {
  group.write("normal", rows_of(r.normal));
  group.write("u", task.u);
  group.write("cost", rows_of(std::vector{r.cost}));
}

/// False when the file belongs to another point.
bool read_result(const h5::Group& group, const Task& task, TaskResult& r) {
  if (group.doubles("u") != task.u) return false;
  r.normal = records_of<NormalPoint>(group.doubles("normal"));
  r.cost = records_of<Cost>(group.doubles("cost")).at(0);
  return true;
}

TaskResult measure_one(const InverseSetup& setup, const Task& task, std::uint64_t seed) {
  const SoftParticleSpec spec = spec_at(setup, task.u);
  const auto protocol = make_protocol(setup.measure, setup.relaxation);
  TaskResult result;
  MeasurementState state;
  try {
    const ShellPacking first = generate_shell_packing(spec, seed, static_cast<std::uint64_t>(task.packing));
    state.experiment =
        setup.kind == PairKind::soft_solid
            ? make_soft_solid(spec, first, protocol->damped_contacts())
            : make_soft_soft(spec, first, generate_shell_packing(spec, seed, second_body_index(task.packing)),
                             protocol->damped_contacts());
    measure(state, setup.plan, *protocol);
  } catch (
      const UnusableResult&) {   // a lost grain at the far end of the box must not end the search: what there is counts
  } catch (const InputError&) {  // not a grain found a place
  }
  result.normal = state.run.normal;
  result.cost = state.run.normal_cost;
  return result;
}

/// Shared by all evaluations.
struct Stage {
  const InverseSetup& setup;
  const Run& run;
  Progress& progress;
  InverseResult& out;
};

std::vector<TaskResult> run_tasks(const Stage& stage, const std::vector<Task>& tasks) {
  std::vector<TaskResult> results(tasks.size());
  parallel_tasks(static_cast<std::int64_t>(tasks.size()), [&](std::int64_t k) {
    const auto i = static_cast<std::size_t>(k);
    bool known = false;
    stage.run.store.load(tasks[i].name, [&](const h5::Group& g) { known = read_result(g, tasks[i], results[i]); });
    if (!known) {
      results[i] = measure_one(stage.setup, tasks[i], stage.run.seed);
      stage.run.store.save(tasks[i].name, [&](const h5::Group& g) { write_result(g, tasks[i], results[i]); });
    }
    stage.progress.advance();
  });
  for (const TaskResult& r : results) stage.out.cost += r.cost;
  return results;
}

/// Curves of the packings of one point; a point that did not converge is no force.
InverseEvaluation evaluation_of(const Stage& stage, const std::vector<double>& u, const TaskResult* results,
                                std::size_t packings) {
  InverseEvaluation e;
  e.u = u;
  e.packings = packings;
  const std::size_t n = stage.setup.target.delta.size();
  e.force.assign(packings * n, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < packings; ++k)
    for (std::size_t j = 0; j < n; ++j) {
      ++stage.out.points;
      const bool there = j < results[k].normal.size() && results[k].normal[j].converged;
      if (there)
        e.force[k * n + j] = results[k].normal[j].force;
      else
        ++stage.out.not_converged;
    }
  return e;
}

void evaluate(const Stage& stage, const std::vector<std::vector<double>>& points) {
  const auto packings = static_cast<std::size_t>(stage.setup.packings);
  const std::size_t first = stage.out.evaluations.size();
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < packings; ++k)
      tasks.push_back({fmt::format("evaluation-{}-packing-{}", first + i, k), points[i], static_cast<std::int64_t>(k)});
  const std::vector<TaskResult> results = run_tasks(stage, tasks);
  for (std::size_t i = 0; i < points.size(); ++i)
    stage.out.evaluations.push_back(evaluation_of(stage, points[i], &results[i * packings], packings));
}

/// Measures at the answer what no part of the search has seen.
void confirm(const Stage& stage) {
  InverseResult& out = stage.out;
  const auto packings = static_cast<std::size_t>(stage.setup.confirm);
  std::vector<Task> tasks;
  for (std::size_t k = 0; k < packings; ++k)
    tasks.push_back({fmt::format("answer-packing-{}", k), out.answer.u, kConfirmOffset + static_cast<std::int64_t>(k)});
  const std::vector<TaskResult> results = run_tasks(stage, tasks);
  out.check = evaluation_of(stage, out.answer.u, results.data(), packings);
  Measurements& data = out.confirmed;
  data.spec = spec_at(stage.setup, out.answer.u);
  data.shell_turns = stage.setup.plan.shell_turns;
  data.approach_speed = stage.setup.measure.published.approach_speed;
  MeasureSetup measured = stage.setup.measure;
  measured.spec = data.spec;
  data.settings[to_string(stage.setup.relaxation)] = settings_text(measured, stage.setup.relaxation);
  for (std::size_t k = 0; k < packings; ++k) {
    PackingRun run;
    run.packing = static_cast<std::int64_t>(data.packings.size());
    run.kind = stage.setup.kind;
    run.relaxation = to_string(stage.setup.relaxation);
    run.normal = results[k].normal;
    run.normal_cost = results[k].cost;
    if (run.normal.empty()) continue;
    data.packings.push_back(describe(
        generate_shell_packing(data.spec, stage.run.seed, static_cast<std::uint64_t>(tasks[k].packing)), data.spec));
    data.runs.push_back(std::move(run));
  }
}

/// Runs the search. Finished packings are taken from the store; results depend on no thread count. Throws
/// UnusableResult, Interrupted.
InverseResult run_inverse_stage(const InverseSetup& setup, const Run& run) {
  InverseResult out;
  Progress progress("searching", static_cast<double>(setup.budget * setup.packings + setup.confirm),
                    run.context.quiet());
  const Stage stage{setup, run, progress, out};
  std::vector<std::vector<double>> points;
  for (std::int64_t k = 0; k < setup.design; ++k)
    points.push_back(spread_point(run.seed, static_cast<std::size_t>(k), setup.search.size()));
  evaluate(stage, points);
  while (static_cast<std::int64_t>(out.evaluations.size()) < setup.budget) {
    const std::int64_t left = setup.budget - static_cast<std::int64_t>(out.evaluations.size());
    evaluate(stage, next_points(out.evaluations, setup.target, run.seed,
                                static_cast<std::size_t>(std::min(left, setup.batch))));
  }
  out.answer = answer(out.evaluations, setup.target, run.seed, setup.replicates);
  confirm(stage);
  progress.finish();
  return out;
}

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
    out.counts.push_back(static_cast<std::int64_t>(m.n));
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
  std::vector<std::string> out;
  const InverseAnswer& a = r.answer;
  const std::size_t d = setup.search.size();
  if (!(misfit <= kReached))
    out.push_back(
        fmt::format("the target is not reached: misfit per point {:.3g} with new packings, at most {} is good; widen "
                    "the ranges, or "
                    "search another parameter",
                    misfit, kReached));
  out.insert(out.end(), setup.remarks.begin(), setup.remarks.end());
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
  std::string text = fmt::format("{} of {}; the soft particle nearest to the target:\n",
                                 counted(r.evaluations.size(), "evaluation"), counted(setup.packings, "packing"));
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
  summary.head.warnings = speed_warnings(setup.measure);
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

/// As SceneKind::starter.
constexpr const char* kInverseStarter = R"(title = "Which soft particle gives these forces?"
seed = 1
[packing]
trials = 100
polydispersity = 4.0
beta = 8.0
count = 2
[measure]
relaxation = "damped"
[measure.damped]
increment = 0.02
tolerance = 1e-2
[target]
delta = [0.2, 0.3, 0.4]
force = ["0.1 N", "0.5 N", "1.4 N"]
error = ["0.01 N", "0.05 N", "0.14 N"]
discrepancy = 0.05
[search]
mu = [0.05, 0.9]
budget = 8
design = 4
batch = 2
confirm = 2
replicates = 20
)";

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
                                                        .next = next_of},
                                            .summary = members_of<InverseSummary>,
                                            .starter = kInverseStarter});
}

}  // namespace softgrain
