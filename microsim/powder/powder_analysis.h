// Everything that is measured on a powder at rest [CP 3.5].
#pragma once

#include <optional>
#include <vector>

#include "microsim/powder/powder_contacts.h"
#include "microsim/powder/powder_interactions.h"
#include "microsim/powder/powder_rigidity.h"
#include "microsim/powder/powder_start.h"

namespace softgrain {

/// How strong the chains are that span a powder: F_perc, the largest threshold at which the pairs with |F| >= F_perc
/// join a disk to its own periodic image, in the units of the sample: along an axis when the image lies any number of
/// periods away along it, whatever the other axis does. Distant pairs count. None when no threshold does.
struct PowderPercolation {
  std::optional<double> x;
  std::optional<double> y;
  std::optional<double> either;  ///< the published reading: through the cell in one direction at least
  std::optional<double> both;    ///< one cluster along x and along y
};

PowderPercolation powder_percolation(const System<2>& system, const std::vector<PowderInteraction>& pairs);

/// Results for one state, in the units of the sample. What is undefined is absent.
struct PowderAnalysis {
  double zero = 0.0;  ///< contacts with |F| below it count as unstressed
  PowderContacts contacts;
  std::vector<PowderInteraction> pairs;
  PowderForces forces;
  PowderPercolation percolation;
  std::optional<PowderRigidity> rigidity;  ///< when asked for
  std::optional<PowderModuli> moduli;
  /// Solid fraction of spheres that look the same: 4/(3 sqrt(pi)) Phi^(3/2) = 0.752 Phi^(3/2).
  double solid_fraction_3d = 0.0;
  std::optional<double> rumpf_ratio;  ///< Rumpf's pressure, z Phi N d/(pi d^2) of means, over the one imposed, P > 0
};

/// `pressure`: imposed on the state. Changes nothing in the system.
PowderAnalysis analyse_powder(const System<2>& system, const PowderSpec& spec, double pressure, bool rigidity);

}  // namespace softgrain
