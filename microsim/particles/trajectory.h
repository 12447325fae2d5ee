// Recorded frames of a run.
#pragma once

#include <vector>

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
};

/// Appends the system as it is.
template <int D>
void record_frame(Trajectory& trajectory, const System<D>& system);

/// Data sets with units: time [frames], position [frames, particles, 3], ...
void write_trajectory(const h5::Group& group, const Trajectory& trajectory);

/// Throws IoError.
Trajectory read_trajectory(const h5::Group& group);

}  // namespace softgrain
