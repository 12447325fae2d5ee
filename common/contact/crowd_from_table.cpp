#include "common/contact/crowd_from_table.h"

#include <algorithm>
#include <cmath>

#include "common/core/error.h"

namespace softgrain {

namespace {

const CrowdLaw& usable(const LawTableEntry& entry, Crowd form) {
  const CrowdLaw* law = entry.find(form);
  if (law == nullptr) throw BadInput("law table: no law of the form \"" + to_string(form) + "\"");
  if (law->status == LawStatus::no_threshold_crossing)
    throw BadInput("law table: the " + to_string(form) + " law is not usable: " + to_string(law->status) + " (" +
                   law->reason + ")");
  if (law->rows(PartnerKind::solid).empty() || law->rows(PartnerKind::soft).empty())
    throw BadInput("law table: the " + to_string(form) + " law knows no " +
                   (law->rows(PartnerKind::soft).empty() ? std::string("soft") : std::string("solid")) +
                   " neighbours: measure at least one configuration with them");
  return *law;
}

/// How planes count that are less rough than grains: between those without friction and those with that of the grains.
LostVolumeTable planes_of(const LawTableEntry& entry, const CrowdModel& model, double wall_friction) {
  LostVolumeTable planes = model.solid;
  if (wall_friction < 0.0 || !(entry.spec.friction > 0.0)) return planes;
  const double rough = std::min(1.0, wall_friction / entry.spec.friction);
  planes.plane_weight = std::pow(model.smooth.a, 1.0 - rough);
  planes.common_exponent = model.smooth.b + rough * (1.0 - model.smooth.b);
  return planes;
}

template <Crowd kCrowd, bool kUnloading, bool kRolling>
CrowdLaws laws_of(const LawTableEntry& entry, const CrowdModel& model, const CrowdChoices& choices) {
  SoftCrowd<kCrowd, kUnloading, kRolling> law;
  law.form = model.form;
  law.partner = model.solid;
  law.modulus = choices.modulus;
  const auto slides = [&](const SlideLaw& slide) {
    law.friction = choices.friction >= 0.0 ? choices.friction : slide.friction.value;
    law.kt_ratio = slide.kt_ratio.value;
    law.retreat = entry.retreat_of(slide).value;
    law.rolling = slide.rolling.value;
    law.rolling_friction = slide.rolling_friction.value;
  };
  CrowdLaws out;
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

template <Crowd kCrowd, bool kUnloading>
CrowdLaws laws_of(const LawTableEntry& entry, const CrowdModel& model, const CrowdChoices& choices) {
  return choices.rolling && entry.rolls() ? laws_of<kCrowd, kUnloading, true>(entry, model, choices)
                                          : laws_of<kCrowd, kUnloading, false>(entry, model, choices);
}

template <Crowd kCrowd>
CrowdLaws laws_of(const LawTableEntry& entry, const CrowdModel& model, const CrowdChoices& choices) {
  return choices.unloading ? laws_of<kCrowd, true>(entry, model, choices)
                           : laws_of<kCrowd, false>(entry, model, choices);
}

}  // namespace

CrowdModel crowd_model(const CrowdLaw& law) {
  CrowdModel model;
  model.crowd = law.form;
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

CrowdLaws make_crowd_laws(const LawTableEntry& entry, const CrowdChoices& choices) {
  CrowdModel model = crowd_model(usable(entry, choices.form));
  if (entry.volume_max > 0.0) model.form.pressure.range = {entry.volume_max, choices.beyond.value_or(entry.beyond)};
  if (model.crowd == Crowd::pair) return laws_of<Crowd::pair>(entry, model, choices);
  if (model.crowd == Crowd::bag) return laws_of<Crowd::bag>(entry, model, choices);
  return laws_of<Crowd::directional>(entry, model, choices);
}

}  // namespace softgrain
