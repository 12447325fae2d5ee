#include "pipelines/kinds/cohesive_powder/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipelines/kinds/cohesive_powder/powder_data.h"
#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

void check_powder_file(const std::string& path, Findings& out) {
  const PowderRun run = load_powder(path);
  const auto unusable =
      std::count_if(run.samples.begin(), run.samples.end(), [](const PowderSample& s) { return !s.usable; });
  out.add("kind", "powders", fmt::format("cohesive powders: {} samples", run.samples.size()));
  if (unusable > 0) out.warn(fmt::format("{} samples did not reach equilibrium", unusable));
}

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto* powder = run.file("powder.h5", load_powder);
  if (powder == nullptr) return {};
  return {{"Powder", fmt::format("{} packs of disks.", powder->samples.size())}};
}

/// What the disks are called in tables, and in the summary.
constexpr std::pair<const char*, const char*> kBeside[] = {{"solid fraction", "Phi"}, {"coordination number", "z"}};

/// Means over samples at rest, with their standard errors.
std::vector<RunValue> values_of(const report::RunData& run) {
  std::vector<RunValue> out;
  for (const auto& [name, key] : kBeside) {
    const auto powder = run.summary_as<PowderSummary>();
    const auto one = powder.statistics.is_object() && run.kind() == "cohesive-powder" ? powder.statistics.find(key)
                                                                                      : powder.statistics.end();
    if (one != powder.statistics.end()) {
      QuantityMean m = record_of<QuantityMean>(*one);
      if (m.samples > 1) m.error = m.deviation / std::sqrt(static_cast<double>(m.samples));
      out.push_back({name, "", m.mean, m.error});
    }
    for (const VariantEntry& v : run.summary_as<PowderVariantsSummary>().variants)
      if (const QuantityMean m = v.ours(key); m.samples > 0)
        out.push_back({fmt::format("{} ({})", name, v.name), "", m.mean, m.error});
  }
  return out;
}

NextSteps next_of(const report::RunData& run) {
  return {
      "How sure the means are: more samples (`--set samples=8`); what they depend on: `softgrain sweep SCENE.toml "
      "--over contact.mu=0.1,0.3,0.5`.",
      "Packings with their forces elsewhere: `softgrain export " + run.directory + " --to vtp`."};
}

}  // namespace

KindResults powder_results() {
  return {.files = {{.names = "powder\\.h5",
                     .is = [](const h5::Group& root) { return root.has("sample_0") && root.has("spec"); },
                     .check = check_powder_file,
                     .visit = visit_powder}},
          .sections = {{Part::states, report::powder_variants_section}, {Part::states, report::powder_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain
