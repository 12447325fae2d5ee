#include "pipelines/runs/job_array.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/text_file.h"
#include "pipelines/runs/member_process.h"

namespace softgrain {

namespace {

/// A word as a shell reads it back.
std::string shell_word(const std::string& word) {
  if (word.find('\n') != std::string::npos)
    throw InputError("--slurm: " + word + ": must be one line; put it into the scene");
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
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
    text += join_text(member_command(options, directory, run.name), " ", shell_word) + "\n";
  return text;
}

/// The command line that collects: the same one with --resume in the place of --slurm.
std::string collecting(std::string command_line) {
  const std::string option = " --slurm";
  if (const std::size_t at = command_line.find(option); at != std::string::npos) command_line.erase(at, option.size());
  return command_line.find(" --resume") == std::string::npos ? command_line + " --resume" : command_line;
}

std::string script_text(const CommonOptions& options, const RunPlan& plan, const std::string& folder) {
  return fmt::format(
      "#!/bin/bash\n"
      "# One task for each line of commands.txt. Add what the cluster asks for: --time, --mem, --partition, "
      "--account.\n"
      "#SBATCH --job-name=softgrain\n"
      "#SBATCH --array=1-{}\n"
      "#SBATCH --cpus-per-task={}\n"
      "#SBATCH --output=\"{}/%a.txt\"\n"
      "#SBATCH --signal=B:TERM@60\n"
      "# Collect, when all tasks have ended: {}\n"
      "cd {} || exit 4\n"
      "exec bash -c \"$(sed -n \"${{SLURM_ARRAY_TASK_ID}}p\" {})\"\n",
      plan.runs.size(), options.threads, folder, collecting(options.command_line),
      shell_word(std::filesystem::current_path().string()), shell_word(folder + "/commands.txt"));
}

}  // namespace

std::string write_job_array(const CommonOptions& options, const RunPlan& plan, const RunContext& context) {
  constexpr std::size_t kUsualArray = 1000;  // MaxArraySize of Slurm is 1001 unless a cluster sets it
  const CommonOptions own = job_options(options);
  const std::string folder = std::filesystem::absolute(context.path("slurm")).lexically_normal().string();
  const std::string commands = commands_text(own, plan, context.directory());
  require_writable_directory(folder);
  write_text_atomic(folder + "/commands.txt", commands);
  write_text_atomic(folder + "/job.sh", script_text(own, plan, folder));
  std::string text =
      fmt::format("{} commands, one per run, and a job array; nothing was submitted\n", plan.runs.size());
  if (plan.runs.size() > kUsualArray)
    text += fmt::format("many clusters take at most {} tasks in one array: split it\n", kUsualArray);
  return text + "submit: sbatch " + shell_word(context.path("slurm/job.sh")) +
         "\ncollect, when all tasks have ended: " + collecting(options.command_line) + "\n";
}

}  // namespace softgrain
