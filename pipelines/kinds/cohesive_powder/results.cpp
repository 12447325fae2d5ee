#include "pipelines/kinds/cohesive_powder/results.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipelines/kinds/cohesive_powder/powder_data.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

void check_powder_file(const std::string& path, Findings& out) {
  const PowderRun run = load_powder(path);
  const auto unusable =
      std::count_if(run.samples.begin(), run.samples.end(), [](const PowderSample& s) { return !s.usable; });
  out.add("kind", "powders", fmt::format("cohesive powders: {} samples", run.samples.size()));
  if (unusable > 0) out.warn(fmt::format("{} samples did not come to rest", unusable));
}

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto* powder = run.file("powder.h5", load_powder);
  if (powder == nullptr) return {};
  return {{"Powder", fmt::format("{} packs of disks.", powder->samples.size())}};
}

}  // namespace

KindResults powder_results() {
  return {
      .files = {{.names = "powder\\.h5",
                 .is = [](const h5::Group& root) { return root.has("sample_0") && root.has("spec"); },
                 .check = check_powder_file,
                 .visit = visit_powder}},
      .sections = {{Place::powder_variants, report::powder_variants_section}, {Place::powder, report::powder_section}},
      .lines = lines_of};
}

}  // namespace softgrain
