// Larger masses for the quickest bodies, so that a longer time step is stable; everything else keeps its inertia.
#pragma once

#include <vector>

#include "common/system.h"

namespace softgrain {

/// While this object lives every body has at least the mass m = K (dt/fraction)^2, K the sum of the stiffnesses of its
/// contacts (selective mass scaling); moments of inertia go along. The destructor restores the true masses. Constants
/// of the contacts that depend on masses are computed anew both times. Valid for motions that are slow against the
/// raised bodies; grains that touch nothing count with a share of the mean stiffness, so that their first touch is
/// stable.
template <int D>
class ScaledMasses {
 public:
  ScaledMasses(System<D>& system, double dt, double fraction);
  ~ScaledMasses();
  ScaledMasses(const ScaledMasses&) = delete;
  ScaledMasses& operator=(const ScaledMasses&) = delete;

 private:
  System<D>& system_;
  std::vector<double> inverse_mass_;
  std::vector<double> inverse_inertia_;
};

}  // namespace softgrain
