// How bodies are pressed into touch, by our own engine and in LAMMPS: bodies and box relax together under a pressure
// that begins high, falls whenever all is roughly at rest, and ends at the one asked for.
#pragma once

#include "common/dynamics/damped_relaxation.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// Tolerance of forces and stress before the last pressure, and how the pressure falls.
constexpr double kLoosePressing = 0.1;
constexpr double kPressureFall = 0.7;

/// Relative tolerance of the stress on the box. `last`: under the pressure asked for.
inline double pressing_stress_tolerance(const MacroSpec& spec, bool last) {
  return last ? spec.protocol.tolerance / 3.0 : kLoosePressing;
}

/// Relaxation of so many bodies of this mean radius [m] in a box whose faces bear `load` [N], its pressure times the
/// area of one.
DampedOptions pressing_options(const MacroSpec& spec, bool last, double load, double bodies, double mean_radius);

}  // namespace softgrain
