// Fits laws of soft particles with several contacts to multi-contact measurements and says how well they predict what
// they have not seen.
#pragma once

#include "common/contact/multi_contact_prediction.h"
#include "common/data/multi_contact_law.h"
#include "common/data/multi_contact_measurements.h"

namespace softgrain {

struct MultiContactFitOptions {
  double discrepancy = 0.05;  ///< what a law may be off besides the noise: share of the force, and a tenth of it of the
                              ///< largest force of the configuration
  int min_packings = 4;
  int replicates = 40;  ///< bootstrap over packings; 0: intervals from the covariance alone
  std::uint64_t seed = 1;
  WantedForm best{};  ///< the form to prefer; empty: the one that predicts fitted loadings best when each is left out
  /// Largest error on held-out loadings and when loadings are left out one by one; above it a law is called inaccurate.
  double largest_error = 0.5;
};

/// All three forms for the packings of `data`, best one named: the one that is asked for, or predicts fitted loadings
/// best when each is left out. Planes fix pressure and coupling; solid spheres, then soft neighbours, their constants w
/// and m at each ratio that was measured. Configurations marked as held out are predicted. Throws InputError when there
/// is no configuration with one plane, or too few packings.
LawTableEntry fit_multi_contact_laws(const MultiContactMeasurements& data, const MultiContactFitOptions& options = {});

}  // namespace softgrain
