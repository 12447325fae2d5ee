// Tables of a scene that say with which neighbours a soft particle is measured.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/data/crowd_measurements.h"
#include "common/io/scene.h"
#include "microsim/crowd_experiment.h"

namespace softgrain {

/// Packings that `law plan` asks for.
struct PlannedPackings {
  std::string configuration;
  double depth = 1.0;         ///< below 1: pressed in to this share of its overlaps and no further
  std::int64_t packings = 0;  ///< that come so deep, those included that are measured anyway
};

struct CrowdSetup {
  SoftParticleSpec spec;
  CrowdOptions options;
  std::int64_t packings_min = 8;
  std::int64_t packings_max = 24;
  double target = 0.04;           ///< wanted standard error of the mean force at the largest overlap, as a share of it
  std::int64_t points = 12;       ///< recorded per stage
  std::int64_t orientations = 1;  ///< of every packing
  std::vector<CrowdConfiguration> configurations;
  std::uint64_t seed = 1;
  std::map<std::string, std::int64_t> packings{};  ///< of configurations that say how many, by name
  std::vector<PlannedPackings> plan{};             ///< on top of all others

  [[nodiscard]] std::int64_t least_packings(const CrowdConfiguration& c) const {
    const auto own = packings.find(c.name);
    return own != packings.end() ? own->second : packings_min;
  }
  [[nodiscard]] std::int64_t most_packings(const CrowdConfiguration& c) const {
    const auto own = packings.find(c.name);
    return own != packings.end() ? own->second : packings_max;
  }
  /// Different packings that are made for it.
  [[nodiscard]] std::int64_t pool() const {
    std::int64_t most = packings_max;
    for (const auto& [name, count] : packings) most = std::max(most, count);
    for (const PlannedPackings& p : plan) most = std::max(most, p.packings);
    return most;
  }
};

/// Reads `seed`, [material], [packing], [crowd] and every [[configuration]]. Throws BadInput.
CrowdSetup read_crowd_setup(const SceneTable& root);

/// Reads every [[plan]], of configurations of the setup. Throws BadInput.
void read_plan(const SceneTable& root, CrowdSetup& setup);

/// The way of a configuration no further than `depth` of its first stage; all of it where that is 1.
CrowdConfiguration cut_short(const CrowdConfiguration& configuration, double depth);

/// Whether it can be: its first stage presses the neighbours in, and does not slide.
bool may_be_cut(const CrowdConfiguration& configuration);

}  // namespace softgrain
