// A run with several neighbours whose way is kept in the task store while it lasts.
#pragma once

#include <functional>
#include <string>

#include "microsim/crowd_experiment.h"
#include "pipelines/run/task_store.h"

namespace softgrain {

/// run_crowd() from where task `name` was left off, or from the beginning. What is kept while it lasts is removed at
/// the end: keeping the result is left to the caller.
CrowdRun run_kept_crowd(const TaskStore& store, const std::string& name, CrowdExperiment& experiment,
                        const CrowdPlan& plan, const CrowdOptions& options,
                        const std::function<void(double share)>& progress);

}  // namespace softgrain
