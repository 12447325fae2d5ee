// softgrain report DIR: writes DIR/report.html. Makes no run directory of its own, so that the run's summary stays as
// it is.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/io/text_file.h"
#include "pipelines/report/report.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

/// Not beside a run that writes there; what is no directory is for write_report to complain about.
std::unique_ptr<DirectoryLock> lock_of(const std::string& directory) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(directory, ignored)) return nullptr;
  return std::make_unique<DirectoryLock>(directory);
}

}  // namespace

ExitStatus command_report(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw InputError("report: needs one run directory");
  const std::string& directory = options.inputs.front();
  {
    const std::unique_ptr<DirectoryLock> alone = lock_of(directory);
    write_report(directory);
  }
  const std::string path = directory + "/report.html";
  const bool unfinished = report::is_unfinished(directory);
  if (options.json) {
    const nlohmann::json summary{
        {"command", "report"}, {"status", "good"}, {"unfinished_run", unfinished}, {"files", {{"report", path}}}};
    write_standard_output(summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  } else {
    write_standard_output("report: " + path +
                          (unfinished ? "\nnote: the run has not come to its end; the page says so, and shows what was "
                                        "there by now\n"
                                      : "\n"));
  }
  return ExitStatus::good;
}

}  // namespace softgrain
