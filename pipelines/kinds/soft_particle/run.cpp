#include "pipelines/kinds/soft_particle/scene.h"

#include <fmt/format.h>

#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/kinds/soft_particle/stage.h"
#include "pipelines/run/run.h"
#include "pipelines/run/run_summary.h"

namespace softgrain {

namespace {

ExitStatus run_soft_particle_scene(const Scene& scene, const CommonOptions& options) {
  const SoftParticleScene read = read_soft_particle_scene(scene);
  const MeasureSetup& setup = read.measure;
  const Run run(scene, options, "microsim", setup.seed);
  MeasureResult result;
  run.context.guard([&] { result = run_measure_stage(setup, run); });

  nlohmann::json summary;
  auto remarks = measurement_remarks(result.data);
  const bool usable = remarks.empty() && result.enough_left;
  for (const std::string& text : result.left_out) remarks.push_back(text);
  summary["status"] = usable ? "good" : "not usable";
  summary["title"] = read.title;
  summary["packings"] = packings_json(result.data);
  summary["packings"]["broke_off"] = result.left_out.size();
  summary["measurement"] = measurement_json(result.data, to_string(setup.series[0].relaxation));
  summary["forces"] = forces_json(result.data, to_string(setup.series[0].relaxation));
  if (setup.series.size() > 1) {
    summary["reference_measurement"] = measurement_json(result.data, to_string(setup.series[1].relaxation));
    summary["relaxations"] =
        relaxations_json(result.data, to_string(setup.series[1].relaxation), to_string(setup.series[0].relaxation));
  }
  summary["remarks"] = remarks;
  summary["files"] = {{"measurements", run.path("measurements.h5")}, {"report", run.path("report.html")}};
  std::string people = fmt::format("{} packings, solid fraction {:.4f}, {} points measured in {:.1f} s\n",
                                   result.data.packings.size(), summary["packings"]["solid_fraction"].get<double>(),
                                   summary["measurement"]["points"].get<std::int64_t>(), result.wall_seconds);
  for (const std::string& text : result.left_out) people += "note: " + text + "\n";
  return run.finish(std::move(summary), people);
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
