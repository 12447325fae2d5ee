// Two decades with every grain: one soft particle whose inner soft particles hold their grains, against the same one
// whose inner soft particles act by law.
#pragma once

#include <vector>

#include "pipelines/kinds/hierarchy/level.h"
#include "pipelines/run/run.h"

namespace softgrain {

/// Forces at one overlap with a plane, means over packings, over E Rs^2.
struct CheckPoint {
  double overlap = 0.0;
  double law = 0.0;
  double law_error = 0.0;
  double resolved = 0.0;
  double resolved_error = 0.0;
  double ratio = 0.0;
  double ratio_error = 0.0;  ///< standard error of the paired ratio of means
};

struct CheckResult {
  std::vector<CheckPoint> points;
  double inner = 0.0;   ///< soft particles inside, mean
  double grains = 0.0;  ///< grains of a resolved run, mean
  std::int64_t packings = 0;
  Cost law_cost;
  Cost resolved_cost;
  bool converged = true;
};

/// Runs the check with the law of the finest level. Finished runs are kept in the run.store.
CheckResult check_two_decades(const HierarchySetup& setup, const HierarchyLevel& finest, const Run& run);

}  // namespace softgrain
