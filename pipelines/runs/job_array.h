// The runs of a set as the job array of a cluster.
#pragma once

#include "pipelines/run/run_context.h"
#include "pipelines/runs/run_set.h"

namespace softgrain {

/// Writes DIR/slurm/commands.txt, one command per run, and DIR/slurm/job.sh, which sbatch takes; submits nothing.
/// Returns what to do with them. Throws IoError; InputError for an option of several lines.
std::string write_job_array(const CommonOptions& options, const RunPlan& plan, const RunContext& context);

}  // namespace softgrain
