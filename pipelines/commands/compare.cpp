// softgrain compare A B: error norms and cost of A against B. With one argument: what can be compared inside that run.
#include "pipelines/compare/compare_inputs.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

ExitStatus command_compare(const CommonOptions& options) {
  if (options.inputs.empty() || options.inputs.size() > 2) {
    throw BadInput(
        "compare: needs a candidate and a reference (run directories, macro.h5, measurements.h5 or law.toml), or one "
        "run to compare within");
  }
  const bool within = options.inputs.size() == 1;
  if (within && options.different) throw BadInput("compare: --different goes with two runs");
  const CompareSide candidate = load_side(options.inputs.front());
  const CompareResult result = within ? compare_within(candidate)
                                      : compare_sides(candidate, load_side(options.inputs.back()), options.different);
  const RunContext context(options, "compare", "compare");
  nlohmann::json summary = to_json(result);
  const bool usable = result.undefined.empty();
  summary["status"] = usable ? "good" : "not usable";
  summary["candidate"] = options.inputs.front();
  summary["reference"] = options.inputs.back();
  context.finish(std::move(summary), to_text(result));
  return usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain
