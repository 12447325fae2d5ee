#include "pipelines/kinds/particles/results.h"

#include <fmt/format.h>

#include "common/core/error.h"
#include "pipelines/kinds/particles/summary.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

void check_particles_file(const std::string& path, Findings& out) {
  std::size_t frames = 0;
  try {
    visit_particles(path, SnapshotChoice::all, [&](const Snapshot&) { ++frames; });
  } catch (const FileTrouble& e) {
    const std::string text = e.what();
    throw FileTrouble(text.starts_with(path) ? text : path + ": " + text);
  }
  out.add("kind", "particles", fmt::format("particles: {} recorded frames", frames));
}

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto scene = run.summary_as<ParticlesSummary>();
  if (scene.particles.empty()) return {};
  const std::int64_t count = std::max<std::int64_t>(scene.particle_count, std::ssize(scene.particles));
  return {{"Scene", count == 1 ? "1 explicit particle." : fmt::format("{} explicit particles.", count)}};
}

}  // namespace

KindResults particles_results() {
  return {.files = {{.names = "run\\.h5",
                     .is = [](const h5::Group& root) { return root.has("trajectory"); },
                     .check = check_particles_file,
                     .visit = visit_particles},
                    {.names = "run(_contacts)?\\.xdmf"}},
          .sections = {{Place::particles, report::particles_section}},
          .lines = lines_of};
}

}  // namespace softgrain
