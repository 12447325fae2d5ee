#include "pipelines/runs/run_numbers.h"

#include "pipelines/report/run_data.h"
#include "pipelines/report/run_values.h"

namespace softgrain {

void read_numbers(const std::string& directory, RunEntry& entry) {
  const report::RunData run = report::load_run(directory);
  const auto summary = run.summary_as<AnySummary>();
  entry.status = parse_enum<RunStatus>(summary.status).value_or(RunStatus::good);
  if (summary.seconds) entry.seconds = *summary.seconds;
  if (const std::vector<std::string> why = warnings_of(summary); entry.status == RunStatus::not_usable && !why.empty())
    entry.reason = why.front();
  entry.numbers = report::values_of(run);
}

}  // namespace softgrain
