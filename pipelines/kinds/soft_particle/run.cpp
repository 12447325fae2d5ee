#include "pipelines/kinds/soft_particle/scene.h"

#include <fmt/format.h>

#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/kinds/soft_particle/results.h"
#include "pipelines/kinds/soft_particle/stage.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/run.h"
#include "pipelines/run/size_summary.h"

namespace softgrain {

namespace {

struct SoftParticleSummary {
  SummaryHead head;
  MeasuredSummary measured;
};

void fields(auto&& visit, Of<SoftParticleSummary> auto& s) {
  fields(visit, s.head);
  fields(visit, s.measured);
}

ExitStatus run_soft_particle_scene(const Scene& scene, const CommonOptions& options) {
  const SoftParticleScene read = read_soft_particle_scene(scene);
  const MeasureSetup& setup = read.measure;
  const Run run(scene, options, "microsim", setup.seed, {.text = sizes_text(setup.spec)});
  MeasureResult result;
  run.guard([&] { result = run_measure_stage(setup, run); });

  SoftParticleSummary summary;
  summary.head.title = read.title;
  summary.head.remarks = measurement_remarks(result.data);
  if (!summary.head.remarks.empty() || !result.enough_left) summary.head.status = RunStatus::not_usable;
  summary.head.warnings = result.left_out;
  summary.measured = summary_of(result.data, setup.relaxations());
  summary.head.sizes = summaries_of(shell_sizes(setup.spec, result.data.packings));
  summary.measured.packings.broke_off = result.left_out.size();
  summary.head.files = {{"measurements", run.path("measurements.h5")}, {"report", run.path("report.html")}};
  std::string console =
      fmt::format("{} packings, solid fraction {:.4f}, {} points measured in {:.1f} s\n", result.data.packings.size(),
                  summary.measured.packings.solid_fraction, summary.measured.measurement.points, result.wall_seconds);
  return run.finish(json_of(summary), console);
}

}  // namespace

SceneKind soft_particle_kind() {
  return {.name = "soft-particle",
          .command = "microsim",
          .run = run_soft_particle_scene,
          .check = [](const Scene& scene, const std::string&,
                      Findings& out) { (void)check_measurements(read_soft_particle_scene(scene).measure, out); },
          .read = [](const Scene& scene) { (void)read_soft_particle_scene(scene); },
          .results = soft_particle_results()};
}

}  // namespace softgrain
