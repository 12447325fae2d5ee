// Tables of a scene that say with which neighbours a soft particle is measured.
#pragma once

#include <cstdint>
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
};

/// Reads `seed`, [material], [packing], [crowd] and every [[configuration]]. Throws BadInput.
CrowdSetup read_crowd_setup(const SceneTable& root);

}  // namespace softgrain
