#include "pipelines/report/run_values.h"

#include <cmath>
#include <iterator>
#include <utility>

#include "pipelines/results/kind_results.h"

namespace softgrain::report {

std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  for (const KindResults& kind : results_of_kinds()) {
    if (kind.values == nullptr) continue;
    for (RunValue& v : kind.values(run))
      if (std::isfinite(v.value)) out.push_back(std::move(v));
  }
  return out;
}

std::vector<RunCurve> curves_of(const std::string& directory) {
  const RunData run = load_run(directory);
  std::vector<RunCurve> out;
  for (const KindResults& kind : results_of_kinds()) {
    if (kind.curves == nullptr) continue;
    std::vector<RunCurve> more = kind.curves(run);
    std::move(more.begin(), more.end(), std::back_inserter(out));
  }
  return out;
}

}  // namespace softgrain::report
