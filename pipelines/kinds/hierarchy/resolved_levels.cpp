#include "pipelines/kinds/hierarchy/level.h"

#include <fmt/format.h>

#include <cmath>

#include "common/core/parallel_tasks.h"
#include "common/io/progress.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"

namespace softgrain {

namespace {

/// Packings of inner soft particles come from this place of the random stream on, far from those of the centre.
constexpr std::uint64_t kInnerPackings = 1000000;
constexpr std::size_t kDifferentInner = 8;  ///< different ones, used turn by turn

enum class Engine { law, resolved };
constexpr Engine kEngines[] = {Engine::resolved, Engine::law};

const char* name_of(Engine engine) { return engine == Engine::law ? "law" : "resolved"; }

MultiContactConfiguration one_plane(const std::vector<double>& overlaps) {
  MultiContactConfiguration c;
  c.name = "check";
  c.partners = {{PartnerKind::plane, 0.0, {{1.0, 0.0, 0.0}}}};
  c.stages = {{MultiContactMove::load, {overlaps.back()}, 0.0}};
  return c;
}

struct Task {
  Engine engine = Engine::law;
  std::size_t packing = 0;
};

/// Means and the error of the paired ratio.
CheckPoint point_of(const std::vector<MultiContactRun>& resolved, const std::vector<MultiContactRun>& law,
                    std::size_t k) {
  const auto n = static_cast<double>(resolved.size());
  CheckPoint p;
  p.overlap = resolved.front().points[k].overlap[0];
  const auto force = [k](const MultiContactRun& run) { return run.points[k].normal[0]; };
  for (std::size_t j = 0; j < resolved.size(); ++j) {
    p.resolved += force(resolved[j]) / n;
    p.law += force(law[j]) / n;
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

/// One loading and what was inside.
struct CheckRun {
  Task task;
  MultiContactRun run;
  double grains = 0.0;  ///< number of grains in the system
  double inside = 0.0;  ///< inner soft particles
};

std::vector<CheckRun> check_tasks(std::size_t packings) {
  std::vector<CheckRun> runs;
  for (const Engine engine : kEngines)
    for (std::size_t p = 0; p < packings; ++p) runs.push_back({{engine, p}, {}});
  return runs;
}

/// Loads the stored run, or measures and stores it. `content` is of level 1.
void measure(CheckRun& check, const HierarchySetup& setup, const InnerLaws& laws, const SoftContent& content,
             const MultiContactPlan& plan, const Run& run) {
  MultiContactExperiment e =
      make_multi_contact(setup.multi_contact.spec, one_plane(setup.check_overlaps), content, {}, &laws);
  check.grains = static_cast<double>(e.system.particles.grains);
  check.inside = static_cast<double>(content.inner.size());
  const std::string name = fmt::format("check-{}-{}", name_of(check.task.engine), check.task.packing);
  check.run = run.get_or_make(kept_multi_contact_run(), name, "", "", [&] {
    return run_kept_multi_contact(run.store, name, e, plan, setup.multi_contact.options, {});
  });
}

std::vector<MultiContactRun> runs_of(const std::vector<CheckRun>& checks, Engine engine) {
  std::vector<MultiContactRun> runs;
  for (const CheckRun& c : checks)
    if (c.task.engine == engine) runs.push_back(c.run);
  return runs;
}

CheckResult result_of(const std::vector<CheckRun>& checks, const HierarchySetup& setup) {
  CheckResult result;
  result.packings = setup.check_packings;
  const auto resolved = runs_of(checks, Engine::resolved);
  const auto law = runs_of(checks, Engine::law);
  for (std::size_t k = 0; k < setup.check_overlaps.size(); ++k) result.points.push_back(point_of(resolved, law, k));
  for (const CheckRun& c : checks) {
    if (c.task.engine == Engine::resolved) {
      result.resolved_cost += c.run.cost;
      result.grains += c.grains / static_cast<double>(setup.check_packings);
      result.inner += c.inside / static_cast<double>(setup.check_packings);
    }
    if (c.task.engine == Engine::law) result.law_cost += c.run.cost;
    for (const MultiContactPoint& p : c.run.points) result.converged = result.converged && p.converged;
  }
  return result;
}

}  // namespace

CheckResult check_two_decades(const HierarchySetup& setup, const HierarchyLevel& finest, const Run& run) {
  std::vector<ShellPacking> inner;
  for (std::size_t k = 0; k < kDifferentInner; ++k)
    inner.push_back(generate_shell_packing(setup.multi_contact.spec, run.seed, kInnerPackings + k));
  const InnerLaws laws = inner_laws(setup, finest.entry);
  LevelContents contents(setup, run.seed);
  contents.begin_level(&finest);
  MultiContactPlan plan(1);
  for (const double x : setup.check_overlaps) plan[0].push_back(x / setup.check_overlaps.back());
  std::vector<CheckRun> checks = check_tasks(static_cast<std::size_t>(setup.check_packings));
  Progress progress("two decades, resolved", static_cast<double>(checks.size()), run.context.quiet());
  parallel_tasks(static_cast<std::int64_t>(checks.size()), [&](std::int64_t t) {
    CheckRun& check = checks[static_cast<std::size_t>(t)];
    SoftContent content = contents.of(generate_shell_packing(setup.multi_contact.spec, run.seed, check.task.packing),
                                      static_cast<std::int64_t>(check.task.packing));
    if (setup.check_inner > 0 && content.inner.size() > static_cast<std::size_t>(setup.check_inner))
      content.inner.resize(static_cast<std::size_t>(setup.check_inner));
    if (check.task.engine == Engine::resolved) content.inner_packings = inner;
    measure(check, setup, laws, content, plan, run);
    progress.advance();
  });
  return result_of(checks, setup);
}

}  // namespace softgrain
