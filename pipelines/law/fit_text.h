// A fitted normal law as `softgrain calibrate` prints it.
#pragma once

#include <string>

#include "calibrate/threshold_fit.h"

namespace softgrain {

/// Not measured: it follows from the law of the other kind of pair.
bool is_by_symmetry(const PairLaw& law);

/// "soft-solid: good", with the reason where it is not.
std::string verdict_text(const PairLaw& law);

/// "F = a D^b + c: a = 103 N [98.2, 107], ..." in newtons for the soft particle that was measured, and the force at the
/// end of the range. Intervals that are not known, and a threshold that does not show, are said to be so. Two lines.
std::string normal_law_text(const FitReport& report, const SoftParticleSpec& spec);

}  // namespace softgrain
