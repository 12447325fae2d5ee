#include "common/contact/soft_contact_from_card.h"

#include <cmath>

#include "common/contact/threshold_term.h"
#include "common/core/error.h"

namespace softgrain {

namespace {

[[noreturn]] void unusable(PairKind kind, const std::string& problem) {
  throw InputError("law card: no usable " + to_string(kind) + " law: " + problem);
}

PowerTerm term(const ThresholdPowerLaw& law) { return threshold_term(law.a.value, law.b.value, law.delta.value); }

void require_valid(const ThresholdPowerLaw& law, PairKind kind, const char* part) {
  const bool valid = std::isfinite(law.a.value) && law.a.value > 0.0 && std::isfinite(law.b.value) &&
                     law.b.value > 0.0 && std::isfinite(law.delta.value) && law.delta.value >= 0.0 &&
                     law.delta.value < 1.0;
  if (!valid) unusable(kind, std::string(part) + " part needs a > 0, b > 0 and delta in [0, 1)");
}

const PairLaw& usable_law(const LawCard& card, PairKind kind) {
  const PairLaw* law = card.find(kind);
  if (law == nullptr) unusable(kind, "the card has none");
  if (!has_numbers(law->status))
    unusable(kind, "its status is \"" + to_string(law->status) + "\"" +
                       (law->reason.empty() ? "" : " (" + law->reason + ")"));
  require_valid(law->normal, kind, "normal");
  return *law;
}

/// The stiffness that was asked for, else the one that was fitted, else a share of the normal one.
PowerTerm tangential_term(const LawCard& card, const PairLaw& law, bool use_secant) {
  const bool secant = law.has_tangential_secant && (use_secant || !law.has_tangential_initial);
  if (!has_tangential(law))
    return {assumed_kt_ratio(card, law) * law.normal.a.value * law.normal.b.value, law.normal.b.value - 1.0, 0.0};
  const ThresholdPowerLaw& chosen = secant ? law.tangential_secant : law.tangential_initial;
  require_valid(chosen, law.kind, "tangential");
  return term(chosen);
}

}  // namespace

SoftContact make_soft_contact(const LawCard& card, PairKind kind, double modulus, double friction, double damping,
                              bool use_secant, std::optional<Extrapolation> beyond) {
  const PairLaw& law = usable_law(card, kind);
  SoftContact out;
  out.normal = term(law.normal);
  out.tangential = tangential_term(card, law, use_secant);
  out.delta = law.normal.delta.value;
  out.modulus = modulus;
  out.friction = friction;
  out.damping = damping;
  if (law.delta_max > 0.0) out.range = {law.delta_max, beyond.value_or(law.beyond)};
  out.partner_is_soft = kind == PairKind::soft_soft;
  return out;
}

}  // namespace softgrain
