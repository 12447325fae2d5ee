// The states of a run as the 3D view of the page reads them: JSON with arrays in base64 (assets/packing_data.js).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/data/snapshot.h"

namespace softgrain::report {

/// One state, single precision. Particles of periodic cells are folded into the cell, ends of contacts with them.
struct PackingState {
  std::string label;                ///< "Delta = 0.25"
  std::vector<float> spheres;       ///< x, y, z, radius of each grain
  std::vector<std::int32_t> body;   ///< empty: all zero
  std::vector<std::uint8_t> role;   ///< ParticleRole of each grain; empty: all zero (solid)
  std::vector<std::int32_t> ids;    ///< empty: as they are numbered
  std::vector<std::int32_t> pairs;  ///< i, j of each contact; from the number of grains on, j is a wall
  std::vector<float> forces;        ///< normal force of each contact
  std::vector<std::int32_t> bent;   ///< contacts whose line does not end at the centre of grain j: walls, images
  std::vector<float> ends;          ///< x, y, z where their lines end
  // Of all contacts of each grain, where some are left out; else empty.
  std::vector<std::uint16_t> touching;  ///< their number
  std::vector<float> load;              ///< sum of their normal forces
  std::vector<SnapshotWall> walls;
  std::vector<Vec3> cell;  ///< edges, zero along open axes; empty: no cell

  [[nodiscard]] std::size_t grains() const { return spheres.size() / 4; }
  [[nodiscard]] std::size_t contacts() const { return forces.size(); }
  /// Size in the page [byte].
  [[nodiscard]] std::size_t bytes() const;
};

struct PackingSeries {
  std::string name;
  std::string label;  ///< "shelled, sample 0"
  std::string length_unit;
  std::string force_unit;
  std::vector<PackingState> states;
  SnapshotKind kind = SnapshotKind::particles;

  [[nodiscard]] std::size_t bytes() const;
};

PackingState packing_state(const Snapshot& snapshot);

/// All series of a run directory, each with at most `states` evenly spread states, its last among them; states without
/// contacts give way to those with. Soft particles come first, then macro runs, then their twins. Of files above 300 MB
/// only the last states. Throws IoError.
std::vector<PackingSeries> packing_series_of(const std::string& run_directory, std::size_t states);

/// Makes them fit into `budget` bytes: fewer states first, then the weakest contacts of what is still too large, then
/// whole series, the largest first. Says what was left out, one sentence each.
std::vector<std::string> fit_into(std::vector<PackingSeries>& series, std::size_t budget);

/// {"series": [...]} for the page, nothing in it can end a script element.
std::string packing_json(const std::vector<PackingSeries>& series);

std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace softgrain::report
