#include "common/data/multi_contact_choice.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace softgrain {

namespace {

/// Rank of a law as fit_multi_contact_laws() ranks forms, before it judges how accurate they are.
auto rank_of(const MultiContactLaw& law) {
  const bool determined = law.status == LawStatus::good || law.status == LawStatus::inaccurate;
  return std::tuple{!determined, std::isnan(law.error_cross) ? HUGE_VAL : law.error_cross, law.parameters};
}

}  // namespace

std::string form_label(const LawTableEntry& entry, const MultiContactLaw& law) {
  if (law.form != entry.best) return to_string(law.form);
  const bool better = std::any_of(entry.laws.begin(), entry.laws.end(),
                                  [&](const MultiContactLaw& other) { return rank_of(other) < rank_of(law); });
  return to_string(law.form) + (better ? " (chosen)" : " (best)");
}

}  // namespace softgrain
