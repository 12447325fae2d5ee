// What all contacts of a system together say about its state.
#pragma once

#include <cstdint>

#include "common/system.h"

namespace softgrain {

/// Sums over the contacts that carry a force, in the state as it is (positions, velocities and springs after the last
/// step).
template <int D>
struct ContactTotals {
  std::int64_t contacts = 0;
  double coordination_number = 0.0;  ///< contacts per grain: those between grains count for both, distant pairs too
  bool has_stress = false;           ///< the cell is periodic along all axes, so that there is a volume
  Matrix<D> stress{};                ///< see contact_totals [Pa; of disks N/m]
  double pressure = 0.0;             ///< -tr(stress)/D
};

/// Stress of the contact forces, Love-Weber: sigma = -(1/V) sum_c b_c (x) f_c with b = x_i - x_j (nearest image) and f
/// the whole force of the contact on i, normal (elastic and damping) and tangential; tension is positive. The part of
/// the fluctuating velocities (kinetic stress) is not in it. No loop pass is counted, nothing is changed.
template <int D>
ContactTotals<D> contact_totals(const System<D>& system);

}  // namespace softgrain
