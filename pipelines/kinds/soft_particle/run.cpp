#include "pipelines/kinds/soft_particle/scene.h"

#include <fmt/format.h>

#include "common/core/text.h"
#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/size_summary.h"
#include "pipelines/run/typed_kind.h"

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

RunInputs inputs_of(const SoftParticleScene& scene) {
  return {.seed = scene.measure.seed, .text = sizes_text(scene.measure.spec)};
}

Outcome run_soft_particle(const SoftParticleScene& scene, const Run& run) {
  const MeasureSetup& setup = scene.measure;
  MeasureResult result;
  run.guard([&] { result = run_measure_stage(setup, run); });

  SoftParticleSummary summary;
  summary.head.title = scene.title;
  summary.head.remarks = measurement_remarks(result.data);
  if (!summary.head.remarks.empty() || !result.enough_left) summary.head.status = RunStatus::not_usable;
  summary.head.warnings = warnings_of(setup, result);
  summary.measured = summary_of(result.data, setup.relaxations());
  summary.head.sizes = summaries_of(shell_sizes(setup.spec, result.data.packings));
  summary.measured.packings.broke_off = result.left_out.size();
  summary.head.files = {{"measurements", run.path("measurements.h5")}, {"report", run.path("report.html")}};
  std::string console =
      fmt::format("{}, solid fraction {:.4f}, {} measured in {:.1f} s\n",
                  counted(result.data.packings.size(), "packing"), summary.measured.packings.solid_fraction,
                  counted(summary.measured.measurement.points, "point"), result.wall_seconds);
  return {json_of(summary), console};
}

/// As SceneKind::starter.
constexpr const char* kSoftParticleStarter = R"(title = "Force of a soft particle against a plane"
seed = 1
[material]
E = "0.5 MPa"
mu = 0.3
[packing]
polydispersity = 5.0
beta = 3.0
count = 4
[measure]
relaxation = "damped"
[measure.damped]
increment = 0.02
[measure.soft_solid]
deltas = [0.1, 0.15, 0.2, 0.25, 0.3]
tangential_deltas = [0.2, 0.3]
angles_deg = [-0.05, 0.05]
)";

}  // namespace

SceneKind soft_particle_kind() {
  return scene_kind(TypedKind<SoftParticleScene>{
      .name = "soft-particle",
      .command = "microsim",
      .read = read_soft_particle_scene,
      .inputs = inputs_of,
      .run = run_soft_particle,
      .check = [](const SoftParticleScene& scene, Findings& out) { (void)check_measurements(scene.measure, out); },
      .results = soft_particle_results(),
      .summary = members_of<SoftParticleSummary>,
      .starter = kSoftParticleStarter});
}

}  // namespace softgrain
