// The measuring part: packings and runs in parallel, each saved as it goes, so that a stopped run goes on.
#include "pipelines/kinds/soft_particle/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>

#include "common/core/cost.h"
#include "common/core/parallel_tasks.h"
#include "common/data/fields.h"
#include "common/io/interrupt.h"
#include "common/io/progress.h"
#include "common/state/system_io.h"
#include "microsim/shell_packing.h"
#include "microsim/soft_experiment.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"
#include "pipelines/run/run.h"

namespace softgrain {

void fields(auto&& visit, Of<SettleResult> auto& r) {
  visit("force", r.force, "N");
  visit("residual", r.residual, "1");
  visit("max_overlap", r.max_overlap, "1");
  visit("converged", r.converged, "1");
}

namespace {

/// One packing (or pair) under one relaxation.
struct Task {
  const MeasureSeries* series = nullptr;
  PairKind kind = PairKind::soft_solid;
  std::int64_t packing = 0;

  /// The turn is named, so that a run of an earlier version that is taken up measures its rotations anew.
  [[nodiscard]] std::string name() const {
    const std::string turned = series->plan(kind).angles_deg.empty() ? "" : "-slow-turn";
    return to_string(series->relaxation) + "-" + to_string(kind) + "-" + std::to_string(packing) + turned;
  }
  /// Relative cost, for progress and for starting long tasks first.
  [[nodiscard]] double weight() const {
    const MeasurementPlan& plan = series->plan(kind);
    const auto points =
        static_cast<double>(plan.deltas.size() + plan.tangential_deltas.size() * plan.angles_deg.size());
    return points * (kind == PairKind::soft_soft ? 2.2 : 1.0) *
           (series->relaxation == Relaxation::published ? 20.0 : 1.0);
  }
};

std::vector<Task> list_tasks(const MeasureSetup& setup) {
  std::vector<Task> tasks;
  for (const MeasureSeries& series : setup.series)
    for (const PairKind kind : series.kinds)
      for (std::int64_t k = 0; k < series.packings; ++k) tasks.push_back({&series, kind, k});
  return tasks;
}

void write_run(const h5::Group& group, const MeasurementState& state) {
  const PackingRun& run = state.run;
  group.write("normal", rows_of(run.normal));
  group.write("tangential", rows_of(run.tangential));
  group.write("cost", rows_of(std::vector{run.normal_cost, run.tangential_cost}));
  group.attribute("normal_overlap", state.experiment.normal_overlap);
  std::vector<SettleResult> rotating;  // empty: no rotations under way
  if (state.rotating) rotating.push_back(*state.rotating);
  group.write("rotating", rows_of(rotating));
  write_system(group.create("system"), state.experiment.system);
}

void read_run(const h5::Group& group, MeasurementState& state) {
  PackingRun& run = state.run;
  run.normal = records_of<NormalPoint>(group.doubles("normal"));
  run.tangential = records_of<TangentialPoint>(group.doubles("tangential"));
  const auto cost = records_of<Cost>(group.doubles("cost"));
  run.normal_cost = cost.at(0);
  run.tangential_cost = cost.at(1);
  state.experiment.normal_overlap = group.number("normal_overlap");
  if (const auto rotating = records_of<SettleResult>(group.doubles("rotating")); !rotating.empty())
    state.rotating = rotating.front();
  read_system(group.open("system"), state.experiment.system);
}

/// Packings by index, generated in parallel.
std::vector<ShellPacking> generate(const MeasureSetup& setup, std::uint64_t seed, std::int64_t count, bool second,
                                   Progress& progress) {
  std::vector<ShellPacking> packings(static_cast<std::size_t>(count));
  parallel_tasks(count, [&](std::int64_t k) {
    if (interrupt_requested()) throw Interrupted("stopped by a signal while packing");
    packings[static_cast<std::size_t>(k)] =
        generate_shell_packing(setup.spec, seed, second ? second_body_index(k) : static_cast<std::uint64_t>(k));
    progress.advance();
  });
  return packings;
}

std::int64_t packings_of_kind(const MeasureSetup& setup, PairKind kind) {
  std::int64_t most = 0;
  for (const MeasureSeries& s : setup.series)
    if (std::find(s.kinds.begin(), s.kinds.end(), kind) != s.kinds.end()) most = std::max(most, s.packings);
  return most;
}

std::vector<Snapshot> joined(std::vector<std::vector<Snapshot>>& parts) {
  std::vector<Snapshot> all;
  for (auto& part : parts) std::move(part.begin(), part.end(), std::back_inserter(all));
  return all;
}

/// Everything the tasks share.
struct Stage {
  const MeasureSetup& setup;
  const TaskStore& store;
  const std::vector<ShellPacking>& first;
  const std::vector<ShellPacking>& second;
  Progress& progress;
};

/// What is recorded at this overlap, with the names that people and files give it.
Snapshot named_state(const SoftExperiment& experiment, const Task& task) {
  Snapshot s = soft_snapshot(experiment);
  const std::string kind = to_string(task.kind);
  s.series = fmt::format("{}-{}-{}", kind, to_string(task.series->relaxation), task.packing);
  s.label = fmt::format("{} by {}, packing {}, Delta {:.4g}", kind, to_string(task.series->relaxation), task.packing,
                        s.overlap);
  return s;
}

/// A run and the states of it that are kept; or why it broke off.
struct TaskOutcome {
  PackingRun run;
  std::vector<Snapshot> states;
  std::string broke_off;
};

std::string break_off_text(const Task& task, const MeasurementState& state, const std::string& why) {
  const std::vector<double>& deltas = task.series->plan(task.kind).deltas;
  const std::size_t next = std::min(state.run.normal.size(), deltas.size() - 1);
  const std::string last =
      state.run.normal.empty() ? "from rest" : fmt::format("beyond Delta = {:.4g}", state.run.normal.back().delta);
  return fmt::format(
      "packing {} of {} by {} is left out: it broke off {} on the way to Delta = {:.4g}: {}; smaller overlaps{} may "
      "keep it whole",
      task.packing, to_string(task.kind), to_string(task.series->relaxation), last, deltas[next], why,
      task.series->relaxation == Relaxation::damped ? "" : " or relaxation = \"damped\"");
}

TaskOutcome run_task(const Stage& stage, const Task& task) {
  const auto protocol = make_protocol(stage.setup, task.series->relaxation);
  const auto k = static_cast<std::size_t>(task.packing);
  MeasurementState state;
  state.experiment =
      task.kind == PairKind::soft_solid
          ? make_soft_solid(stage.setup.spec, stage.first[k], protocol->damped_contacts())
          : make_soft_soft(stage.setup.spec, stage.first[k], stage.second[k], protocol->damped_contacts());
  state.run.packing = task.packing;
  state.run.kind = task.kind;
  state.run.relaxation = to_string(task.series->relaxation);
  const MeasurementPlan& plan = task.series->plan(task.kind);
  SnapshotRecorder states(stage.store, task.name(), static_cast<std::int64_t>(plan.deltas.size()),
                          task.packing == 0 ? stage.setup.kept_states : 0);
  stage.store.load(task.name(), [&](const h5::Group& g) { read_run(g, state); });
  TaskProgress mine(stage.progress, task.weight());
  mine.reach(static_cast<double>(state.run.normal.size()) / static_cast<double>(plan.deltas.size()));
  RunControl<MeasurementState> control{.seconds = stage.store.seconds()};
  control.save = [&](const MeasurementState& s) {
    stage.store.save(task.name(), [&](const h5::Group& g) { write_run(g, s); });
  };
  control.progress = [&](const MeasurementState&, double share) { mine.reach(share); };
  try {
    measure(state, plan, *protocol, control, [&](const SoftExperiment& recorded, std::size_t number) {
      const auto point = static_cast<std::int64_t>(number);
      if (states.wants(point)) states.add(named_state(recorded, task), point);
    });
  } catch (const UnusableResult& e) {  // this packing alone; after --resume it breaks off at the same place again
    mine.reach(1.0);
    return {{}, states.take(), break_off_text(task, state, e.what())};
  }
  return {state.run, states.take(), ""};
}

/// Puts together what is whole, in the order of tasks, and says what is not.
void collect(const std::vector<Task>& tasks, std::vector<TaskOutcome>& outcomes, MeasureResult& result) {
  std::map<std::pair<const MeasureSeries*, PairKind>, std::int64_t> lost;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (outcomes[k].broke_off.empty()) {
      result.data.runs.push_back(std::move(outcomes[k].run));
      continue;
    }
    result.left_out.push_back(std::move(outcomes[k].broke_off));
    const std::int64_t n = ++lost[{tasks[k].series, tasks[k].kind}];
    result.enough_left = result.enough_left && 2 * n <= tasks[k].series->packings;
  }
}

}  // namespace

