// The compact form of states: a series of the same bodies, with each number of all frames in one data set. Runs that
// keep many frames write it (run.h5, powder.h5); states that stand alone are in the form of snapshot_io.h. What a group
// with a series holds:
//   trajectory      the columns of Trajectory, each with its unit
//   frame_contacts  contacts of some of the frames; may be missing
//   bodies          radius, mass, material, and which materials are soft particles; may be missing
//   and, under a name of its own, the state in full that the series ends in (system_io.h): walls, periodic axes
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "common/data/snapshot.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

/// One entry, or one block of 3 numbers per body, per frame; frames follow each other. Disks have z = 0 and spin about
/// z. Units are those of SI; of series that keep no motion, time and lengths alone are kept, in units that the run has.
struct Trajectory {
  std::vector<double> time;                  ///< [s]
  std::vector<double> position;              ///< positions of particles [m]
  std::vector<double> velocity;              ///< [m/s]
  std::vector<double> spin;                  ///< [rad/s]
  std::vector<double> wall_position;         ///< centre of a sphere-inside, point of a plane [m]
  std::vector<double> cell_edges;            ///< row-major 3 x 3 [m]
  std::vector<double> translational_energy;  ///< translational energy of particles [J]
  std::vector<double> rotational_energy;     ///< rotational energy of particles [J]
  std::vector<double> gravitational_energy;  ///< -sum m g.x [J]; zero at the origin
  // Of cells that are periodic along all axes; empty elsewhere, not a number in frames that keep no contacts.
  std::vector<double> stress;           ///< row-major 3 x 3, as contact_totals() [Pa; of disks N/m]
  std::vector<double> fabric;           ///< row-major 3 x 3
  std::vector<double> inertial_number;  ///< of sheared cells under pressure
};

/// What a series is of before its frames are read: units, and whether motion is kept; the default is that of run.h5.
Snapshot moving_frames();

/// Data sets with units: time [frames], position [frames, particles, 3], ...
void write_trajectory(const h5::Group& group, const Trajectory& trajectory, const Snapshot& form = moving_frames());
/// Throws IoError.
Trajectory read_trajectory(const h5::Group& group, const Snapshot& form = moving_frames());
/// These columns alone, as far as they were kept; all others stay empty. Throws IoError.
Trajectory read_columns(const h5::Group& group, std::initializer_list<std::vector<double> Trajectory::*> columns);

/// Contacts of frame frame[k] are the next count[k] of `contacts`.
struct FrameContacts {
  std::vector<std::int64_t> frame;  ///< number of the frame in the trajectory, ascending
  std::vector<std::int64_t> count;
  std::vector<SnapshotContact> contacts;
};

/// Data sets frame, count and those of write_snapshot_contacts (snapshot_io.h); a segment list for the largest count.
void write_frame_contacts(const h5::Group& group, const FrameContacts& contacts);
/// `particles` and `bodies` (with walls) bound what contacts may name. Throws IoError.
FrameContacts read_frame_contacts(const h5::Group& group, std::size_t particles, std::size_t bodies);

/// A series as states.
class SnapshotSeries {
 public:
  /// `bodies`: everything that its frames share; positions and contacts in it do not count. Throws IoError when the
  /// frames are of other bodies.
  SnapshotSeries(Snapshot bodies, Trajectory frames, FrameContacts contacts = {});

  [[nodiscard]] std::size_t size() const { return frames_.time.size(); }
  [[nodiscard]] double time(std::size_t frame) const { return frames_.time[frame]; }
  /// Nothing where a number of its particles was lost.
  [[nodiscard]] std::optional<Snapshot> at(std::size_t frame) const;

 private:
  void add_contacts(Snapshot& snapshot) const;

  Snapshot bodies_;
  Trajectory frames_;
  FrameContacts contacts_;
  std::vector<std::size_t> starts_;  ///< first contact of every frame that has some
};

/// Reads a series whose group has `bodies`, with the full state in its child `state`. `form`: what all frames say of
/// themselves. Throws IoError.
SnapshotSeries read_series(const h5::Group& group, const std::string& state, Snapshot form);

}  // namespace softgrain
