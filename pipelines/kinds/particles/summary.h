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
  visit("id", s.id);
  visit("position", s.position);
  visit("velocity", s.velocity);
  visit("spin", s.spin);
}

struct WallState {
  std::string name;
  std::vector<double> position;
  std::vector<double> velocity;
};

void fields(auto&& visit, Of<WallState> auto& s) {
  visit("name", s.name);
  visit("position", s.position);
  visit("velocity", s.velocity);
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
  visit("pair", s.pair);
  visit("count", s.count);
  visit("duration", s.duration);
  visit("max_force", s.max_force);
  visit("max_overlap", s.max_overlap);
}

struct ParticlesSummary {
  SummaryHead head;
  std::string reason;  ///< why it is not usable
  int dimension = 3;
  std::int64_t particle_count = 0;
  double time = 0.0;  ///< reached [s]
  std::int64_t steps = 0;
  double step = 0.0;              ///< [s]
  double natural_time = kNaN;     ///< [s]
  double shortest_impact = kNaN;  ///< [s]
  std::string step_limited_by;
  double kinetic_energy = 0.0;  ///< [J]
  std::size_t frames = 0;
  std::vector<GrainState> particles;  ///< the first thousand
  std::vector<WallState> walls;
  std::optional<std::vector<PairSummary>> contacts;  ///< when they were watched
  nlohmann::json contact_state;                      ///< contacts, coordination_number, pressure, stress at the end
  nlohmann::json cost;
  nlohmann::json guards;
};

void fields(auto&& visit, Of<ParticlesSummary> auto& s) {
  fields(visit, s.head);
  visit("reason", s.reason, kLeftOut);
  visit("dimension", s.dimension);
  visit("particle_count", s.particle_count);
  visit("time", s.time);
  visit("steps", s.steps);
  visit("step", s.step);
  visit("natural_time", s.natural_time);
  visit("shortest_impact", s.shortest_impact);
  visit("step_limited_by", s.step_limited_by);
  visit("kinetic_energy", s.kinetic_energy);
  visit("frames", s.frames);
  visit("particles", s.particles);
  visit("walls", s.walls);
  visit("contacts", s.contacts, kLeftOut);
  visit("contact_state", s.contact_state);
  visit("cost", s.cost);
  visit("guards", s.guards);
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
