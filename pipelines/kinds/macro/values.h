// Numbers and curves by which macro runs, and resolved materials, are set beside others.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "macrosim/macro_spec.h"
#include "pipelines/results/kind_results.h"

namespace softgrain {

/// Curves of all samples of one engine or material, and what it is called.
struct NamedCurves {
  std::string name;  ///< empty: there is nothing else
  std::vector<MacroCurve> curves;
};

/// The curves of each engine, in the order of the run; without names where there is one.
std::vector<NamedCurves> by_engine(const std::vector<MacroCurve>& curves);

/// Axial stress and lateral ratio at the end, means over the usable samples. Tests in stages also have moduli and
/// strength.
std::vector<RunValue> stress_values(const std::vector<NamedCurves>& all);

/// Axial stress over strain, mean over the usable samples that have all recorded points.
std::vector<RunCurve> stress_curves(const std::vector<NamedCurves>& all);

/// Why a test may begin under less stress than its preparation ended with: one sentence for every engine whose first
/// recorded points bear, in the mean of its samples, less than half of start_pressure E; the preparation itself meets
/// it to a third.
std::vector<std::string> first_point_remarks(const MacroSpec& spec, const std::vector<MacroCurve>& curves);

}  // namespace softgrain
