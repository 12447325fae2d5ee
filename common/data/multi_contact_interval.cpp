#include "common/data/multi_contact_interval.h"

#include <algorithm>
#include <cmath>

#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"

namespace softgrain {

double measured_overlap(const LawTableEntry& entry, LawForm form, PartnerKind partner, double ratio) {
  if (partner == PartnerKind::plane) return entry.overlap_max;
  const MultiContactLaw* law = entry.find(form);
  const std::vector<PartnerRow> rows = law == nullptr ? std::vector<PartnerRow>{} : law->rows(partner);
  if (rows.empty()) return 0.0;
  const double wanted = partner == PartnerKind::soft ? std::max(ratio, 1.0 / ratio) : ratio;
  const auto nearest = std::min_element(rows.begin(), rows.end(), [&](const PartnerRow& a, const PartnerRow& b) {
    return std::abs(std::log(a.ratio / wanted)) < std::abs(std::log(b.ratio / wanted));
  });
  return nearest->overlap_max * std::min(1.0, ratio);
}

std::optional<LawInterval> refit_interval(double value, const std::vector<double>& refits, int packings) {
  if (refits.size() < kEnoughReplicates) return std::nullopt;
  const double factor = factor_of_several(packings);
  const auto [low, high] = widened(value, quantile(refits, 0.025), quantile(refits, 0.975), factor, true);
  return LawInterval{low, high, kFromPackings};
}

}  // namespace softgrain
