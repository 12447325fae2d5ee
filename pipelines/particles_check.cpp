#include "pipelines/particles_check.h"

#include <fmt/format.h>

#include <omp.h>

#include <algorithm>
#include <chrono>

#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "microsim/particles/contact_totals.h"
#include "microsim/particles/scene_memory.h"

namespace softgrain {

namespace {

/// Steps timed to tell the rest; few, as a check should take a moment.
constexpr std::int64_t kTrialSteps = 5;

/// Wall time per step, with one pass before it that makes the neighbour list. Moves the system.
double step_seconds(System3& s, const SceneTime& time) {
  VelocityVerlet<3> integrator(time.step);
  integrator.initialise(s);
  const auto trials = std::min(kTrialSteps, time.steps);
  const auto start = std::chrono::steady_clock::now();
  for (std::int64_t k = 0; k < trials; ++k) integrator.step(s);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / static_cast<double>(trials);
}

}  // namespace

void check_particles(const ParticlesScene& scene, nlohmann::json& facts, std::string& lines) {
  const auto add = [&](const char* key, const nlohmann::json& value, const std::string& line) {
    facts[key] = value;
    lines += "  " + line + "\n";
  };
  System3 s = scene.system;
  const StepLimit limit = step_limit(s);
  add("bodies", s.particles.size(), fmt::format("{} grains, {} walls", s.particles.grains, scene.wall_name.size()));
  add("time_step", scene.time.step,
      fmt::format("step {:.4g} s to {:.4g} s: {} steps", scene.time.step, scene.time.end, scene.time.steps));
  if (limit.body >= 0)
    add("step_limit", limit.natural_time,
        fmt::format("sqrt(m/k) of the fastest contact: {:.4g} s (grain {})", limit.natural_time, limit.body));
  const double seconds = step_seconds(s, scene.time) * static_cast<double>(scene.time.steps);
  const ContactTotals totals = contact_totals(s);
  add("contacts", totals.contacts,
      fmt::format("contacts at the start: {}, {:.2f} per grain; {} pairs listed", totals.contacts,
                  totals.coordination_number, s.contacts.size()));
  const double memory = estimated_memory(s.particles.grains, static_cast<double>(s.contacts.size()));
  add("bytes", memory, fmt::format("memory: about {:.1f} MB beside the program's own", memory / 1e6));
  add("seconds", seconds, fmt::format("expected time: about {:.3g} s with {} threads", seconds, omp_get_max_threads()));
}

}  // namespace softgrain
