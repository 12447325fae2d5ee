#include "pipelines/run/run.h"

#include <fmt/format.h>

#include <filesystem>

#include "pipelines/report/report.h"
#include "pipelines/run/run_summary.h"

namespace softgrain {

Run::Run(const Scene& scene, const CommonOptions& options, const std::string& command, std::uint64_t scene_seed,
         const RunInputs& inputs)
    : context(options, command, std::filesystem::path(scene.path()).stem().string(), inputs.files),
      seed(context.seed(scene_seed)),
      provenance(context.provenance(scene, seed)),
      store(context, scene, seed, inputs.text) {}

ExitStatus Run::finish(nlohmann::json summary, const std::string& people) const {
  summary["seconds"] = seconds();
  summary["provenance"] = provenance_json(provenance);
  const bool good = has_status(summary, RunStatus::good);
  context.finish(std::move(summary), people + fmt::format("{:.0f} s; report: {}", seconds(), path("report.html")));
  write_report(context.directory());
  store.clear();
  return good ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain
