
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/text_file.h"
#include "pipelines/runs/member_process.h"

namespace softgrain {

namespace {

/// Each command is one line of a file.
std::string line_word(const std::string& word) {
  if (word.find('\n') != std::string::npos)
    throw InputError("--slurm: " + word + ": must be one line; put it into the scene");
  return shell_word(word);
}

/// Each run goes on where it was when the cluster starts it again.
CommonOptions job_options(CommonOptions options) {
  options.resume = true;
  options.threads = std::max(1, options.threads);
  return options;
}

std::string commands_text(const CommonOptions& options, const RunPlan& plan, const std::string& directory) {
  std::string text;
  for (const PlannedRun& run : plan.runs)
    text += join_text(member_command(options, directory, run.name), " ", line_word) + "\n";
  return text;
}

/// The command line that collects: that of a task for all of them.
std::string collecting(CommonOptions options, const std::string& directory) {
  options.resume = true;
  options.threads = 0;
  return join_text(member_command(options, directory, ""), " ", line_word);
}

std::string script_text(const CommonOptions& options, const RunPlan& plan, const std::string& folder,
                        const std::string& collect) {
  return fmt::format(
      "#!/bin/bash\n"
      "# One task for each line of commands.txt. Add what the cluster asks for: --time, --mem, --partition, "
      "--account.\n"
      "#SBATCH --job-name=softgrain\n"
      "#SBATCH --array=1-{}\n"
      "#SBATCH --cpus-per-task={}\n"
      "#SBATCH --output=\"{}/%a.txt\"\n"
      "#SBATCH --signal=B:TERM@60\n"
      "# Collect, when all tasks have ended:\n"
      "# {}\n"
      "cd {} || exit 4\n"
      "exec bash -c \"$(sed -n \"${{SLURM_ARRAY_TASK_ID}}p\" {})\"\n",
      plan.runs.size(), options.threads, folder, collect, shell_word(std::filesystem::current_path().string()),
      shell_word(folder + "/commands.txt"));
}

}  // namespace

std::string write_job_array(const CommonOptions& options, const RunPlan& plan, const RunContext& context) {
  constexpr std::size_t kUsualArray = 1000;  // MaxArraySize of Slurm is 1001 unless a cluster sets it
  const CommonOptions own = job_options(options);
  const std::string folder = std::filesystem::absolute(context.path("slurm")).lexically_normal().string();
  const std::string commands = commands_text(own, plan, context.directory());
  require_writable_directory(folder);
  write_text_atomic(folder + "/commands.txt", commands);
  write_text_atomic(folder + "/job.sh", script_text(own, plan, folder, collecting(options, context.directory())));
  std::string text =
      fmt::format("{} commands, one per run, and a job array; nothing was submitted\n", plan.runs.size());
  if (plan.runs.size() > kUsualArray)
    text += fmt::format("many clusters take at most {} tasks in one array: split it\n", kUsualArray);
  return text + "submit: sbatch " + shell_word(context.path("slurm/job.sh")) +
         "\ncollect, when all tasks have ended: the command in the head of this script\n";
}

}  // namespace softgrain
