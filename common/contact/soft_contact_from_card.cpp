#include "common/contact/soft_contact_from_card.h"

#include "common/core/error.h"

namespace softgrain {

namespace {

PowerTerm term(const ThresholdPowerLaw& law) { return {law.a.value, law.b.value, law.c.value}; }

PowerTerm tangential_term(const PairLaw& law, bool use_secant) {
  if (use_secant && law.has_tangential_secant) return term(law.tangential_secant);
  if (law.has_tangential_initial) return term(law.tangential_initial);
  if (law.has_tangential_secant) return term(law.tangential_secant);
  return {};
}

}  // namespace

SoftContact make_soft_contact(const LawCard& card, PairKind kind, double modulus, double friction, double damping, bool use_secant) {
  const PairLaw* law = card.find(kind);
  if (law == nullptr) throw BadInput("the law card has no " + to_string(kind) + " law");
  if (law->status != "good" && law->status != "underdetermined")
    throw BadInput("the " + to_string(kind) + " law of the card is not usable: " + law->status + " (" + law->reason + ")");
  SoftContact contact;
  contact.normal = term(law->normal);
  contact.tangential = tangential_term(*law, use_secant);
  contact.delta = law->normal.delta.value;
  contact.modulus = modulus;
  contact.friction = friction;
  contact.damping = damping;
  contact.partner_is_soft = kind == PairKind::soft_soft;
  return contact;
}

}  // namespace softgrain
