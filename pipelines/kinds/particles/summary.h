// The summary of a run of explicit particles, for programs and for people.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "microsim/particles/particles_run.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// The state of a grain at the end [m, m/s, rad/s].
struct GrainState {
  std::int64_t id = 0;
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> spin;
};

void fields(auto&& visit, Of<GrainState> auto& s) {
  visit("id", s.id, Means{"number of the particle in the order of addition", "1"});
  visit("position", s.position, Means{"centre", "m"});
  visit("velocity", s.velocity, Means{"velocity", "m/s"});
  visit("spin", s.spin, Means{"angular velocity", "rad/s"});
}

struct WallState {
  std::string name;
  std::vector<double> position;
  std::vector<double> velocity;
};

void fields(auto&& visit, Of<WallState> auto& s) {
  visit("name", s.name, Means{"name of the wall"});
  visit("position", s.position, Means{"a point of the wall", "m"});
  visit("velocity", s.velocity, Means{"velocity", "m/s"});
}

/// One pair that touched; of grains the id, of walls the name.
struct PairSummary {
  std::array<nlohmann::json, 2> pair;
  std::int64_t count = 0;
  double duration = 0.0;     ///< [s]
  double max_force = 0.0;    ///< [N]
  double max_overlap = 0.0;  ///< [m]
};

void fields(auto&& visit, Of<PairSummary> auto& s) {
  visit("pair", s.pair, Means{"ids of particles, names of walls"});
  visit("count", s.count, Means{"how many times they touched", "1"});
  visit("duration", s.duration, Means{"total duration", "s"});
  visit("max_force", s.max_force, Means{"largest normal force that pushes", "N"});
  visit("max_overlap", s.max_overlap, Means{"largest overlap", "m"});
}

struct ParticlesSummary {
  SummaryHead head;
  std::string reason;
  int dimension = 3;
  std::int64_t particle_count = 0;
  double time = 0.0;
  std::int64_t steps = 0;
  double step = 0.0;              ///< [s]
  double natural_time = kNaN;     ///< [s]
  double shortest_impact = kNaN;  ///< [s]
  std::string step_limited_by;
  double kinetic_energy = 0.0;  ///< [J]
  std::size_t frames = 0;
  std::vector<GrainState> particles;  ///< the first thousand
  std::vector<WallState> walls;
  std::optional<std::vector<PairSummary>> contacts;
  nlohmann::json contact_state;
  nlohmann::json cost;
  nlohmann::json guards;
};

void fields(auto&& visit, Of<ParticlesSummary> auto& s) {
  fields(visit, s.head);
  visit("reason", s.reason, kLeftOut, Means{"why the result is not usable"});
  visit("dimension", s.dimension, Means{"2 or 3", "1"});
  visit("particle_count", s.particle_count, Means{"number of particles", "1"});
  visit("time", s.time, Means{"time reached", "s"});
  visit("steps", s.steps, Means{"number of time steps", "1"});
  visit("step", s.step, Means{"time step", "s"});
  visit("natural_time", s.natural_time, Means{"smallest sqrt(m/k) of bodies and contacts", "s"});
  visit("shortest_impact", s.shortest_impact, Means{"shortest duration of an impact", "s"});
  visit("step_limited_by", s.step_limited_by, Means{"what limits the time step"});
  visit("kinetic_energy", s.kinetic_energy, Means{"kinetic energy at the end", "J"});
  visit("frames", s.frames, Means{"number of recorded states", "1"});
  visit("particles", s.particles, Means{"state of the first thousand particles at the end"});
  visit("walls", s.walls, Means{"state of the walls at the end"});
  visit("contacts", s.contacts, kLeftOut, Means{"pairs that touched, when they were watched"});
  visit("contact_state", s.contact_state,
        Means{"contacts, coordination number, fabric, pressure and stress at the end"});
  visit("cost", s.cost, Means{"passes, evaluations, times and memory"});
  visit("guards", s.guards, Means{"what the guards saw; counts are looks"});
}

/// Number of all particles; what is listed counts in summaries that do not say it.
inline std::int64_t particle_count(const ParticlesSummary& s) {
  return std::max<std::int64_t>(s.particle_count, std::ssize(s.particles));
}

/// Everything but provenance and files: state, contacts, cost. `memory_before`: peak of the process before the scene
/// was read [bytes].
template <int D>
ParticlesSummary summary_of(const ParticlesSceneOf<D>& scene, const ParticlesResultOf<D>& result, double memory_before);

/// A line or two.
template <int D>
std::string particles_text(const ParticlesResultOf<D>& result);

}  // namespace softgrain
