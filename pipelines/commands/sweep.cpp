// softgrain sweep SCENE --over key=a,b,c: one scene over values of its keys, and over seeds.
#include "pipelines/kinds/kinds.h"
#include "pipelines/runs/run_set.h"

namespace softgrain {

ExitStatus command_sweep(const CommonOptions& options) {
  if (options.seed_given && !options.seeds.empty()) throw InputError("--seeds: goes without --seed");
  return run_set(options, make_plan(options.over, options.seeds, options.overrides), "sweep", "sweep");
}

}  // namespace softgrain
