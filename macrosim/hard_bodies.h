// All bodies of a macro packing as hard grains in their box: what preparations move and press.
#pragma once

#include "common/core/cost.h"
#include "common/dynamics/contact_watch.h"
#include "macrosim/box.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

struct HardBodies {
  System3 system;
  Box box;

  explicit HardBodies(const MacroSpec& spec, const MacroPacking& packing, double friction = 0.0,
                      double restitution = 1.0);

  static AnyLaw law(const MacroSpec& spec, double friction, double restitution);

  [[nodiscard]] Vec3 size() const { return box_high(system, box) - box_low(system, box); }
  [[nodiscard]] double pressure();        ///< mean stress of all axes in the last pass [Pa]
  [[nodiscard]] double fraction() const;  ///< share of the box that bodies fill
  /// Copies the places of bodies, the springs and the box to the packing, and adds the cost.
  void take_over(MacroPacking& packing) const;

 private:
  [[nodiscard]] std::vector<BodySpring> springs() const;

  bool frictional_ = false;
  ContactVirial<3> virial_;
  Stopwatch watch_;
};

}  // namespace softgrain
