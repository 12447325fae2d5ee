// A picture of the state: where everything is and what every contact carries. One form for all kinds of runs, for
// files, exports and views.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/vec.h"

namespace softgrain {

/// What a state was taken from.
enum class SnapshotKind : std::int64_t { particles, soft_particle, macro, twin, powder, grain_box };

template <>
inline constexpr auto enum_names<SnapshotKind> = enum_name_list<SnapshotKind>({{SnapshotKind::particles, "particles"},
                                                                               {SnapshotKind::soft_particle,
                                                                                "soft-particle"},
                                                                               {SnapshotKind::macro, "macro"},
                                                                               {SnapshotKind::twin, "twin"},
                                                                               {SnapshotKind::powder, "powder"},
                                                                               {SnapshotKind::grain_box, "grain-box"}});

/// What a particle is: a solid grain that is a body by itself, a soft particle taken as one sphere (it acts by a fitted
/// law), or a grain inside a soft particle.
enum class ParticleRole : std::int64_t { solid, soft, inner };

template <>
inline constexpr auto enum_names<ParticleRole> = enum_name_list<ParticleRole>({{ParticleRole::solid, "solid"},
                                                                               {ParticleRole::soft, "soft"},
                                                                               {ParticleRole::inner, "inner"}});

struct SnapshotParticle {
  Vec3 position{};  ///< centre; along periodic axes folded into the cell when lists were made last
  double radius = 0.0;
  Vec3 velocity{};  ///< zero unless Snapshot::has_velocity
  std::int64_t id = 0;
  ParticleRole role = ParticleRole::solid;
  std::int64_t body = 0;  ///< number of the body it belongs to: grains of one soft particle (and its shell) share it
  std::int64_t material = 0;  ///< index into the materials of the run
  Vec3 spin{};                ///< angular velocity, zero unless Snapshot::has_velocity
  /// Mass in units of force time^2/length (kg); NaN: not known, as in files of earlier versions.
  double mass = std::numeric_limits<double>::quiet_NaN();
};

enum class WallShape : std::int64_t { plane, sphere_inside };

template <>
inline constexpr auto enum_names<WallShape> = enum_name_list<WallShape>({{WallShape::plane, "plane"},
                                                                         {WallShape::sphere_inside, "sphere-inside"}});

struct SnapshotWall {
  WallShape shape = WallShape::plane;
  Vec3 point{};            ///< point of the plane, or centre of the sphere
  Vec3 normal{};           ///< unit normal of the plane, into the space of the particles
  double radius = 0.0;     ///< radius of the sphere: a shell, or a container
  std::int64_t body = -1;  ///< the soft particle whose shell it is; -1: none
};

/// What tells states of a series apart.
enum class Moment { time, strain, overlap, frame };

template <>
inline constexpr auto enum_names<Moment> = enum_name_list<Moment>(
    {{Moment::time, "time"}, {Moment::strain, "strain"}, {Moment::overlap, "Delta"}, {Moment::frame, "frame"}});

struct SnapshotContact {
  std::int32_t i = 0;         ///< index into Snapshot::particles
  std::int32_t j = 0;         ///< index into Snapshot::particles; from particles.size() on, walls[j - particles.size()]
  Vec3 from{};                ///< end of its line: the centre of i
  Vec3 to{};                  ///< the centre of j in the image that i touches; of a wall the point of contact
  Vec3 point{};               ///< contact point, beside i
  Vec3 force{};               ///< force on i, the opposite on j
  double normal_force = 0.0;  ///< its part along the normal, pushing positive
  Vec3 shift{};  ///< lattice vector that brings position[j] to the image that i touches; zero inside the cell
};

/// All lengths, times and forces are in the units named here.
struct Snapshot {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  SnapshotKind kind = SnapshotKind::particles;
  std::string series;      ///< states with the same name follow each other: "particles", "shelled-0", ...
  std::string label;       ///< label for readers: "shelled twin, sample 0, strain 0.15"
  std::int64_t frame = 0;  ///< number of the recorded point within its series, not always consecutive
  double time = kNone;  ///< the one of time, strain and overlap that orders the series is a number; the others are NaN
  double strain = kNone;   ///< strain of macro runs and grain boxes (along the loaded axis), compression positive
  double overlap = kNone;  ///< Delta = hn/Rs of a soft particle

  std::string length_unit = "m";  ///< "a" of powders
  std::string force_unit = "N";   ///< "F0" of powders, "P a" without cohesion
  std::string time_unit = "s";    ///< "T0" of powders

  int dimension = 3;          ///< 2: z is zero everywhere, forces are per disk
  bool has_velocity = false;  ///< positions alone of quasi-static runs
  bool has_contacts = false;  ///< false: contacts were not kept for this state (not: there are none)

  std::vector<SnapshotParticle> particles;
  std::vector<SnapshotWall> walls;
  std::vector<SnapshotContact> contacts;  ///< force-carrying, sorted by (i, j)
  std::array<Vec3, 3> cell_edges{};       ///< edge vectors; meaningful along periodic axes
  std::array<bool, 3> periodic{};

  /// The number that orders the series: time, strain or overlap, whichever there is; 0 when none.
  [[nodiscard]] double moment() const;
  /// Its name for files and axes: "time", "strain", "Delta"; "frame" when none.
  [[nodiscard]] Moment moment_name() const;
};

/// Whether recorded point number `point` of `points` is one of `wanted` evenly spread ones, the last among them.
bool is_snapshot(std::int64_t point, std::int64_t points, std::int64_t wanted);

}  // namespace softgrain
