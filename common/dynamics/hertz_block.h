// The contact loop of spheres under Hertz laws, many contacts at a time. Same arithmetic, operation by operation, as
// the scalar pair loop (pair_loop.h), which stays the reference: both give the same bits.
#pragma once

#include <cstdint>

#include "common/system.h"

namespace softgrain {

/// Whether the vectorised loop serves this section: spheres against spheres under a Hertz law.
bool has_fast_loop(const LawSet& laws, const ContactSection& section);

/// Force and moment of a contact, put down for bodies that another thread owns.
struct alignas(64) ContactLoad {
  double force[3];   ///< on i [N]
  double arm_i;      ///< [m]
  double moment[3];  ///< of a unit arm along the normal [N]; in 2D the first, and [1] is that of rolling [N m]
  double arm_j;      ///< [m]
};

/// Loads that wait to be added to bodies, in list order.
class WaitingLoads {
 public:
  virtual ~WaitingLoads() = default;
  /// Place in the list of the next one; beyond every place when there is none.
  std::int32_t next = 0;
  /// Adds all that stand before place `c`.
  virtual void add_before(std::int32_t c) = 0;
};

/// Adds the forces and torques of some pairs of a section to their bodies, in the order of the range, and treats their
/// history as asked. Pairs that do not touch lose theirs. With `loads` the bodies are left alone: the load of pair k of
/// the range goes to loads[k], and touches[k] says whether it touches. Loads that wait are added in between, in list
/// order. Requires has_fast_loop.
template <int D>
void hertz_loop(System<D>& system, const ContactSection& section, double dt, const PairRange& range, History history,
                ContactLoad* loads = nullptr, std::uint8_t* touches = nullptr, WaitingLoads* waiting = nullptr);

}  // namespace softgrain
