// Recorded frames of a run, the contacts of some of them for pictures, and what all contacts of a system together say.
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/limits.h"
#include "common/data/snapshot.h"
#include "common/io/hdf5_file.h"
#include "common/system.h"

namespace softgrain {

/// One entry, or one block of 3 numbers per body, per frame; frames follow each other. Disks have z = 0 and spin about
/// z.
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

/// Appends the system as it is.
template <int D>
void record_frame(Trajectory& trajectory, const System<D>& system);

/// Appends stress, fabric and inertial number of the last frame, where the cell is periodic along all axes. `contacts`:
/// whether the frame keeps its contacts; others have no such numbers.
template <int D>
void record_tensors(Trajectory& trajectory, const System<D>& system, bool contacts);

/// Data sets with units: time [frames], position [frames, particles, 3], ...
void write_trajectory(const h5::Group& group, const Trajectory& trajectory);

/// Throws IoError.
Trajectory read_trajectory(const h5::Group& group);

// The contacts of some recorded frames of a run, for pictures, and what all contacts of a system together say.

/// Contacts of frame frame[k] are the next count[k] of `contacts`.
struct FrameContacts {
  std::vector<std::int64_t> frame;  ///< number of the frame in the trajectory, ascending
  std::vector<std::int64_t> count;
  std::vector<SnapshotContact> contacts;
};

/// Appends those of the system as it is. Never changes it.
template <int D>
void record_contacts(FrameContacts& to, std::int64_t frame, const System<D>& system);

/// Data sets frame, count and those of write_snapshot_contacts (snapshot_io.h); a segment list for the largest count.
void write_frame_contacts(const h5::Group& group, const FrameContacts& contacts);

/// `particles` and `bodies` (with walls) bound what contacts may name. Throws IoError.
FrameContacts read_frame_contacts(const h5::Group& group, std::size_t particles, std::size_t bodies);

/// How many frames keep their contacts unless the scene says: fewer of large systems, so that they take about as much
/// room as 200,000 grains do.
std::int64_t default_snapshots(std::int64_t grains);

/// Sums over the contacts that carry a force, in the state as it is (positions, velocities and springs after the last
/// step).
template <int D>
struct ContactTotals {
  std::int64_t contacts = 0;
  double coordination_number = 0.0;  ///< contacts per grain: those between grains count for both, distant pairs too
  bool has_stress = false;           ///< the cell is periodic along all axes, so that there is a volume
  Matrix<D> stress{};                ///< see contact_totals [Pa; of disks N/m]
  double pressure = 0.0;             ///< -tr(stress)/D
  double asymmetry = 0.0;            ///< norm of the antisymmetric part of the stress over that of all
  Matrix<D> fabric{};                ///< mean of n (x) n over contacts between grains; zero without any
  double rate = 0.0;                 ///< shear rate of the cell [1/s]
  double inertial_number = kNaN;     ///< of a cell that is sheared under pressure
};

/// Stress of the contact forces, Love-Weber: sigma = -(1/V) sum_c b_c (x) f_c with b = x_i - x_j (nearest image) and f
/// the whole force of the contact on i, normal (elastic and damping) and tangential; tension is positive. The part of
/// the fluctuating velocities (kinetic stress) is not in it. No loop pass is counted, nothing is changed.
template <int D>
ContactTotals<D> contact_totals(const System<D>& system);

}  // namespace softgrain
