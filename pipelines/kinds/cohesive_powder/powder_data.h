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

/// Intensity with the best fit to it.
struct FittedCurve {
  ScatteringCurve curve;
  ScatteringFit fit;  ///< read from a file: the model, the range, and whether it is usable
};

/// Writes the group "scattering".
void write_scattering(const h5::Group& group, const FittedCurve& fitted);

struct PowderSample {
  bool usable = false;
  Snapshot packing;                        ///< packing at the end
  std::vector<ContactRecord<2>> contacts;  ///< contacts of `packing`, computed again from the stored state and its laws
  std::vector<PowderPoint> course;
  std::vector<PowderStage> stages;
  std::optional<SnapshotSeries> snapshots;
  std::optional<FittedCurve> scattering;
};

struct PowderRun {
  std::vector<PowderSample> samples;
  std::optional<FittedCurve> scattering;  ///< mean over samples and their common fit
  double idle_colour = kPowderZeroForce;  ///< pictures show contacts with |N| below it as unstressed [F0]
  bool cohesive = true;
};

/// The snapshots of a sample, of the disks of a state of it. Throws IoError.
SnapshotSeries read_powder_series(const h5::Group& sample, Snapshot state);

/// Throws IoError.
PowderRun load_powder(const std::string& path);

}  // namespace softgrain
