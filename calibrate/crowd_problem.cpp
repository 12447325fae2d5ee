#include "calibrate/crowd_problem.h"

#include <algorithm>
#include <cmath>

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
  for (const CrowdState& s : states.states) {
    bool loading = s.slide == 0.0;
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

}  // namespace softgrain
