// What two runs that are set side by side do not have in common.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/measurements.h"

namespace softgrain {

struct Differences {
  std::vector<std::string> said;       ///< remarks: what a comparison may be about, or what drops out of it
  std::vector<std::string> obstacles;  ///< differences that make an error norm of such runs meaningless

  void add(const Differences& more);  ///< adds what is not there already
};

/// Differences of two curves, as "what: candidate against reference". Bodies, radii, materials, tests are obstacles; a
/// law with another law is what is compared, a law with a twin that starts elsewhere is not. Where a file does not say
/// it all, a remark tells it.
Differences differences(const MacroCurve& candidate, const MacroCurve& reference);

/// Differences of two kinds of soft particle. E and Rs drop out of dimensionless forces; nu, mu and the way of packing
/// do not.
Differences differences(const SoftParticleSpec& candidate, const SoftParticleSpec& reference);

}  // namespace softgrain
