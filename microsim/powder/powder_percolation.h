// How strong the chains are that span a powder [CP 3.5].
#pragma once

#include <optional>
#include <vector>

#include "microsim/powder/powder_interactions.h"

namespace softgrain {

/// F_perc, the largest threshold at which the pairs with |F| >= F_perc join a disk to its own periodic image, in the
/// units of the sample: along an axis when the image lies any number of periods away along it, whatever the other axis
/// does. Distant pairs count. None when no threshold does.
struct PowderPercolation {
  std::optional<double> x;
  std::optional<double> y;
  std::optional<double> either;  ///< the published reading: through the cell in one direction at least
  std::optional<double> both;    ///< one cluster along x and along y
};

PowderPercolation powder_percolation(const System<2>& system, const std::vector<PowderInteraction>& pairs);

}  // namespace softgrain
