// Error against cost: what every cheaper way of a run was off by, and what it cost, both against its own reference.
#pragma once

#include <string>
#include <vector>

#include "pipelines/report/run_data.h"

namespace softgrain::report {

/// One cheaper way against its reference.
struct ErrorCost {
  std::string name;        ///< legend entry
  std::string detail;      ///< under the pointer: of what, against what
  std::string engine;      ///< style, as engine_style(); empty: a relaxation
  double cost = 0.0;       ///< contact evaluations over those of the reference
  double error = 0.0;      ///< relative difference from the reference
  double deviation = 0.0;  ///< standard error of `error`; NaN when there is one sample only
};

/// Laws and free twins against the shelled twin (macro runs and every scene of a comparison; error of the axial
/// stress), and the relaxation of the fit against the published one (error: root mean square over Delta of the ratio of
/// the mean normal forces less one, where the force is above 2 % of its largest). What cannot be had is left out.
std::vector<ErrorCost> error_costs(const RunData& run);

/// All of them in one plot; empty without any.
std::string error_cost_figure(const RunData& run);

}  // namespace softgrain::report
