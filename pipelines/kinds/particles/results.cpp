#include "pipelines/kinds/particles/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

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
  } catch (const IoError& e) {
    const std::string text = e.what();
    throw IoError(text.starts_with(path) ? text : path + ": " + text);
  }
  out.add("kind", "particles", fmt::format("particles: {} recorded frames", frames));
}

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto scene = run.summary_as<ParticlesSummary>();
  if (scene.particles.empty()) return {};
  const std::int64_t count = std::max<std::int64_t>(scene.particle_count, std::ssize(scene.particles));
  return {{"Scene", count == 1 ? "1 explicit particle." : fmt::format("{} explicit particles.", count)}};
}

std::vector<RunValue> values_of(const report::RunData& run) {
  const auto scene = run.summary_as<ParticlesSummary>();
  std::vector<RunValue> out;
  if (scene.particles.empty()) return out;
  out.push_back({"kinetic energy at the end", "J", scene.kinetic_energy});
  for (const auto& [key, name, unit] :
       {std::tuple{"coordination_number", "coordination number at the end", ""}, {"pressure", "pressure", "Pa"}})
    if (const auto at = scene.contact_state.find(key); at != scene.contact_state.end() && at->is_number())
      out.push_back({name, unit, at->get<double>()});
  if (!scene.contacts || scene.contacts->empty()) return out;
  double force = 0.0;
  for (const PairSummary& pair : *scene.contacts) force = std::max(force, pair.max_force);
  out.push_back({"largest force of a contact", "N", force});
  return out;
}

NextSteps next_of(const report::RunData& run) {
  return {
      "Every recorded state for ParaView, OVITO or a spreadsheet: `softgrain export " + run.directory +
          " --to vtp` (or `lammps-dump`, `csv`).",
      "Whether the result depends on the time step: `softgrain sweep SCENE.toml --over time.step=A,B,C`, with A the "
      "step of this run, B and C a half and a quarter of it."};
}

}  // namespace

KindResults particles_results() {
  return {.files = {{.names = "run\\.h5",
                     .is = [](const h5::Group& root) { return root.has("trajectory"); },
                     .check = check_particles_file,
                     .visit = visit_particles},
                    {.names = "run(_contacts)?\\.xdmf"}},
          .sections = {{Part::states, report::particles_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain
