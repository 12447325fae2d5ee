// The runs of a plan, one after another, in directories below that of the set.
#pragma once

#include <string>

#include "pipelines/run/run_context.h"
#include "pipelines/runs/run_plan.h"

namespace softgrain {

/// Runs the scene `options.inputs.front()` as the plan says, each run in OUT/NAME as its own kind runs it (the log, its
/// report and all); OUT is --out, else results/SCENE_`suffix`. With --resume runs that have ended are not repeated, and
/// one that was interrupted goes on where its kind can; runs that the plan has in addition are made. At the end writes
/// summary.json, table.csv and the report of the set. Status not_usable when a run failed or is not usable.
///
/// Throws InputError with all that is wrong with any of the scenes before anything is run; IoError and Interrupted
/// where a run ends so: those before it are kept.
ExitStatus run_set(const CommonOptions& options, const RunPlan& plan, const std::string& command,
                   const std::string& suffix);

}  // namespace softgrain
