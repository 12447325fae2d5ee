// Runs of a set as processes of their own: several at once, one alone that a cluster starts, or all as a job array.
#pragma once

#include <string>
#include <vector>

#include "pipelines/results/set_summary.h"
#include "pipelines/run/run_context.h"
#include "pipelines/runs/run_set.h"

namespace softgrain {

/// The command that makes one run of the set in `directory` alone (--only), or all of them for an empty name: this
/// program, then its arguments.
std::vector<std::string> member_command(const CommonOptions& options, const std::string& directory,
                                        const std::string& name);

/// Keeps what came out of a run that was made alone, for the set.
void write_member_entry(const std::string& directory, const RunEntry& entry);

/// Removes what members left for the set.
void forget_member_entries(const std::string& directory);

/// Makes the runs of `entries`, --jobs of them at once, each as a process with its share of the threads, and fills the
/// entries; says a line for each that has ended, with the time that is left. A run that fails or crashes is marked, and
/// the others go on. At a signal all of them are asked to stop. Throws as the set does where its runs follow one
/// another: Interrupted, IoError, InputError of a run of another scene; the other runs are stopped then.
void run_side_by_side(const CommonOptions& options, const RunContext& context, std::vector<RunEntry>& entries);

/// Writes DIR/slurm/commands.txt, one command per run, and DIR/slurm/job.sh, which sbatch takes; submits nothing.
/// Returns what to do with them. Throws IoError; InputError for an option of several lines.
std::string write_job_array(const CommonOptions& options, const RunPlan& plan, const RunContext& context);

}  // namespace softgrain
