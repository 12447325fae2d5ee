// A run with several neighbours whose way is kept in the task store while it lasts.
#pragma once

#include <functional>
#include <string>

#include "microsim/multi_contact_experiment.h"
#include "pipelines/run/run.h"

namespace softgrain {

/// run_multi_contact() from where task `name` was left off, or from the beginning. What is kept while it lasts is
/// removed at the end: keeping the result is left to the caller.
MultiContactRun run_kept_multi_contact(const TaskStore& store, const std::string& name,
                                       MultiContactExperiment& experiment, const MultiContactPlan& plan,
                                       const MultiContactOptions& options,
                                       const std::function<void(double share)>& progress);

}  // namespace softgrain
