// The measuring part of a pipeline: packings and runs in parallel, each saved as it goes, so that a stopped run goes
// on.
#pragma once

#include <vector>

#include "common/data/measurements.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/run/run.h"

namespace softgrain {

struct MeasureResult {
  Measurements data;
  std::vector<ShellPacking> packings;  ///< first bodies, to fill resolved twins with
  /// One sentence for each packing whose measurement broke off (a grain squeezed out of its shell...). It is left out
  /// of `data` as a whole: a mean over those that got further is a mean over the soft ones.
  std::vector<std::string> left_out;
  bool enough_left = true;  ///< whether at least half of the packings of every relaxation and kind of pair are left
  double wall_seconds = 0.0;
  double packing_seconds = 0.0;  ///< part of it that went into generating packings
};

/// Packing index of the second body of a soft-soft pair: a stream of its own.
std::uint64_t second_body_index(std::int64_t packing);

/// Generates, measures and saves DIR/measurements.h5. Results do not depend on the number of threads.
MeasureResult run_measure_stage(const MeasureSetup& setup, const Run& run);

}  // namespace softgrain
