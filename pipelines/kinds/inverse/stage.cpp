#include "pipelines/kinds/inverse/stage.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/io/interrupt.h"
#include "microsim/measure.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/soft_particle/stage.h"

namespace softgrain {

namespace {

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
  std::vector<double> rows;
  for (const NormalPoint& p : r.normal)
    rows.insert(rows.end(), {p.delta, p.force, p.residual, p.max_overlap, p.converged ? 1.0 : 0.0});
  group.write("normal", rows);
  group.write("u", task.u);
  group.write("cost", std::vector<double>{static_cast<double>(r.cost.loop_passes),
                                          static_cast<double>(r.cost.contact_evaluations), r.cost.seconds});
}

/// False when the file belongs to another point.
bool read_result(const h5::Group& group, const Task& task, TaskResult& r) {
  if (group.doubles("u") != task.u) return false;
  const std::vector<double> rows = group.doubles("normal");
  for (std::size_t k = 0; k + 5 <= rows.size(); k += 5)
    r.normal.push_back({rows[k], rows[k + 1], rows[k + 2], rows[k + 3], rows[k + 4] != 0.0});
  const std::vector<double> cost = group.doubles("cost");
  r.cost = {static_cast<std::int64_t>(cost.at(0)), static_cast<std::int64_t>(cost.at(1)), cost.at(2)};
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

}  // namespace

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

}  // namespace softgrain
