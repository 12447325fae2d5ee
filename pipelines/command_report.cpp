// softgrain report DIR: writes DIR/report.html. Makes no run directory of its own, so that the run's summary stays as
// it is.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "pipelines/report/report.h"
#include "pipelines/run_context.h"

namespace softgrain {

ExitStatus command_report(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw BadInput("report: needs one run directory");
  const std::string& directory = options.inputs.front();
  write_report(directory);
  const std::string path = directory + "/report.html";
  if (options.json) {
    const nlohmann::json summary{{"command", "report"}, {"status", "good"}, {"files", {{"report", path}}}};
    std::printf("%s\n", summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    std::printf("report: %s\n", path.c_str());
  }
  return ExitStatus::good;
}

}  // namespace softgrain
