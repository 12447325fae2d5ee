#include "pipelines/kinds/soft_particle/run.h"

#include <fmt/format.h>

#include <filesystem>

#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/kinds/soft_particle/stage.h"
#include "pipelines/report/report.h"
#include "pipelines/run/run_summary.h"

namespace softgrain {

namespace {

ExitStatus run_soft_particle_scene(const Scene& scene, const CommonOptions& options) {
  const SoftParticleScene read = read_soft_particle_scene(scene);
  const MeasureSetup& setup = read.measure;
  const RunContext context(options, "microsim", std::filesystem::path(scene.path()).stem().string());
  const std::uint64_t seed = context.seed(setup.seed);
  const TaskStore store(context, scene, seed);
  MeasureResult result;
  context.guard([&] { result = run_measure_stage(setup, store, context, context.provenance(scene, seed)); });

  nlohmann::json summary;
  auto remarks = measurement_remarks(result.data);
  const bool usable = remarks.empty() && result.enough_left;
  for (const std::string& text : result.left_out) remarks.push_back(text);
  summary["status"] = usable ? "good" : "not usable";
  summary["title"] = read.title;
  summary["packings"] = packings_json(result.data);
  summary["packings"]["broke_off"] = result.left_out.size();
  summary["measurement"] = measurement_json(result.data, setup.series[0].relaxation);
  summary["forces"] = forces_json(result.data, setup.series[0].relaxation);
  if (setup.series.size() > 1) {
    summary["reference_measurement"] = measurement_json(result.data, setup.series[1].relaxation);
    summary["relaxations"] = relaxations_json(result.data, setup.series[1].relaxation, setup.series[0].relaxation);
  }
  summary["remarks"] = remarks;
  summary["files"] = {{"measurements", context.path("measurements.h5")}, {"report", context.path("report.html")}};
  summary["provenance"] = provenance_json(context.provenance(scene, seed));
  std::string people = fmt::format("{} packings, solid fraction {:.4f}, {} points measured in {:.1f} s\n",
                                   result.data.packings.size(), summary["packings"]["solid_fraction"].get<double>(),
                                   summary["measurement"]["points"].get<std::int64_t>(), result.wall_seconds);
  for (const std::string& text : result.left_out) people += "note: " + text + "\n";
  context.finish(summary, people + "report: " + context.path("report.html"));
  write_report(context.directory());
  store.clear();
  return usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace

SceneKind soft_particle_kind() {
  return {.name = "soft-particle",
          .command = "microsim",
          .run = run_soft_particle_scene,
          .check = [](const Scene& scene, const std::string&,
                      Findings& out) { (void)check_measurements(read_soft_particle_scene(scene).measure, out); },
          .read = [](const Scene& scene) { (void)read_soft_particle_scene(scene); }};
}

}  // namespace softgrain
