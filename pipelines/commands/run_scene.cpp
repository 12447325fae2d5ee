// softgrain run: one scene; its `kind` says which. softgrain microsim and macrosim: the same for some of the kinds.
// softgrain sweep SCENE --over key=a,b,c: one scene over values of its keys, and over seeds.
#include <fmt/format.h>
#include <omp.h>

#include <cstdio>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/progress.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/run/run_context.h"
#include "pipelines/runs/run_set.h"
#include "pipelines/runs/search.h"

namespace softgrain {

namespace {

/// Results do not depend on the number, time does.
void warn_of_cores(const CommonOptions& options) {
  const int cores = omp_get_num_procs();
  for (const auto& [option, wanted] : {std::pair<const char*, std::int64_t>{"--threads", options.threads},
                                       std::pair<const char*, std::int64_t>{"--ranks", options.ranks}})
    if (wanted > cores) {
      const std::string text =
          fmt::format("softgrain: warning: {} {}: {} here; more than that take turns and are slower than {}\n", option,
                      wanted, cores == 1 ? "one core" : fmt::format("{} cores", cores), cores);
      log_text(text);
      if (!options.quiet) (void)std::fputs(text.c_str(), stderr);
    }
}

/// Runs it; what does not go together in the scene and shows only now is said with its file.
ExitStatus run_kind(const SceneKind& kind, const Scene& scene, const CommonOptions& options) {
  try {
    return kind.run(scene, options);
  } catch (const UnfitScene& e) {
    throw InputError(scene.path() + ": " + e.what());
  }
}

/// Who gives a table of measurements or sizes in place of a scene is told so.
Scene load_scene(const CommonOptions& options) {
  const std::string& path = options.inputs.front();
  try {
    return Scene::load(path, options.overrides);
  } catch (const InputError& e) {
    const auto form = file_form(path);
    if (!form || form == FileForm::toml) throw;
    throw InputError(std::string(e.what()) + "; a scene is a TOML file: softgrain check " + shell_word(path) +
                     " says what this file is for");
  }
}

ExitStatus run_scene(const CommonOptions& options, const std::string& command) {
  if (options.inputs.size() != 1)
    throw InputError(command + ": one scene is needed (softgrain " + command + " SCENE.toml)");
  const Scene scene = load_scene(options);
  const SceneKind& kind = kind_of(scene, command);
  refuse_idle_options(kind, options);
  warn_of_cores(options);
  if (!options.seeds.empty()) {
    if (options.seed_given) throw InputError("--seeds: goes without --seed");
    return run_set(options, make_plan({}, options.seeds, options.overrides), command, "seeds");
  }
  return run_kind(kind, scene, options);
}

}  // namespace

ExitStatus command_run(const CommonOptions& options) { return run_scene(options, "run"); }

ExitStatus command_microsim(const CommonOptions& options) { return run_scene(options, "microsim"); }

ExitStatus command_macrosim(const CommonOptions& options) { return run_scene(options, "macrosim"); }

ExitStatus command_sweep(const CommonOptions& options) {
  if (options.seed_given && !options.seeds.empty()) throw InputError("--seeds: goes without --seed");
  if (options.jobs > 1 && (options.slurm || !options.only.empty()))
    throw InputError("--jobs: cannot be combined with --slurm or --only");
  if (options.slurm && !options.only.empty()) throw InputError("--slurm: goes without --only");
  if (!options.maximise.empty() || !options.minimise.empty()) {
    const SearchGoal goal = search_goal(options);
    const Scene scene = Scene::load(options.inputs.front(), options.overrides);
    const TakesWholeNumbers takes_whole = takes_whole_numbers(options);
    return run_set(options, search_plan(options, takes_whole), "sweep", "search",
                   search_rounds(goal, takes_whole, options.seed_given ? options.seed : scene_seed(scene)));
  }
  if (options.points > 0) throw InputError("--points: goes with --maximise or --minimise");
  const auto plan = [&] {
    if (options.sample.empty()) return make_plan(options.over, options.seeds, options.overrides, options.seed_given);
    const Scene scene = Scene::load(options.inputs.front(), options.overrides);
    const SampleDesign design = read_design(options.sample, options.seed_given ? options.seed : scene_seed(scene));
    return make_plan(options.over, options.seeds, options.overrides, options.seed_given, design,
                     takes_whole_numbers(options));
  };
  return run_set(options, plan(), "sweep", "sweep");
}

}  // namespace softgrain
