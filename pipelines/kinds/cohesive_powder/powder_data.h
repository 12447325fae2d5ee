// What powder.h5 holds: final packings with their contacts, courses, snapshots, scattered intensity.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/scattering_fit.h"
#include "common/data/scattering_curve.h"
#include "common/dynamics/force_pass.h"
#include "microsim/powder/powder_assembly.h"
#include "microsim/powder/powder_state_io.h"

namespace softgrain {

/// One row of the course of an assembly.
struct PowderMoment {
  double time = 0.0;  ///< [T0]
  double fraction = 0.0;
  double coordination = 0.0;
  double kinetic = 0.0;  ///< per disk [F0 a]
};

/// Intensity with the best fit to it.
struct FittedCurve {
  ScatteringCurve curve;
  ScatteringModel model;
  bool usable = false;
  double k_low = 0.0;  ///< fitted range
  double k_high = 0.0;
};

struct PowderSample {
  bool usable = false;
  PowderSnapshot packing;                  ///< packing at the end
  std::vector<ContactRecord<2>> contacts;  ///< contacts of `packing`, computed again from the stored state and its laws
  std::vector<PowderMoment> course;
  std::vector<PowderStage> stages;
  std::vector<PowderSnapshot> snapshots;
  std::optional<FittedCurve> scattering;
};

struct PowderRun {
  std::vector<PowderSample> samples;
  std::optional<FittedCurve> scattering;  ///< mean over samples and their common fit
  double idle_colour = kPowderZeroForce;  ///< pictures show contacts with |N| below it as unstressed [F0]
  bool cohesive = true;
};

/// Throws IoError.
PowderRun load_powder(const std::string& path);

}  // namespace softgrain
