#include "calibrate/crowd_form_fit.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/contact/crowd_from_table.h"
#include "common/core/random.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

std::vector<double> ratios_of(const StateSelection& selection) {
  std::set<double> out;
  for (const CrowdStates* c : selection)
    for (const CrowdPartner& p : c->configuration->partners) out.insert(table_ratio(p));
  return {out.begin(), out.end()};
}

StateSelection partner_selection(const std::vector<CrowdStates>& states, PartnerKind kind, Crowd crowd) {
  StateSelection out;
  for (const CrowdStates& c : states)
    if (fits(c, kind) && c.largest_force() > 0.0 && (crowd != Crowd::pair || c.configuration->partners.size() == 1))
      out.push_back(&c);
  return out;
}

/// Of neighbours some weights may not be determined, which their errors say; of planes nothing may.
std::string trouble_of(const LeastSquaresFit& fit, const char* what, bool all_determined) {
  if (fit.end == FitEnd::not_run || (all_determined ? fit.usable() : fit.end == FitEnd::converged)) return "";
  return std::string(what) + ": " + fit.message;
}

}  // namespace

bool fits(const CrowdStates& c, PartnerKind kind) {
  return c.use == CrowdUse::fitted && !c.states.empty() && c.all_of(kind);
}

StateSelection plane_selection(const std::vector<CrowdStates>& states, Crowd crowd, const CrowdStates* without) {
  StateSelection out;
  for (const CrowdStates& c : states)
    if (&c != without && fits(c, PartnerKind::plane) && (crowd != Crowd::pair || c.configuration->partners.size() == 1))
      out.push_back(&c);
  return out;
}

double table_ratio(const CrowdPartner& p) {
  return p.kind == PartnerKind::soft ? std::max(p.ratio, 1.0 / p.ratio) : p.ratio;
}

std::vector<double> FormFit::parameters() const {
  std::vector<double> all = planes.parameters;
  all.insert(all.end(), solid.parameters.begin(), solid.parameters.end());
  all.insert(all.end(), soft.parameters.begin(), soft.parameters.end());
  return all;
}

std::string FormFit::trouble() const {
  for (const std::string& t : {trouble_of(planes, "planes", true), trouble_of(solid, "solid neighbours", false),
                               trouble_of(soft, "soft neighbours", false)})
    if (!t.empty()) return t;
  return "";
}

FormFit fit_form(Crowd form, const std::vector<CrowdStates>& states, double discrepancy, bool thorough,
                 const CrowdModel& start) {
  FormFit out;
  out.model = start;
  out.model.crowd = form;
  const StateSelection planes = plane_selection(states, out.model.crowd, nullptr);
  out.planes = fit_planes(out.model, planes, discrepancy, thorough);
  const StateSelection solid = partner_selection(states, PartnerKind::solid, out.model.crowd);
  out.solid_ratios = ratios_of(solid);
  if (!solid.empty())
    out.solid = fit_partners(out.model, PartnerKind::solid, out.solid_ratios, solid, discrepancy, thorough);
  const StateSelection soft = partner_selection(states, PartnerKind::soft, out.model.crowd);
  out.soft_ratios = ratios_of(soft);
  if (!soft.empty())
    out.soft = fit_partners(out.model, PartnerKind::soft, out.soft_ratios, soft, discrepancy, thorough);
  return out;
}

std::vector<double> packing_weights(std::size_t packings, std::uint64_t seed, int r) {
  RandomStream random(seed, RandomPurpose::bootstrap, static_cast<std::uint64_t>(r));
  std::vector<double> weight(packings, 0.0);
  for (std::size_t k = 0; k < weight.size(); ++k) weight[random.below(weight.size())] += 1.0;
  return weight;
}

FormRefits refit_form(const CrowdMeasurements& data, Crowd form, const FormFit& full, const CrowdFitOptions& options) {
  FormRefits out;
  out.columns.resize(full.parameters().size());
  for (int r = 0; r < options.replicates; ++r) {
    stop_if_interrupted("refitting to drawn packings");
    const auto states = average_states(data, packing_weights(data.packings.size(), options.seed, r));
    const FormFit fit = fit_form(form, states, options.discrepancy, false, full.model);
    const std::vector<double> p = fit.parameters();
    if (!fit.trouble().empty() || p.size() != out.columns.size()) {
      ++out.failed;
      continue;
    }
    for (std::size_t j = 0; j < p.size(); ++j) out.columns[j].push_back(p[j]);
    out.draws.push_back(r);
  }
  return out;
}

}  // namespace softgrain
