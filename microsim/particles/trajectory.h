// Records frames of a run and the contacts of some of them (common/data/snapshot_frames.h), and what all contacts of a
// system together say.
#pragma once

#include <cstdint>

#include "common/core/limits.h"
#include "common/data/snapshot_frames.h"
#include "common/system.h"

namespace softgrain {

/// Appends the system as it is.
template <int D>
void record_frame(Trajectory& trajectory, const System<D>& system);

/// Appends stress, fabric and inertial number of the last frame, where the cell is periodic along all axes. `contacts`:
/// whether the frame keeps its contacts; others have no such numbers.
template <int D>
void record_tensors(Trajectory& trajectory, const System<D>& system, bool contacts);

/// Appends those of the system as it is. Never changes it.
template <int D>
void record_contacts(FrameContacts& to, std::int64_t frame, const System<D>& system);

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
