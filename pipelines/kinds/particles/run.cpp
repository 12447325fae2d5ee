#include "pipelines/kinds/particles/scene.h"

#include <utility>

#include "common/io/progress.h"
#include "common/state/checkpoint.h"
#include "microsim/particles/particles_run.h"
#include "microsim/particles/scene_contacts.h"
#include "microsim/particles/scene_memory.h"
#include "pipelines/export/export.h"
#include "pipelines/kinds/particles/summary.h"
#include "pipelines/run/run.h"

namespace softgrain {

namespace {

template <int D>
ParticlesResultOf<D> run_with_progress(const ParticlesSceneOf<D>& scene, System<D> start, const RunContext& context) {
  Progress progress("particles", static_cast<double>(scene.time.steps), context.quiet());
  ParticlesControl control;
  control.checkpoint = context.path("checkpoint.h5");
  control.resume = context.resume();
  control.say = [&](const std::string& line) { context.say(line); };
  control.progress = [&](std::int64_t step) { progress.set(static_cast<double>(step)); };
  ParticlesResultOf<D> result = run_particles(scene, std::move(start), control);
  progress.finish();
  return result;
}

std::optional<std::uint64_t> seed_of(const CommonOptions& options) {
  return options.seed_given ? std::optional(options.seed) : std::nullopt;
}

template <int D>
ExitStatus run_scene(const Scene& scene, const CommonOptions& options) {
  const double memory_before = peak_memory();
  ParticlesSceneOf<D> setup = read_particles_scene<D>(scene, seed_of(options));
  const Run run(scene, options, "microsim",
                {.seed = setup.seed, .files = contact_law_files(scene), .text = content_of(setup, setup.system)});
  const ParticlesResultOf<D> result = run_with_progress(setup, std::move(setup.system), run.context);
  ParticlesSummary summary = summary_of(setup, result, memory_before);
  summary.head.sizes = summaries_of(drawn_sizes(setup));
  std::string text = particles_text(result) + "\n";
  if (setup.record) {
    save_particles_run(run.path("run.h5"), setup, result, run.provenance);
    write_run_xdmf(run.path("run.h5"));
    summary.head.files = {{"trajectory", run.path("run.h5")},
                          {"xdmf", run.path("run.xdmf")},
                          {"xdmf_contacts", run.path("run_contacts.xdmf")}};
    text += "trajectory: " + run.path("run.h5") + "\n";
  }
  summary.head.files["report"] = run.path("report.html");
  const ExitStatus status = run.finish(json_of(summary), text);
  remove_checkpoint(run.path("checkpoint.h5"));
  return status;
}

ExitStatus run_particles_scene(const Scene& scene, const CommonOptions& options) {
  return particles_dimension(scene) == 2 ? run_scene<2>(scene, options) : run_scene<3>(scene, options);
}

void check_any_particles(const Scene& scene, Findings& out) {
  if (particles_dimension(scene) == 2)
    check_particles(read_particles_scene<2>(scene), out);
  else
    check_particles(read_particles_scene<3>(scene), out);
}

void read_any_particles(const Scene& scene, const std::optional<std::uint64_t>& seed) {
  if (particles_dimension(scene) == 2)
    (void)read_particles_scene<2>(scene, seed);
  else
    (void)read_particles_scene<3>(scene, seed);
}

/// As SceneKind::starter.
constexpr const char* kParticlesStarter = R"(title = "Two glass beads meet"
[material.glass]
E = "1 MPa"
nu = 0.2
density = 2500.0
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.8
mu = 0.4
[[particle]]
material = "glass"
radius = "5 mm"
position = [0.0, 0.0, 0.0]
velocity = [0.1, 0.0, 0.0]
[[particle]]
material = "glass"
radius = "5 mm"
position = ["12 mm", "2 mm", 0.0]
[time]
end = 0.2
[output]
every = 0.01
)";

}  // namespace

SceneKind particles_kind() {
  return {
      .name = "particles",
      .command = "microsim",
      .run = run_particles_scene,
      .check = [](const Scene& scene, const CommonOptions&, Findings& out) { check_any_particles(scene, out); },
      .read = [](const Scene& scene) { read_any_particles(scene, {}); },
      .refuse = [](const Scene& scene, const CommonOptions& options) { read_any_particles(scene, seed_of(options)); },
      .results = particles_results(),
      .summary = members_of<ParticlesSummary>,
      .explored_from = {"[material.NAME]\ndensity = 1.0\n[[contact]]\npair = [\"NAME\", \"NAME\"]\n",
                        "dimension = 2\n[material.NAME]\ndensity = 1.0\n[[contact]]\npair = [\"NAME\", \"NAME\"]\nlaw "
                        "= \"cohesive\"\n"
                        "mu = 0.5\nrolling_stiffness = 0.1\n",
                        "[material.NAME]\ndensity = 1.0\n[[contact]]\npair = [\"NAME\", \"rigid\"]\nlaw = "
                        "\"law-card\"\nfile = \"NAME\"\n"},
      .starter = kParticlesStarter};
}

}  // namespace softgrain
