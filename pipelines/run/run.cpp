#include "pipelines/run/run.h"

#include <fmt/format.h>

#include <filesystem>

#include "pipelines/report/report.h"
#include "pipelines/results/summary.h"

namespace softgrain {

Run::Run(const Scene& scene, const CommonOptions& options, const std::string& command, std::uint64_t scene_seed,
         const RunInputs& inputs)
    : Run(RunContext(options, command, std::filesystem::path(scene.path()).stem().string(), inputs.files), scene,
          scene_seed, inputs.text) {}

Run::Run(RunContext held, const Scene& scene, std::uint64_t scene_seed, const std::string& text)
    : context(std::move(held)),
      seed(context.seed(scene_seed)),
      provenance(context.provenance(scene, seed)),
      store(context, scene, seed, text) {}

ExitStatus Run::finish(nlohmann::json summary, const std::string& console) const {
  if (!summary.contains("seconds")) summary["seconds"] = seconds();
  const bool good = is_good(summary.value("status", ""));
  context.finish(std::move(summary), provenance,
                 console + fmt::format("{:.0f} s; report: {}", seconds(), path("report.html")));
  write_report(context.directory());
  store.clear();
  return good ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain
