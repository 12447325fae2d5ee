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

struct CrowdSetup {
  SoftParticleSpec spec;
  CrowdOptions options;
  std::int64_t packings_min = 8;
  std::int64_t packings_max = 24;
  double target = 0.04;      ///< wanted standard error of the mean force at the largest overlap, as a share of it
  std::int64_t points = 12;  ///< recorded per stage
  std::vector<CrowdConfiguration> configurations;
  std::uint64_t seed = 1;
  std::map<std::string, std::int64_t> packings{};  ///< of configurations that say how many, by name

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
    return most;
  }
};

/// Reads `seed`, [material], [packing], [crowd] and every [[configuration]]. Throws BadInput.
CrowdSetup read_crowd_setup(const SceneTable& root);

}  // namespace softgrain