std::uint64_t second_body_index(std::int64_t packing) {
  return (std::uint64_t{1} << 32) + static_cast<std::uint64_t>(packing);
}

MeasureResult run_measure_stage(const MeasureSetup& setup, const Run& run) {
  const Stopwatch start;
  MeasureResult result;
  const std::int64_t pairs = packings_of_kind(setup, PairKind::soft_soft);
  Progress packing_progress("packing", static_cast<double>(setup.packings() + pairs), run.context.quiet());
  result.packings = generate(setup, run.seed, setup.packings(), false, packing_progress);
  const auto second = generate(setup, run.seed, pairs, true, packing_progress);
  packing_progress.finish();
  result.packing_seconds = start.seconds();

  const auto tasks = list_tasks(setup);
  std::vector<double> costs;
  for (const Task& t : tasks) costs.push_back(t.weight());
  const double total = std::accumulate(costs.begin(), costs.end(), 0.0);
  Progress progress("measuring", total, run.context.quiet());
  Measurements& data = result.data;
  data.spec = setup.spec;
  data.shell_turns = setup.series[0].plan(setup.series[0].kinds[0]).shell_turns;
  data.approach_speed = setup.published.approach_speed;
  for (const MeasureSeries& s : setup.series)
    data.settings[to_string(s.relaxation)] = settings_text(setup, s.relaxation);
  if (setup.rotates()) data.turn_speed = turn_speed(setup.series[0].plan(setup.series[0].kinds[0]), setup.spec);
  for (const ShellPacking& p : result.packings) data.packings.push_back(describe(p, setup.spec));
  const Stage stage{setup, run.store, result.packings, second, progress};
  std::vector<TaskOutcome> outcomes(tasks.size());
  parallel_tasks(costs, [&](std::size_t t) { outcomes[t] = run_task(stage, tasks[t]); });
  progress.finish();
  std::vector<std::vector<Snapshot>> states;
  for (TaskOutcome& o : outcomes) states.push_back(std::move(o.states));
  collect(tasks, outcomes, result);
  for (const std::string& text : result.left_out) run.context.say(text);
  if (data.runs.empty())
    throw UnusableResult(
        fmt::format("not one of {} measurements came to its end; {}", tasks.size(), result.left_out[0]));
  save(data, run.path("measurements.h5"), run.provenance);
  save_kept_states(joined(states), run.path("states_measurements.h5"), run.provenance);
  result.wall_seconds = start.seconds();
  return result;
}

}  // namespace softgrain
