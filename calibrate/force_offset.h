// A constant force that an experiment reads without contact: a load cell that was not set to zero, the weight of a
// plate. It is seen in readings before touch and below the threshold, where a soft particle bears nothing.
#pragma once

#include <string>
#include <vector>

#include "common/data/force_curves.h"

namespace softgrain {

struct ForceOffset {
  std::size_t sample = 0;    ///< index
  double force = 0.0;        ///< mean of the readings without force [N]
  double error = 0.0;        ///< its standard error [N]
  double below = 0.0;        ///< Delta that they lie below
  std::size_t readings = 0;  ///< how many there are
  bool determined = true;    ///< false: neither they nor the shape of the curve tell
};

/// The offsets of samples that have one: the mean over at least three readings without force differs from zero by more
/// than Student's t of 99.9 %; or, with fewer such readings, a law with an offset fits far better than one without.
/// Then it is determined where all thresholds that fit give the same offset to 1 % of the largest force.
std::vector<ForceOffset> force_offsets(const ForceCurves& curves);

/// Subtracts the determined ones from all forces of their samples, with a remark for each, and says of the others that
/// they are not determined. Returns all.
std::vector<ForceOffset> subtract_offsets(ForceCurves& curves);

}  // namespace softgrain
