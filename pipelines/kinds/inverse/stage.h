// The measuring part of a reverse search: packings at points of the box, each kept as it is finished.
#pragma once

#include <vector>

#include "common/io/progress.h"
#include "pipelines/kinds/inverse/scene.h"
#include "pipelines/run/run.h"

namespace softgrain {

/// All evaluations of a search and the confirming one.
struct InverseResult {
  std::vector<InverseEvaluation> evaluations;
  InverseAnswer answer;
  Measurements confirmed;   ///< measurements at the answer, with packings that the search has not seen
  InverseEvaluation check;  ///< `confirmed` as curves
  Cost cost;                ///< total cost
  std::int64_t not_converged = 0;
  std::int64_t points = 0;
};

/// Runs the search. Finished packings are taken from the store; results depend on no thread count. Throws
/// UnusableResult, Interrupted.
InverseResult run_inverse_stage(const InverseSetup& setup, const Run& run);

}  // namespace softgrain
