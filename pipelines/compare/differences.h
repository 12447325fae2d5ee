// What two runs that are set side by side do not have in common.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/measurements.h"

namespace softgrain {

struct Differences {
  std::vector<std::string> said;       ///< to be known: what a comparison may be about, or what drops out of it
  std::vector<std::string> obstacles;  ///< an error norm of such runs means nothing

  void add(const Differences& more);  ///< what is not there already
};

/// Of two curves, "what: candidate against reference". Bodies, radii, materials, tests are obstacles; a law with
/// another law is what is compared, a law with a twin that starts elsewhere is not. Where a file does not say
/// it all, that is said.
Differences differences(const MacroCurve& candidate, const MacroCurve& reference);

/// Of two kinds of soft particle: E and Rs drop out of dimensionless forces, nu, mu and the way of packing do not.
Differences differences(const SoftParticleSpec& candidate, const SoftParticleSpec& reference);

}  // namespace softgrain
