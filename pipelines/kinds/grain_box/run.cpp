#include "pipelines/kinds/grain_box/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "common/core/parallel_tasks.h"
#include "common/core/text.h"
#include "common/io/progress.h"
#include "microsim/grain_box/grain_box_run.h"
#include "pipelines/kinds/grain_box/report.h"
#include "pipelines/kinds/grain_box/summary.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

/// Runs one pack from its checkpoint, or from the start; keeps its last state for --resume.
GrainBoxResult run_pack(const GrainBoxSpec& spec, const Run& run, Progress& progress) {
  GrainBoxState state;
  run.store.load(spec.name, [&](const h5::Group& group) { state = read_state(group); });
  TaskProgress mine(progress);
  RunControl<GrainBoxState> control{.seconds = run.store.seconds()};
  control.save = [&](const GrainBoxState& now) {
    run.store.save(spec.name, [&](const h5::Group& group) { write_state(group, now); });
  };
  control.say = [&](const std::string& line) { run.context.say(line); };
  control.progress = [&](const GrainBoxState&, double share) { mine.reach(share); };
  GrainBoxResult result = run_grain_box(spec, run.seed, std::move(state), control);
  if (result.usable) control.save(result.state);
  mine.reach(1.0);
  return result;
}

std::vector<GrainBoxResult> run_packs(const GrainBoxSetup& setup, const Run& run) {
  std::vector<GrainBoxResult> results(setup.packs.size());
  Progress progress("grain boxes", static_cast<double>(setup.packs.size()), run.context.quiet());
  parallel_tasks(static_cast<std::int64_t>(setup.packs.size()), [&](std::int64_t k) {
    const auto u = static_cast<std::size_t>(k);
    results[u] = run_pack(setup.packs[u], run, progress);
  });
  progress.finish();
  return results;
}

std::string console_summary(const std::vector<GrainBoxResult>& results) {
  std::string text;
  for (const GrainBoxResult& r : results) {
    const auto points = r.points_of(BoxPhase::loading);
    text += fmt::format("{}: {} grains, {} in {:.1f} s", r.spec.name, r.spec.grains,
                        counted(r.state.points.size(), "state"), r.state.seconds);
    if (!points.empty())
      text += fmt::format(", sigma_c {:.4g} MPa, last K {:.3g} GPa, G {:.3g} GPa", points.back()->pressure * 1e-6,
                          points.back()->bulk * 1e-9, points.back()->shear_modulus * 1e-9);
    text += r.usable ? "\n" : "; NOT USABLE: " + r.reason + "\n";
  }
  return text;
}

RunInputs inputs_of(const GrainBoxSetup& setup) {
  return {.seed = setup.seed, .text = sizes_text(setup.packs.front().material)};
}

Outcome run_grain_boxes(const GrainBoxSetup& setup, const Run& run) {
  const std::vector<GrainBoxResult> results = run_packs(setup, run);
  save_grain_boxes(run.path("grain_box.h5"), results, run.provenance);

  const bool usable = std::ranges::all_of(results, [](const GrainBoxResult& r) { return r.usable; });
  GrainBoxSummary summary{.status = usable ? RunStatus::good : RunStatus::not_usable,
                          .title = setup.title,
                          .packs = summaries_of(results),
                          .over_arrangements = arrangements_of(results),
                          .remarks = grain_box_remarks(results),
                          .files = {{"record", run.path("grain_box.h5")}, {"report", run.path("report.html")}}};
  if (setup.packs.front().material.sizes) summary.sizes = summaries_of(drawn_sizes(setup, run.seed));
  return {json_of(summary), console_summary(results) + arrangements_text(over_arrangements(results))};
}

/// As SceneKind::starter.
constexpr const char* kGrainBoxStarter = R"(title = "A small pack of glass beads"
seed = 1
[material]
radius_min = "0.07 mm"
radius_max = "0.13 mm"
E = "70 GPa"
nu = 0.2
mu = 0.3
[box]
grains = 100
[generation]
pressure = "10 MPa"
[loading]
test = "uniaxial"
increment = 5e-4
end_stress = "30 MPa"
)";

}  // namespace

SceneKind grain_box_kind() {
  return scene_kind(TypedKind<GrainBoxSetup>{
      .name = "grain-box",
      .command = "microsim",
      .read = read_grain_box,
      .inputs = inputs_of,
      .run = run_grain_boxes,
      .check = check_grain_box,
      .results = grain_box_results(),
      .summary = members_of<GrainBoxSummary>,
      .explored_from = {"", "[loading]\ntest = \"polyaxial\"\ncontrol = [\"stress\", \"strain\", \"strain\"]\n"},
      .starter = kGrainBoxStarter});
}

}  // namespace softgrain
