#include "pipelines/hierarchy_check.h"

#include <fmt/format.h>

#include <cmath>

#include "common/io/progress.h"
#include "microsim/shell_packing.h"
#include "pipelines/kept_crowd.h"
#include "pipelines/parallel_tasks.h"

namespace softgrain {

namespace {

/// Packings of inner soft particles come from this place of the random stream on, far from those of the centre.
constexpr std::uint64_t kInnerPackings = 1000000;
constexpr std::size_t kDifferentInner = 8;  ///< different ones, used turn by turn

enum class Engine { empty, law, resolved };
constexpr Engine kEngines[] = {Engine::resolved, Engine::law, Engine::empty};

const char* name_of(Engine engine) {
  return engine == Engine::empty ? "empty" : engine == Engine::law ? "law" : "resolved";
}

CrowdConfiguration one_plane(const std::vector<double>& overlaps) {
  CrowdConfiguration c;
  c.name = "check";
  c.partners = {{PartnerKind::plane, 0.0, {{1.0, 0.0, 0.0}}}};
  c.stages = {{"load", {overlaps.back()}, 0.0}};
  return c;
}

SoftContent content_of(const HierarchySetup& setup, const ShellPacking& packing, Engine engine,
                       const std::vector<ShellPacking>& inner) {
  SoftContent content = fill_level(setup, packing);
  if (setup.check_inner > 0 && content.inner.size() > static_cast<std::size_t>(setup.check_inner))
    content.inner.resize(static_cast<std::size_t>(setup.check_inner));
  if (engine == Engine::empty) content.inner.clear();
  if (engine == Engine::resolved) content.inner_packings = inner;
  return content;
}

struct Task {
  Engine engine = Engine::law;
  std::size_t packing = 0;
};

/// Means and the error of the paired ratio.
CheckPoint point_of(const std::vector<CrowdRun>& resolved, const std::vector<CrowdRun>& law,
                    const std::vector<CrowdRun>& empty, std::size_t k) {
  const auto n = static_cast<double>(resolved.size());
  CheckPoint p;
  p.overlap = resolved.front().points[k].overlap[0];
  const auto force = [k](const CrowdRun& run) { return run.points[k].normal[0]; };
  for (std::size_t j = 0; j < resolved.size(); ++j) {
    p.resolved += force(resolved[j]) / n;
    p.law += force(law[j]) / n;
    p.empty += force(empty[j]) / n;
  }
  if (!(p.resolved > 0.0)) return p;
  p.ratio = p.law / p.resolved;
  if (n < 2.0) return p;
  const double scale = 1.0 / (n * (n - 1.0));
  for (std::size_t j = 0; j < resolved.size(); ++j) {
    p.law_error += scale * (force(law[j]) - p.law) * (force(law[j]) - p.law);
    p.resolved_error += scale * (force(resolved[j]) - p.resolved) * (force(resolved[j]) - p.resolved);
    const double rest = force(law[j]) - p.ratio * force(resolved[j]);
    p.ratio_error += scale * rest * rest;
  }
  p.law_error = std::sqrt(p.law_error);
  p.resolved_error = std::sqrt(p.resolved_error);
  p.ratio_error = std::sqrt(p.ratio_error) / p.resolved;
  return p;
}

}  // namespace

CheckResult check_two_decades(const HierarchySetup& setup, const LawTableEntry& finest, const TaskStore& store,
                              const RunContext& context) {
  const std::uint64_t seed = context.seed(setup.crowd.seed);
  const auto n = static_cast<std::size_t>(setup.check_packings);
  std::vector<ShellPacking> inner;
  for (std::size_t k = 0; k < kDifferentInner; ++k)
    inner.push_back(generate_shell_packing(setup.crowd.spec, seed, kInnerPackings + k));
  const InnerLaws laws = inner_laws(setup, finest);
  const CrowdConfiguration configuration = one_plane(setup.check_overlaps);
  CrowdPlan plan(1);
  for (const double x : setup.check_overlaps) plan[0].push_back(x / setup.check_overlaps.back());
  std::vector<Task> tasks;
  for (const Engine engine : kEngines)
    for (std::size_t p = 0; p < n; ++p) tasks.push_back({engine, p});
  std::vector<CrowdRun> runs(tasks.size());
  CheckResult result;
  result.packings = setup.check_packings;
  std::vector<double> grains(tasks.size());
  std::vector<double> inside(tasks.size());
  Progress progress("two decades, resolved", static_cast<double>(tasks.size()), context.quiet());
  parallel_tasks(static_cast<std::int64_t>(tasks.size()), [&](std::int64_t t) {
    const auto u = static_cast<std::size_t>(t);
    const ShellPacking packing = generate_shell_packing(setup.crowd.spec, seed, tasks[u].packing);
    const SoftContent content = content_of(setup, packing, tasks[u].engine, inner);
    CrowdExperiment e = make_crowd(setup.crowd.spec, configuration, content, {}, &laws);
    grains[u] = static_cast<double>(e.system.particles.grains);
    inside[u] = static_cast<double>(content.inner.size());
    const std::string task = fmt::format("check-{}-{}", name_of(tasks[u].engine), tasks[u].packing);
    bool known = false;
    store.load(task, [&](const h5::Group& g) {
      runs[u] = read_crowd_runs(g).at(0);
      known = true;
    });
    if (!known) {
      runs[u] = run_kept_crowd(store, task, e, plan, setup.crowd.options, {});
      store.save(task, [&](const h5::Group& g) { write_crowd_runs(g, {runs[u]}); });
    }
    progress.advance();
  });
  const auto of = [&](std::size_t engine) {
    const auto first = runs.begin() + static_cast<std::ptrdiff_t>(engine * n);
    return std::vector<CrowdRun>(first, first + static_cast<std::ptrdiff_t>(n));
  };
  for (std::size_t k = 0; k < setup.check_overlaps.size(); ++k)
    result.points.push_back(point_of(of(0), of(1), of(2), k));
  for (std::size_t u = 0; u < runs.size(); ++u) {
    if (tasks[u].engine == Engine::resolved) {
      result.resolved_cost += runs[u].cost;
      result.grains += grains[u] / static_cast<double>(n);
      result.inner += inside[u] / static_cast<double>(n);
    }
    if (tasks[u].engine == Engine::law) result.law_cost += runs[u].cost;
    for (const CrowdPoint& p : runs[u].points) result.converged = result.converged && p.converged;
  }
  return result;
}

}  // namespace softgrain
