#include "pipelines/particles_command.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "common/dynamics/verlet.h"
#include "common/io/progress.h"
#include "common/state/checkpoint.h"
#include "microsim/particles/particles_run.h"
#include "pipelines/run_summary.h"

namespace softgrain {

namespace {

using nlohmann::json;

constexpr Slot kMostListed = 1000;

json particles_json(const System3& s) {
  json out = json::array();
  for (Slot i = 0; i < std::min(s.particles.grains, kMostListed); ++i) {
    const auto u = static_cast<std::size_t>(i);
    out.push_back({{"id", i},
                   {"position", s.particles.sphere[u].x.v},
                   {"velocity", s.particles.velocity[u].v},
                   {"spin", s.particles.spin[u].v}});
  }
  return out;
}

json walls_json(const ParticlesScene& scene, const System3& s) {
  json out = json::array();
  for (std::size_t w = 0; w < scene.wall_name.size(); ++w) {
    const std::size_t u = static_cast<std::size_t>(s.particles.grains) + w;
    out.push_back({{"name", scene.wall_name[w]},
                   {"position", s.particles.sphere[u].x.v},
                   {"velocity", s.particles.velocity[u].v}});
  }
  return out;
}

/// Ids of particles, names of walls.
json body_json(const ParticlesScene& scene, const System3& s, Slot slot) {
  if (slot < s.particles.grains) return slot;
  return scene.wall_name[static_cast<std::size_t>(slot - s.particles.grains)];
}

json contacts_json(const ParticlesScene& scene, const ParticlesResult& result) {
  json out = json::array();
  for (const ContactHistory& c : result.contacts)
    out.push_back({{"pair", {body_json(scene, result.system, c.i), body_json(scene, result.system, c.j)}},
                   {"count", c.count},
                   {"duration", c.duration},
                   {"max_force", c.max_force},
                   {"max_overlap", c.max_overlap}});
  return out;
}

/// Times that do not exist are null.
json time_json(double seconds) { return std::isfinite(seconds) ? json(seconds) : json(nullptr); }

json summary_json(const ParticlesScene& scene, const ParticlesResult& result) {
  const System3& s = result.system;
  json out = {{"status", result.usable ? "good" : "not usable"},
              {"kind", "particles"},
              {"title", scene.title},
              {"particle_count", s.particles.grains},
              {"time", s.time},
              {"steps", s.step},
              {"step", scene.time.step},
              {"natural_time", time_json(scene.time.natural_time)},
              {"shortest_impact", time_json(scene.time.contact_time)},
              {"step_limited_by", scene.time.limited_by},
              {"kinetic_energy", kinetic_energy(s.particles)},
              {"frames", result.trajectory.time.size()},
              {"particles", particles_json(s)},
              {"walls", walls_json(scene, s)}};
  out["cost"] = {{"loop_passes", s.cost.loop_passes},
                 {"contact_evaluations", s.cost.contact_evaluations},
                 {"rebuilds", s.neighbours.rebuilds},
                 {"seconds", s.cost.seconds}};
  if (result.watched) out["contacts"] = contacts_json(scene, result);
  if (!result.usable) out["reason"] = result.reason;
  return out;
}

std::string people_text(const ParticlesResult& result, const RunContext& context) {
  const System3& s = result.system;
  const std::string end = result.usable ? "" : "NOT USABLE: " + result.reason + "\n";
  return end + fmt::format("{} particles, {} steps to {:.6g} s in {:.2f} s; kinetic energy {:.6g} J\ntrajectory: {}",
                           s.particles.grains, s.step, s.time, s.cost.seconds, kinetic_energy(s.particles),
                           context.path("run.h5"));
}

ParticlesResult run_with_progress(const ParticlesScene& scene, const RunContext& context) {
  Progress progress("particles", static_cast<double>(scene.time.steps), context.quiet());
  ParticlesControl control;
  control.checkpoint = context.path("checkpoint.h5");
  control.resume = context.resume();
  control.say = [&](const std::string& line) { context.say(line); };
  control.progress = [&](std::int64_t step) { progress.set(static_cast<double>(step)); };
  ParticlesResult result = run_particles(scene, control);
  progress.finish();
  return result;
}

}  // namespace

ExitStatus run_particles_scene(const Scene& scene, const CommonOptions& options) {
  const ParticlesScene setup = read_particles_scene(scene);
  const RunContext context(options, "microsim", std::filesystem::path(scene.path()).stem().string());
  const Provenance provenance = context.provenance(scene, context.seed(0));
  const ParticlesResult result = run_with_progress(setup, context);
  save_particles_run(context.path("run.h5"), setup, result, provenance);
  json summary = summary_json(setup, result);
  summary["provenance"] = provenance_json(provenance);
  summary["files"] = {{"trajectory", context.path("run.h5")}};
  context.finish(std::move(summary), people_text(result, context));
  remove_checkpoint(context.path("checkpoint.h5"));
  return result.usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain
