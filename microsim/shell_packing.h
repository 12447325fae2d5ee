// A packing of power-law grains in a spherical shell: random trials, largest first, then growth to contact [SP 1.2].
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/random.h"
#include "common/data/measurements.h"

namespace softgrain {

/// The grains placed so far in a shell of radius 1, found by place. Grains must come largest first.
class PlacedGrains {
 public:
  explicit PlacedGrains(ShellPacking& packing)
      : packing_(packing), log_lists_(static_cast<std::size_t>(kCells * kCells * kCells)) {}

  void add(const Vec3& x, double r);

  /// Whether a grain of radius r, no larger than any so far, fits in at x.
  [[nodiscard]] bool has_room(const Vec3& x, double r) const;

  /// Upper bound, for all that is still to come, of the radius that fits in at x; exact where it is below the last
  /// radius.
  [[nodiscard]] double clearance(const Vec3& x) const;

 private:
  static constexpr int kCells = 24;
  static int cell(double x);
  static std::size_t index(int a, int b, int c) { return static_cast<std::size_t>((a * kCells + b) * kCells + c); }
  [[nodiscard]] const std::vector<std::int32_t>& near(const Vec3& x) const {
    return log_lists_[index(cell(x[0]), cell(x[1]), cell(x[2]))];
  }

  ShellPacking& packing_;
  std::vector<std::vector<std::int32_t>>
      log_lists_;  ///< per voxel: grains that a later grain centred in it may overlap
};

/// The published way: up to `trials` random points in the shell, the first with room is taken.
std::optional<Vec3> place_by_trials(const PlacedGrains& grains, double r, std::int64_t trials, RandomStream& random);

/// Places grains and fails by the same law as place_by_trials(), without the trials that must fail. Cubes cover every
/// point where a grain may still fit in. A trial hits them with probability p = their volume over that of the shell, so
/// the number of trials up to the next hit is geometric: it is drawn, and then a point in the cubes. A cube whose point
/// has no room is discarded until the radius falls below what its clearance allows, or cut into eight.
class VoidPlacement {
 public:
  explicit VoidPlacement(double smallest_radius);

  /// Radii must not grow from call to call.
  std::optional<Vec3> place(const PlacedGrains& grains, double r, std::int64_t trials, RandomStream& random);

 private:
  struct Cube {
    Vec3 low{};
    double key = 0.0;  ///< no grain larger than this can have its centre in the cube
    int level = 0;     ///< edge 2 / 2^level
  };
  static double edge(int level);

  void offer(const PlacedGrains& grains, Cube cube, double r);
  void split(const PlacedGrains& grains, const Cube& cube, double r);
  void wait(const Cube& cube);
  void wake(const PlacedGrains& grains, double r);
  void dismiss(const PlacedGrains& grains, int level, std::size_t at, double r);
  [[nodiscard]] double volume(int level) const;

  double smallest_radius_;
  std::vector<std::vector<Cube>> open_;  ///< cubes that may have room, by level
  std::vector<Cube> waiting_;            ///< heap, largest key first
};

/// Generates packing number `index` of the run with this seed. Dimensionless: the same for every Rs and E.
/// Throws InputError when no grain could be placed.
ShellPacking generate_shell_packing(const SoftParticleSpec& spec, std::uint64_t seed, std::uint64_t index);

/// One after the other, in their order, grows until it touches its nearest neighbour or the shell.
void grow_to_contact(ShellPacking& packing);

/// What is reported of a packing; radii in metres for the spec's Rs.
PackingInfo describe(const ShellPacking& packing, const SoftParticleSpec& spec);

}  // namespace softgrain
