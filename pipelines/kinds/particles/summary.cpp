#include "pipelines/kinds/particles/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/text.h"
#include "common/dynamics/verlet.h"
#include "microsim/particles/trajectory.h"

namespace softgrain {

namespace {

using nlohmann::json;

constexpr Slot kMostListed = 1000;

template <int D>
std::vector<double> list_of(const Vec<D>& v) {
  return {v.v.begin(), v.v.end()};
}

template <int D>
std::vector<GrainState> grains_of(const System<D>& s) {
  std::vector<GrainState> out;
  for (Slot i = 0; i < std::min(s.particles.grains, kMostListed); ++i) {
    const auto u = static_cast<std::size_t>(i);
    out.push_back(
        {i, list_of(s.particles.sphere[u].x), list_of(s.particles.velocity[u]), list_of(s.particles.spin[u])});
  }
  return out;
}

template <int D>
std::vector<WallState> walls_of(const ParticlesSceneOf<D>& scene, const System<D>& s) {
  std::vector<WallState> out;
  for (std::size_t w = 0; w < scene.wall_name.size(); ++w) {
    const std::size_t u = static_cast<std::size_t>(s.particles.grains) + w;
    out.push_back({scene.wall_name[w], list_of(s.particles.sphere[u].x), list_of(s.particles.velocity[u])});
  }
  return out;
}

/// Ids of particles, names of walls.
template <int D>
json body_json(const ParticlesSceneOf<D>& scene, const System<D>& s, Slot slot) {
  if (slot < s.particles.grains) return slot;
  return scene.wall_name[static_cast<std::size_t>(slot - s.particles.grains)];
}

template <int D>
std::vector<PairSummary> pairs_of(const ParticlesSceneOf<D>& scene, const ParticlesResultOf<D>& result) {
  std::vector<PairSummary> out;
  for (const ContactHistory& c : result.contacts)
    out.push_back({{body_json(scene, result.system, c.i), body_json(scene, result.system, c.j)},
                   c.count,
                   c.duration,
                   c.max_force,
                   c.max_overlap});
  return out;
}

json record_json(const GuardRecord& r, const GuardRule& rule, double limit) {
  json out = {{"action", to_string(rule.action)},
              {"limit", std::isfinite(limit) ? json(limit) : json(nullptr)},
              {"worst", r.worst},
              {"count", r.count}};
  if (r.count > 0) out["first_time"] = r.first_time;
  return out;
}

/// What the guards saw; counts are looks, not events.
template <int D>
json guards_json(const GuardSpec& spec, const GuardReport& g, const System<D>& s) {
  json out = {{"looks", g.looks},
              {"steps_between_looks", g.every},
              {"overlap", record_json(g.overlap, spec.overlap, spec.overlap.limit)},
              {"energy", record_json(g.energy, spec.energy, spec.energy.limit)},
              {"escape", record_json(g.escape, spec.escape, spec.escape.limit)},
              {"wall", record_json(g.wall_travel, spec.wall_travel, g.wall_travel_limit)},
              {"hasty_lists", s.neighbours.short_lived}};
  out["energy"]["watched"] = g.energy_unwatched.empty();
  if (!g.energy_unwatched.empty()) out["energy"]["unwatched_because"] = g.energy_unwatched;
  if (g.laws.evaluations > 0)
    out["law_range"] = {{"asked", g.laws.evaluations},
                        {"beyond", g.laws.beyond},
                        {"clamped", g.laws.clamped},
                        {"refused", g.laws.rejected},
                        {"largest_over_end", g.laws.max_range_ratio}};
  return out;
}

/// What was counted, in words.
template <int D>
std::vector<std::string> guard_remarks(const GuardSpec& spec, const GuardReport& g, const System<D>& s) {
  std::vector<std::string> out;
  const auto counted = [&](const GuardRecord& r, double limit, const char* what) {
    if (r.count > 0)
      out.push_back(fmt::format("{} above the limit of {:.3g} at {} of {} checks (first at {:.4g} s, largest {:.3g})",
                                what, limit, r.count, g.looks, r.first_time, r.worst));
  };
  counted(g.overlap, spec.overlap.limit, "overlap over the smaller radius");
  counted(g.energy, spec.energy.limit, "growth of energy in a scene that nothing drives");
  counted(g.escape, spec.escape.limit, "grains outside");
  counted(g.wall_travel, g.wall_travel_limit, "travel of a wall that its load moves [m]");
  if (s.neighbours.short_lived > 0)
    out.push_back(fmt::format("{} of {} neighbour lists lasted one step only: bodies move far in a step",
                              s.neighbours.short_lived, s.neighbours.rebuilds));
  const std::string laws = law_use_text(g.laws);
  if (!laws.empty()) out.push_back(laws);
  return out;
}

/// The state of all contacts at the end; see ContactTotals.
template <int D>
json rows_json(const Matrix<D>& tensor) {
  json out = json::array();
  for (const Vec<D>& row : tensor.row) out.push_back(row.v);
  return out;
}

template <int D>
json contact_state_json(const ContactTotals<D>& totals) {
  json out = {{"contacts", totals.contacts}, {"coordination_number", totals.coordination_number}};
  if (totals.contacts > 0) out["fabric"] = rows_json(totals.fabric);
  if (!totals.has_stress) return out;
  out["pressure"] = totals.pressure;
  out["stress"] = rows_json(totals.stress);
  out["stress_asymmetry"] = totals.asymmetry;
  if (std::isfinite(totals.inertial_number)) out["inertial_number"] = totals.inertial_number;
  return out;
}

json part_json(const LoopPart& part) {
  return {{"steps", part.steps},
          {"seconds", part.seconds},
          {"cpu_seconds", part.cpu_seconds},
          {"contact_evaluations", part.contact_evaluations},
          {"rebuilds", part.rebuilds}};
}

/// Speed counts the contacts at the end, as other programs can be asked for them too.
template <int D>
json measured_json(const LoopPart& part, const System<D>& s, const ContactTotals<D>& totals) {
  json out = part_json(part);
  const auto steps = static_cast<double>(part.steps);
  if (!(part.seconds > 0.0) || part.steps == 0) return out;
  out["particle_steps_per_second"] = steps * static_cast<double>(s.particles.grains) / part.seconds;
  if (totals.contacts > 0) out["ns_per_contact"] = 1e9 * part.seconds / (steps * static_cast<double>(totals.contacts));
  return out;
}

template <int D>
json cost_json(const ParticlesSceneOf<D>& scene, const ParticlesResultOf<D>& result, const ContactTotals<D>& totals,
               double memory_before) {
  const System<D>& s = result.system;
  json out = {{"loop_passes", s.cost.loop_passes},
              {"contact_evaluations", s.cost.contact_evaluations},
              {"rebuilds", s.neighbours.rebuilds},
              {"listed_pairs", s.contacts.size()},
              {"seconds", s.cost.seconds},
              {"peak_memory", result.peak_memory},
              {"memory_before_scene", memory_before},
              {"measured", measured_json(result.measured, s, totals)}};
  if (scene.time.warm_up_steps > 0) out["warm_up"] = part_json(result.warm_up);
  return out;
}

}  // namespace

template <int D>
ParticlesSummary summary_of(const ParticlesSceneOf<D>& scene, const ParticlesResultOf<D>& result,
                            double memory_before) {
  const System<D>& s = result.system;
  const ContactTotals<D> totals = contact_totals(s);
  ParticlesSummary out{.head = {RunStatus::good, scene.title, guard_remarks(scene.guards, result.guards, s), {}},
                       .reason = result.reason,
                       .dimension = D,
                       .particle_count = s.particles.grains,
                       .time = s.time,
                       .steps = s.step,
                       .step = scene.time.step,
                       .natural_time = scene.time.natural_time,
                       .shortest_impact = scene.time.contact_time,
                       .step_limited_by = scene.time.limited_by,
                       .kinetic_energy = kinetic_energy(s.particles),
                       .frames = result.trajectory.time.size(),
                       .particles = grains_of(s),
                       .walls = walls_of(scene, s),
                       .contacts = {},
                       .contact_state = contact_state_json(totals),
                       .cost = cost_json(scene, result, totals, memory_before),
                       .guards = guards_json(scene.guards, result.guards, s)};
  if (result.watched) out.contacts = pairs_of(scene, result);
  out.head.remarks.insert(out.head.remarks.end(), scene.remarks.begin(), scene.remarks.end());
  if (!result.usable) out.head.mark_unusable(result.reason);
  return out;
}

template <int D>
std::string particles_text(const ParticlesResultOf<D>& result) {
  const System<D>& s = result.system;
  return fmt::format("{}, {} to {:.6g} s in {:.2f} s; kinetic energy {:.6g} J", counted(s.particles.grains, "particle"),
                     counted(s.step, "step"), s.time, s.cost.seconds, kinetic_energy(s.particles));
}

template ParticlesSummary summary_of<2>(const ParticlesSceneOf<2>&, const ParticlesResultOf<2>&, double);
template ParticlesSummary summary_of<3>(const ParticlesSceneOf<3>&, const ParticlesResultOf<3>&, double);
template std::string particles_text<2>(const ParticlesResultOf<2>&);
template std::string particles_text<3>(const ParticlesResultOf<3>&);

}  // namespace softgrain
