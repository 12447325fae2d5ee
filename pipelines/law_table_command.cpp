#include "pipelines/law_table_command.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "pipelines/crowd_plan.h"
#include "pipelines/crowd_stage.h"
#include "pipelines/crowd_summary.h"
#include "pipelines/run_summary.h"

namespace softgrain {

namespace {

struct LawTableScene {
  std::string title;
  CrowdSetup crowd;
};

LawTableScene read_law_table(const Scene& scene) {
  const SceneTable root = scene.root();
  (void)root.choice("kind", {"law-table"});
  LawTableScene out{root.text("title", ""), read_crowd_setup(root)};
  root.finish();
  return out;
}

bool all_converged(const CrowdMeasurements& data) {
  for (const CrowdRun& run : data.runs)
    for (const CrowdPoint& p : run.points)
      if (!p.converged) return false;
  return true;
}

}  // namespace

bool is_law_table(const Scene& scene) {
  const SceneTable root = scene.root();
  return root.is_text("kind") && root.text("kind") == "law-table";
}

ExitStatus run_law_table(const Scene& scene, const CommonOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const LawTableScene setup = read_law_table(scene);
  const RunContext context(options, "run", std::filesystem::path(scene.path()).stem().string());
  const std::uint64_t seed = context.seed(setup.crowd.seed);
  const Provenance provenance = context.provenance(scene, seed);
  const TaskStore store(context, scene, seed);
  CrowdMeasurements data;
  context.guard([&] { data = run_crowd_stage(setup.crowd, store, context, provenance, nullptr); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const bool usable = all_converged(data);
  nlohmann::json summary;
  summary["status"] = usable ? "good" : "not usable";
  summary["title"] = setup.title;
  summary["seconds"] = seconds;
  summary["crowd"] = crowd_json(data, setup.crowd.target);
  summary["remarks"] = crowd_remarks(data, setup.crowd.target);
  summary["files"] = {{"crowd", context.path("crowd.h5")}};
  summary["provenance"] = provenance_json(provenance);
  std::string people = fmt::format("{} configurations, {} runs:\n", data.configurations.size(), data.runs.size());
  people += crowd_text(data);
  for (const std::string& remark : crowd_remarks(data, setup.crowd.target)) people += "note: " + remark + "\n";
  context.finish(summary, people + fmt::format("{:.0f} s; data: {}", seconds, context.path("crowd.h5")));
  store.clear();
  return usable ? ExitStatus::good : ExitStatus::not_usable;
}

void check_law_table(const Scene& scene, nlohmann::json& facts, std::string& lines) {
  const CrowdSetup setup = read_law_table(scene).crowd;
  const auto configurations = static_cast<std::int64_t>(setup.configurations.size());
  std::int64_t increments = 0;
  std::int64_t stages = 0;
  for (const CrowdConfiguration& c : setup.configurations) {
    increments += count_increments(c, CrowdPlan(c.stages.size(), {1.0}), setup.options);
    stages += static_cast<std::int64_t>(c.stages.size());
  }
  facts["configurations"] = configurations;
  facts["runs_min"] = configurations * setup.packings_min;
  facts["runs_max"] = configurations * setup.packings_max;
  facts["points_per_packing"] = stages * setup.points;
  facts["relaxations_per_packing"] = increments;
  lines += fmt::format("  {} configurations on {} to {} packings: {} to {} runs\n", configurations, setup.packings_min,
                       setup.packings_max, configurations * setup.packings_min, configurations * setup.packings_max);
  lines +=
      fmt::format("  per packing: up to {} recorded states, about {} relaxations\n", stages * setup.points, increments);
}

}  // namespace softgrain
