// Tables of a scene that say with which neighbours a soft particle is measured.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/data/multi_contact_measurements.h"
#include "common/io/scene.h"
#include "microsim/multi_contact_experiment.h"

namespace softgrain {

/// Packings that `law plan` asks for.
struct PlannedPackings {
  std::string configuration;
  double depth = 1.0;         ///< below 1: pressed in to this share of its overlaps and no further
  std::int64_t packings = 0;  ///< packings that reach this depth, including those that are measured anyway
};

struct MultiContactSetup {
  SoftParticleSpec spec;
  MultiContactOptions options;
  std::int64_t packings_min = 8;
  std::int64_t packings_max = 24;
  double target = 0.04;           ///< wanted standard error of the mean force at the largest overlap, as a share of it
  std::int64_t points = 12;       ///< recorded per stage
  std::int64_t orientations = 1;  ///< orientations of every packing
  std::vector<MultiContactConfiguration> configurations;
  std::uint64_t seed = 1;
  std::map<std::string, std::int64_t> packings{};  ///< packings of configurations that give their own number, by name
  std::vector<PlannedPackings> plan{};             ///< packings of a plan, on top of all others

  [[nodiscard]] std::int64_t least_packings(const MultiContactConfiguration& c) const {
    const auto own = packings.find(c.name);
    return own != packings.end() ? own->second : packings_min;
  }
  [[nodiscard]] std::int64_t most_packings(const MultiContactConfiguration& c) const {
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

/// Reads `seed`, [material], [packing], [multi_contact] and every [[configuration]]. Throws InputError.
MultiContactSetup read_multi_contact_setup(const SceneTable& root);

/// For SceneKind::explored_from: a configuration with the keys that no other arrangement is asked for.
inline constexpr const char* kExploredConfiguration =
    "[[configuration]]\narrangement = \"scattered\"\npartner = \"solid\"\n";

/// Reads every [[plan]], of configurations of the setup. Throws InputError.
void read_plan(const SceneTable& root, MultiContactSetup& setup);

/// The way of a configuration no further than `depth` of its first stage; all of it where that is 1.
MultiContactConfiguration cut_short(const MultiContactConfiguration& configuration, double depth);

/// Whether it can be: its first stage presses the neighbours in, and does not slide.
bool may_be_cut(const MultiContactConfiguration& configuration);

}  // namespace softgrain
