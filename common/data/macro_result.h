// Stress-strain records of macro runs and of their resolved twins.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/cost.h"
#include "common/io/provenance.h"

namespace softgrain {

/// One macro run of one sample. Stresses are compressive positive [Pa]; strain is from the start of the test.
struct MacroCurve {
  std::string engine;  ///< "law" (soft particles with fitted laws) or "shelled" (resolved twin)
  std::string test;    ///< "oedometric" or "isotropic"
  std::int64_t sample = 0;
  std::int64_t bodies = 0;  ///< solid grains + soft particles
  std::int64_t soft = 0;
  std::int64_t grains = 0;  ///< grains resolved inside soft particles (0 for engine "law")
  double soft_volume_share = 0.0;
  double solid_fraction = 0.0;  ///< of bodies in the box at the start
  std::vector<double> strain;
  std::vector<double> stress_axial;           ///< from wall forces
  std::vector<double> stress_lateral;         ///< from wall forces, mean of both directions
  std::vector<double> stress_axial_contacts;  ///< from the contact sum, a check on the walls
  std::vector<double> coordination;           ///< contacts per body (engine "law": force-carrying)
  std::vector<double> residual;               ///< largest net force over mean contact force
  bool usable = true;
  std::string note;
  Cost cost;
};

/// Writes all curves to an HDF5 file, atomically.
void save_macro(const std::vector<MacroCurve>& curves, const std::string& path,
                const Provenance& provenance = build_provenance());
std::vector<MacroCurve> load_macro(const std::string& path);

}  // namespace softgrain
