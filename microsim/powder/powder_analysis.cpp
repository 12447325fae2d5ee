#include "microsim/powder/powder_analysis.h"

#include <cmath>
#include <numbers>

namespace softgrain {

PowderAnalysis analyse_powder(const System<2>& system, const PowderSpec& spec, double pressure, bool rigidity) {
  PowderAnalysis out;
  out.zero = kPowderZeroForce;
  out.contacts = powder_contacts(system, out.zero, spec.cohesive);
  out.pairs = powder_interactions(system, out.zero);
  out.forces = powder_forces(out.pairs, out.zero);
  out.percolation = powder_percolation(system, out.pairs);
  if (rigidity) out.rigidity = powder_rigidity(system, out.pairs, spec.cohesive);
  out.moduli = powder_moduli(system, out.pairs);
  out.solid_fraction_3d = 4.0 / (3.0 * std::sqrt(std::numbers::pi)) * std::pow(powder_fraction(system), 1.5);
  if (pressure > 0.0 && !out.pairs.empty()) out.rumpf_ratio = out.contacts.rumpf_pressure / pressure;
  return out;
}

}  // namespace softgrain
