#include "common/contact/multi_contact_from_table.h"

#include <algorithm>
#include <cmath>

#include "common/core/error.h"

namespace softgrain {

namespace {

const MultiContactLaw& usable(const LawTableEntry& entry, LawForm form) {
  const MultiContactLaw* law = entry.find(form);
  if (law == nullptr) throw InputError("law table: no law of the form \"" + to_string(form) + "\"");
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
  MultiContactModel model = multi_contact_model(usable(entry, choices.form));
  if (entry.volume_max > 0.0) model.form.pressure.range = {entry.volume_max, choices.beyond.value_or(entry.beyond)};
  if (model.multi_contact == LawForm::pair) return laws_of<LawForm::pair>(entry, model, choices);
  if (model.multi_contact == LawForm::isotropic) return laws_of<LawForm::isotropic>(entry, model, choices);
  return laws_of<LawForm::directional>(entry, model, choices);
}

}  // namespace softgrain
