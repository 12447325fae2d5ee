// Laws of the contact loop from law cards and from law tables.
#include "common/contact/make_laws.h"

#include <algorithm>
#include <cmath>

#include "common/contact/law_set.h"
#include "common/contact/soft_contact.h"
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
  if (law == nullptr)
    unusable(kind, "the card has none; softgrain calibrate --set mirror=true derives it from the other kind");
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

CardLaw make_card_law(const LawCard& card, PairKind kind, double modulus, double friction, double damping,
                      bool use_secant, std::optional<Extrapolation> beyond, bool unloading) {
  const SoftContact loading = make_soft_contact(card, kind, modulus, friction, damping, use_secant, beyond);
  const std::optional<UnloadingLaw>& branch = card.find(kind)->unloading;
  if (!unloading || !branch) return loading;
  const double residual = branch->residual.value;
  return SoftUnloading{
      loading, {residual, std::max(branch->exponent.value, least_unloading_exponent(residual, loading.normal.b))}};
}

namespace {

const MultiContactLaw& usable(const LawTableEntry& entry, LawForm form) {
  const MultiContactLaw* law = entry.find(form);
  if (law == nullptr) {
    std::string there;
    for (const MultiContactLaw& l : entry.laws) there += (there.empty() ? "" : ", ") + to_string(l.form);
    throw InputError("law table: no law of the form \"" + to_string(form) + "\"; there is " + there);
  }
  if (law->status == LawStatus::no_threshold_crossing)
    throw InputError("law table: the " + to_string(form) + " law is not usable: " + to_string(law->status) + " (" +
                     law->reason + ")");
  if (law->rows(PartnerKind::solid).empty() || law->rows(PartnerKind::soft).empty())
    throw InputError("law table: the " + to_string(form) + " law knows no " +
                     (law->rows(PartnerKind::soft).empty() ? std::string("soft") : std::string("solid")) +
                     " neighbours: measure at least one configuration with them");
  return *law;
}

/// How planes count that are less rough than grains: between those without friction and those with that of the grains.
LostVolumeTable planes_of(const LawTableEntry& entry, const MultiContactModel& model, double wall_friction) {
  LostVolumeTable planes = model.solid;
  if (wall_friction < 0.0 || !(entry.spec.friction > 0.0)) return planes;
  const double rough = std::min(1.0, wall_friction / entry.spec.friction);
  planes.plane_weight = std::pow(model.smooth.a, 1.0 - rough);
  planes.common_exponent = model.smooth.b + rough * (1.0 - model.smooth.b);
  return planes;
}

template <LawForm kLawForm, bool kUnloading, bool kRolling>
MultiContactLaws laws_of(const LawTableEntry& entry, const MultiContactModel& model,
                         const MultiContactChoices& choices) {
  SoftMultiContact<kLawForm, kUnloading, kRolling> law;
  law.form = model.form;
  law.partner = model.solid;
  law.modulus = choices.modulus;
  law.unloading_ratio = choices.unloading_ratio;
  const auto slides = [&](const SlideLaw& slide) {
    law.friction = choices.friction >= 0.0 ? choices.friction : slide.friction.value;
    law.kt_ratio = slide.kt_ratio.value;
    law.unloading = entry.unloading_of(slide).value;
    law.rolling = slide.rolling.value;
    law.rolling_friction = slide.rolling_friction.value;
  };
  MultiContactLaws out;
  slides(entry.slide_plane);
  law.partner = planes_of(entry, model, choices.wall_friction);
  out.soft_plane = law;
  law.partner = model.solid;
  slides(entry.slide_solid);
  out.soft_solid = law;
  law.i_is_soft = false;
  law.j_is_soft = true;
  out.solid_soft = law;
  law.i_is_soft = true;
  law.partner = model.soft;
  slides(entry.slide_soft);
  out.soft_soft = law;
  return out;
}

template <LawForm kLawForm, bool kUnloading>
MultiContactLaws laws_of(const LawTableEntry& entry, const MultiContactModel& model,
                         const MultiContactChoices& choices) {
  return choices.rolling && entry.rolls() ? laws_of<kLawForm, kUnloading, true>(entry, model, choices)
                                          : laws_of<kLawForm, kUnloading, false>(entry, model, choices);
}

template <LawForm kLawForm>
MultiContactLaws laws_of(const LawTableEntry& entry, const MultiContactModel& model,
                         const MultiContactChoices& choices) {
  return choices.unloading ? laws_of<kLawForm, true>(entry, model, choices)
                           : laws_of<kLawForm, false>(entry, model, choices);
}

}  // namespace

MultiContactModel multi_contact_model(const MultiContactLaw& law) {
  MultiContactModel model;
  model.multi_contact = law.form;
  model.form.pressure = {law.a.value, law.b.value, law.delta.value};
  model.form.coupling = {law.m0.value, law.m1.value, law.m2.value};
  for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::solid, PartnerKind::soft}) {
    std::vector<double> ratios;
    std::vector<double> weights;
    double exponent = 1.0;
    for (const PartnerRow& row : law.rows(kind)) {
      ratios.push_back(row.ratio);
      weights.push_back(std::log(row.weight.value));
      exponent = row.exponent.value;
    }
    if (!ratios.empty()) set_partners(model, kind, ratios, weights, exponent);
  }
  return model;
}

MultiContactLaws make_multi_contact_laws(const LawTableEntry& entry, const MultiContactChoices& choices) {
  if (choices.unloading_ratio > 1.0 && (choices.form != LawForm::isotropic || choices.unloading))
    throw InputError("law table: unloading_ratio goes with the isotropic form and without unloading = true");
  MultiContactModel model = multi_contact_model(usable(entry, choices.form));
  if (entry.volume_max > 0.0) model.form.pressure.range = {entry.volume_max, choices.beyond.value_or(entry.beyond)};
  if (model.multi_contact == LawForm::pair) return laws_of<LawForm::pair>(entry, model, choices);
  if (model.multi_contact == LawForm::isotropic) return laws_of<LawForm::isotropic>(entry, model, choices);
  return laws_of<LawForm::directional>(entry, model, choices);
}

}  // namespace softgrain
