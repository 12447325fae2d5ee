#include "calibrate/crowd_form_fit.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/contact/crowd_from_table.h"
#include "common/core/random.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

int coupling_parameters(Crowd crowd) { return crowd == Crowd::directional ? 3 : 0; }

void set_planes(CrowdModel& model, std::span<const double> p) {
  model.form.pressure = {std::exp(p[0]), p[1], p[2]};
  if (model.crowd == Crowd::directional) model.form.coupling = {p[3], p[4], p[5]};
}

/// Runs a fit whose residuals are those of a model that `set` fills from the parameters.
template <class Set>
LeastSquaresFit fit_model(const CrowdModel& model, const StateSelection& selection, double discrepancy,
                          const std::vector<double>& start, const std::vector<ParameterBounds>& bounds, bool thorough,
                          const Set& set) {
  LeastSquaresProblem problem;
  problem.residuals = crowd_residuals(model, selection, discrepancy).size();
  problem.bounds = bounds;
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
    CrowdModel tried = model;
    set(tried, p);
    const std::vector<double> residuals = crowd_residuals(tried, selection, discrepancy);
    std::copy(residuals.begin(), residuals.end(), r.begin());
    return std::all_of(r.begin(), r.end(), [](double x) { return std::isfinite(x); });
  };
  LeastSquaresOptions options;
  options.thorough = thorough;
  options.max_iterations = 300;
  stop_if_interrupted("fitting");
  return fit_least_squares(problem, {start}, options);
}

}  // namespace

std::vector<const CrowdState*> loading_states(const CrowdStates& states) {
  std::vector<const CrowdState*> out;
  std::vector<double> deepest(states.configuration->partners.size(), 0.0);
  bool pressed_alone = true;
  for (const CrowdState& s : states.states) {
    const CrowdMove move = states.configuration->stages[static_cast<std::size_t>(s.stage)].move;
    pressed_alone = pressed_alone && s.slide == 0.0 && move != CrowdMove::roll;
    bool loading = pressed_alone;
    for (std::size_t k = 0; k < deepest.size(); ++k) {
      loading = loading && s.overlap[k] >= deepest[k] - 1e-9;
      deepest[k] = std::max(deepest[k], s.overlap[k]);
    }
    if (loading) out.push_back(&s);
  }
  return out;
}

std::vector<double> crowd_residuals(const CrowdModel& model, const StateSelection& selection, double discrepancy) {
  std::vector<double> out;
  for (const CrowdStates* c : selection) {
    const double floor = 0.1 * discrepancy * c->largest_force();
    const double share = 1.0 / std::sqrt(static_cast<double>(c->configuration->partners.size()));
    for (const CrowdState* s : loading_states(*c)) {
      const std::vector<double> force = crowd_forces(model, c->configuration->partners, s->overlap);
      for (std::size_t k = 0; k < force.size(); ++k) {
        const double own = discrepancy * s->mean[k];
        out.push_back(share * (force[k] - s->mean[k]) /
                      std::sqrt(s->error[k] * s->error[k] + own * own + floor * floor));
      }
    }
  }
  return out;
}

double crowd_error(const CrowdModel& model, const CrowdStates& states) {
  double miss = 0.0;
  double all = 0.0;
  for (const CrowdState* s : loading_states(states)) {
    const std::vector<double> force = crowd_forces(model, states.configuration->partners, s->overlap);
    for (std::size_t k = 0; k < force.size(); ++k) {
      miss += (force[k] - s->mean[k]) * (force[k] - s->mean[k]);
      all += s->mean[k] * s->mean[k];
    }
  }
  return all > 0.0 ? std::sqrt(miss / all) : 0.0;
}

LeastSquaresFit fit_planes(CrowdModel& model, const StateSelection& selection, double discrepancy, bool thorough) {
  const CrowdPressure& p = model.form.pressure;
  const CrowdCoupling& m = model.form.coupling;
  std::vector<double> start{std::log(p.a), p.b, p.delta};
  std::vector<ParameterBounds> bounds{{-6.0, 6.0}, {1.05, 8.0}, {0.0, 0.3}};
  if (coupling_parameters(model.crowd) > 0) {
    start.insert(start.end(), {m.m0, m.m1, m.m2});
    bounds.insert(bounds.end(), 3, ParameterBounds{-3.0, 3.0});
  }
  LeastSquaresFit fit = fit_model(model, selection, discrepancy, start, bounds, thorough, set_planes);
  set_planes(model, fit.parameters);
  return fit;
}

LeastSquaresFit fit_partners(CrowdModel& model, PartnerKind kind, const std::vector<double>& ratios,
                             const StateSelection& selection, double discrepancy, bool thorough) {
  const auto set = [&](CrowdModel& tried, std::span<const double> p) {
    set_partners(tried, kind, ratios, {p.begin(), p.end() - 1}, p.back());
  };
  std::vector<double> start(ratios.size() + 1, kind == PartnerKind::solid ? 0.0 : -1.0);
  start.back() = kind == PartnerKind::solid ? 1.0 : 1.2;
  std::vector<ParameterBounds> bounds(start.size(), {-4.0, 4.0});
  bounds.back() = {0.6, 3.0};
  set(model, start);
  LeastSquaresFit fit = fit_model(model, selection, discrepancy, start, bounds, false, set);
  if (thorough && fit.end != FitEnd::converged)
    fit = fit_model(model, selection, discrepancy, start, bounds, true, set);
  set(model, fit.parameters);
  return fit;
}

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
