// The 95 % band of a fitted law as figures draw it.
#include <algorithm>

#include "pipelines/report/run_data.h"

namespace softgrain::report {

std::vector<double> spread(double low, double high, int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(low + (high - low) * i / std::max(1, n - 1));
  return values;
}

std::optional<LawBand> law_band(const PairLaw& law, LawPart part) {
  if (!has_part(law, part)) return std::nullopt;
  if (auto stored = stored_band(law, part)) return stored;
  return linearised_band(law, part, spread(0.0, law.delta_max, 121));
}

}  // namespace softgrain::report
