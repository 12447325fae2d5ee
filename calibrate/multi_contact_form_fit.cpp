#include "calibrate/multi_contact_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "calibrate/multi_contact_slopes.h"
#include "common/contact/make_laws.h"
#include "common/core/parallel_tasks.h"
#include "common/core/random.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

int coupling_parameters(LawForm multi_contact) { return multi_contact == LawForm::directional ? 3 : 0; }

void set_planes(MultiContactModel& model, std::span<const double> p) {
  model.form.pressure = {std::exp(p[0]), p[1], p[2]};
  if (model.multi_contact == LawForm::directional) model.form.coupling = {p[3], p[4], p[5]};
}

std::vector<ParameterBounds> plane_bounds(LawForm form) {
  std::vector<ParameterBounds> bounds{{-6.0, 6.0}, {1.05, 8.0}, {0.0, 0.3}};
  bounds.insert(bounds.end(), static_cast<std::size_t>(coupling_parameters(form)), ParameterBounds{-10.0, 10.0});
  return bounds;
}

std::vector<ParameterBounds> partner_bounds(std::size_t ratios) {
  std::vector<ParameterBounds> bounds(ratios + 1, {-4.0, 4.0});
  bounds.back() = {0.6, 3.0};
  return bounds;
}

}  // namespace

std::vector<const MultiContactState*> loading_states(const MultiContactStates& states) {
  std::vector<const MultiContactState*> out;
  std::vector<double> deepest(states.configuration->partners.size(), 0.0);
  bool pressed_alone = true;
  for (const MultiContactState& s : states.states) {
    const MultiContactMove move = states.configuration->stages[static_cast<std::size_t>(s.stage)].move;
    pressed_alone = pressed_alone && s.slide == 0.0 && move != MultiContactMove::roll;
    const bool free = states.configuration->centre_free;  // the shell gives way: overlaps towards it may shrink
    bool loading = pressed_alone && (!free || move == MultiContactMove::load);
    for (std::size_t k = 0; k < deepest.size(); ++k) {
      loading = loading && (free || s.overlap[k] >= deepest[k] - 1e-9);
      deepest[k] = std::max(deepest[k], s.overlap[k]);
    }
    if (loading) out.push_back(&s);
  }
  return out;
}

namespace {

/// Forces that a fit compares with, and their weights, neighbour after neighbour.
struct WeighedForces {
  std::vector<OverlapState> states;
  std::vector<double> mean;
  std::vector<double> weight;
};

WeighedForces weighed_forces(const StateSelection& selection, double discrepancy) {
  WeighedForces out;
  for (const MultiContactStates* c : selection) {
    const double floor = 0.1 * discrepancy * c->largest_force();
    const double share = 1.0 / std::sqrt(static_cast<double>(c->configuration->touching()));
    for (const MultiContactState* s : loading_states(*c)) {
      out.states.push_back({&c->configuration->partners, &s->overlap});
      for (std::size_t k = 0; k < s->mean.size(); ++k) {
        const double own = discrepancy * s->mean[k];
        out.mean.push_back(s->mean[k]);
        out.weight.push_back(share / std::sqrt(s->error[k] * s->error[k] + own * own + floor * floor));
      }
    }
  }
  return out;
}

/// How the numbers of the law at the states of a fit change with its parameters: numbers x parameters, by central
/// differences of what is cheap and smooth.
template <class Set>
std::vector<double> number_slopes(const MultiContactSlopes& forces, const MultiContactModel& model,
                                  std::span<const double> p, const Set& set) {
  const double step = std::cbrt(std::numeric_limits<double>::epsilon());
  std::vector<double> out(forces.numbers() * p.size());
  std::vector<double> moved(p.begin(), p.end());
  for (std::size_t j = 0; j < p.size(); ++j) {
    const double h = step * std::max(1.0, std::abs(p[j]));
    std::vector<double> ends[2];
    for (const int side : {0, 1}) {
      moved[j] = p[j] + (side == 0 ? -h : h);
      MultiContactModel tried = model;
      set(tried, moved);
      ends[side] = forces.numbers_of(tried);
    }
    moved[j] = p[j];
    for (std::size_t k = 0; k < forces.numbers(); ++k) out[k * p.size() + j] = (ends[1][k] - ends[0][k]) / (2.0 * h);
  }
  return out;
}

/// Runs a fit whose residuals are those of a model that `set` fills from the parameters.
template <class Set>
LeastSquaresFit fit_model(const MultiContactModel& model, const StateSelection& selection, double discrepancy,
                          const std::vector<std::vector<double>>& starts, const std::vector<ParameterBounds>& bounds,
                          bool thorough, bool settle, const Set& set) {
  const WeighedForces selects = weighed_forces(selection, discrepancy);
  const MultiContactSlopes forces(model.multi_contact, selects.states);
  const auto numbers_at = [&](std::span<const double> p) {
    MultiContactModel tried = model;
    set(tried, p);
    return forces.numbers_of(tried);
  };
  LeastSquaresProblem problem;
  problem.residuals = selects.mean.size();
  problem.bounds = bounds;
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
    forces.evaluate(numbers_at(p), r);
    for (std::size_t k = 0; k < r.size(); ++k) r[k] = selects.weight[k] * (r[k] - selects.mean[k]);
    return std::all_of(r.begin(), r.end(), [](double x) { return std::isfinite(x); });
  };
  std::vector<double> slope(forces.forces() * forces.numbers());
  problem.jacobian = [&](std::span<const double> p, std::span<double> jacobian) {
    forces.slopes(numbers_at(p), slope);
    const std::vector<double> by_parameter = number_slopes(forces, model, p, set);
    for (std::size_t i = 0; i < forces.forces(); ++i) {
      const std::span<double> row = jacobian.subspan(i * p.size(), p.size());
      std::fill(row.begin(), row.end(), 0.0);
      for (std::size_t k = 0; k < forces.numbers(); ++k) {
        const double s = selects.weight[i] * slope[i * forces.numbers() + k];
        if (s == 0.0) continue;
        for (std::size_t j = 0; j < p.size(); ++j) row[j] += s * by_parameter[k * p.size() + j];
      }
    }
    return std::all_of(jacobian.begin(), jacobian.end(), [](double x) { return std::isfinite(x); });
  };
  if (settle) problem.kinks = [&](std::span<const double> p) { return forces.above_threshold(numbers_at(p)); };
  LeastSquaresOptions options;
  options.thorough = thorough;
  options.max_iterations = 300;
  stop_if_interrupted("fitting");
  return fit_least_squares(problem, starts, options);
}

}  // namespace

std::vector<double> multi_contact_residuals(const MultiContactModel& model, const StateSelection& selection,
                                            double discrepancy) {
  const WeighedForces selects = weighed_forces(selection, discrepancy);
  const MultiContactSlopes forces(model.multi_contact, selects.states);
  std::vector<double> out(selects.mean.size());
  forces.evaluate(forces.numbers_of(model), out);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = selects.weight[k] * (out[k] - selects.mean[k]);
  return out;
}

double multi_contact_error(const MultiContactModel& model, const MultiContactStates& states) {
  double miss = 0.0;
  double all = 0.0;
  for (const MultiContactState* s : loading_states(states)) {
    const std::vector<double> force = multi_contact_forces(model, states.configuration->partners, s->overlap);
    for (std::size_t k = 0; k < force.size(); ++k) {
      miss += (force[k] - s->mean[k]) * (force[k] - s->mean[k]);
      all += s->mean[k] * s->mean[k];
    }
  }
  return all > 0.0 ? std::sqrt(miss / all) : 0.0;
}

FormOffset form_offset(const MultiContactModel& model, const MultiContactStates& states, double discrepancy) {
  const MultiContactPressure law = model.form.pressure;
  const auto set = [law](MultiContactModel& tried, std::span<const double> p) {
    tried.form.pressure.a = law.a * std::exp(p[0]);
    tried.form.pressure.delta = p[1];
  };
  constexpr double kFar = 3.0;
  constexpr double kDeepest = 0.5;
  const LeastSquaresFit fit =
      fit_model(model, {&states}, discrepancy, {{0.0, law.delta}}, {{-kFar, kFar}, {0.0, kDeepest}}, false, true, set);
  return {fit.parameters[0], fit.parameters[1] - law.delta};
}

LeastSquaresFit fit_planes(MultiContactModel& model, const StateSelection& selection, double discrepancy, bool thorough,
                           bool settle) {
  const MultiContactPressure& p = model.form.pressure;
  const MultiContactCoupling& m = model.form.coupling;
  std::vector<double> start{std::log(p.a), p.b, p.delta};
  if (coupling_parameters(model.multi_contact) > 0) start.insert(start.end(), {m.m0, m.m1, m.m2});
  LeastSquaresFit fit = fit_model(model, selection, discrepancy, {start}, plane_bounds(model.multi_contact), thorough,
                                  settle, set_planes);
  set_planes(model, fit.parameters);
  return fit;
}

namespace {

bool any_undetermined(const LeastSquaresFit& fit) {
  return std::any_of(fit.standard_deviations.begin(), fit.standard_deviations.end(),
                     [](double sd) { return !std::isfinite(sd); });
}

}  // namespace

LeastSquaresFit fit_partners(MultiContactModel& model, PartnerKind kind, const std::vector<double>& ratios,
                             const StateSelection& selection, double discrepancy, bool thorough, bool settle) {
  const auto set = [&](MultiContactModel& tried, std::span<const double> p) {
    set_partners(tried, kind, ratios, {p.begin(), p.end() - 1}, p.back());
  };
  std::vector<double> start(ratios.size() + 1, kind == PartnerKind::soft ? -1.0 : 0.0);
  start.back() = kind == PartnerKind::soft ? 1.2 : 1.0;
  const std::vector<ParameterBounds> bounds = partner_bounds(ratios.size());
  set(model, start);
  const bool settle_first = settle && !thorough;  // else further strategies come first
  LeastSquaresFit fit = fit_model(model, selection, discrepancy, {start}, bounds, false, settle_first, set);
  if (any_undetermined(fit)) {
    // Where a weight leaves every state below the threshold, nothing changes with it: such a fit stays where it starts.
    std::vector<std::vector<double>> starts{start};
    for (const double more : {1.0, 2.0}) {
      starts.push_back(start);
      for (std::size_t k = 0; k < ratios.size(); ++k) starts.back()[k] += more;
    }
    fit = fit_model(model, selection, discrepancy, starts, bounds, false, settle_first, set);
  }
  if (thorough && fit.end != FitEnd::converged)
    fit = fit_model(model, selection, discrepancy, {start}, bounds, true, settle, set);
  set(model, fit.parameters);
  return fit;
}

namespace {

std::vector<double> ratios_of(const StateSelection& selection) {
  std::set<double> out;
  for (const MultiContactStates* c : selection)
    for (const MultiContactPartner& p : c->configuration->partners)
      if (p.on < 0) out.insert(table_ratio(p));
  return {out.begin(), out.end()};
}

template <class Selects>
StateSelection selection_of(const std::vector<MultiContactStates>& states, const Selects& selects) {
  StateSelection out;
  for (const MultiContactStates& c : states)
    if (selects(c)) out.push_back(&c);
  return out;
}

/// Why a fit is not the minimum that it should be; empty: it is. Some weights of neighbours may be undetermined, which
/// their errors say; of planes nothing may (`all_determined`).
std::string trouble_of(const LeastSquaresFit& fit, const char* what, bool all_determined) {
  if (fit.end == FitEnd::not_run || (all_determined ? fit.usable() : fit.end == FitEnd::converged)) return "";
  return std::string(what) + ": " + fit.message;
}

/// The part of a fit that begins at parameter `first`, `count` long.
LeastSquaresFit part_of(const LeastSquaresFit& all, std::size_t first, std::size_t count) {
  const auto slice = [&](auto& values) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
    values = {begin, begin + static_cast<std::ptrdiff_t>(count)};
  };
  LeastSquaresFit out = all;
  const std::size_t n = all.parameters.size();
  slice(out.parameters);
  if (out.standard_deviations.size() == n) slice(out.standard_deviations);
  if (out.at_bound.size() == n) slice(out.at_bound);
  // The part may be determined where the whole is not.
  out.rank_deficient = std::any_of(out.standard_deviations.begin(), out.standard_deviations.end(),
                                   [](double sd) { return !std::isfinite(sd); });
  out.covariance.clear();
  for (std::size_t r = first; all.covariance.size() == n * n && r < first + count; ++r)
    for (std::size_t c = first; c < first + count; ++c) out.covariance.push_back(all.covariance[r * n + c]);
  return out;
}

void set_all(MultiContactModel& model, const std::vector<PartnerFit>& partners, std::size_t planes,
             std::span<const double> p) {
  set_planes(model, p.first(planes));
  for (const PartnerFit& k : partners) {
    if (k.ratios.empty()) continue;
    const auto own = p.subspan(k.first, k.ratios.size() + 1);
    set_partners(model, k.kind, k.ratios, {own.begin(), own.end() - 1}, own.back());
  }
}

/// Fits all parameters together, from where the fits one after the other ended.
void fit_together(FormFit& form, const StateSelection& selection, double discrepancy) {
  const std::size_t planes = form.planes.parameters.size();
  std::vector<ParameterBounds> bounds = plane_bounds(form.model.multi_contact);
  for (const PartnerFit& k : form.partners) {
    if (k.ratios.empty()) continue;
    const auto own = partner_bounds(k.ratios.size());
    bounds.insert(bounds.end(), own.begin(), own.end());
  }
  const auto set = [&](MultiContactModel& tried, std::span<const double> p) {
    set_all(tried, form.partners, planes, p);
  };
  const LeastSquaresFit all =
      fit_model(form.model, selection, discrepancy, {form.parameters()}, bounds, false, true, set);
  if (all.end == FitEnd::failed || all.end == FitEnd::capped) return;
  set(form.model, all.parameters);
  form.planes = part_of(all, 0, planes);
  for (PartnerFit& k : form.partners)
    if (!k.ratios.empty()) k.fit = part_of(all, k.first, k.ratios.size() + 1);
}

/// All neighbours planes without friction, or all something else.
bool all_smooth(const MultiContactStates& c) {
  const auto& partners = c.configuration->partners;
  return std::all_of(partners.begin(), partners.end(), [](const MultiContactPartner& p) { return p.smooth; });
}

}  // namespace

bool serves(const MultiContactStates& c, LawForm form) {
  const bool alone = c.configuration->partners.size() == 1;
  return c.use == MultiContactUse::fitted && !c.states.empty() && !loading_states(c).empty() &&
         (form == LawForm::pair ? alone : c.for_multi_contact);
}

bool serves(const MultiContactStates& c, LawForm form, PartnerKind kind) {
  return serves(c, form) && c.all_of(kind) && (kind != PartnerKind::plane || !all_smooth(c));
}

StateSelection plane_selection(const std::vector<MultiContactStates>& states, LawForm form) {
  return selection_of(states, [&](const MultiContactStates& c) { return serves(c, form, PartnerKind::plane); });
}

double table_ratio(const MultiContactPartner& p) {
  return p.kind == PartnerKind::soft ? std::max(p.ratio, 1.0 / p.ratio) : p.ratio;
}

std::vector<double> FormFit::parameters() const {
  std::vector<double> all = planes.parameters;
  for (const PartnerFit& k : partners) all.insert(all.end(), k.fit.parameters.begin(), k.fit.parameters.end());
  return all;
}

std::string FormFit::trouble() const {
  if (const std::string t = trouble_of(planes, "planes", true); !t.empty()) return t;
  for (const PartnerFit& k : partners) {
    const char* what = k.kind == PartnerKind::solid  ? "solid neighbours"
                       : k.kind == PartnerKind::soft ? "soft neighbours"
                                                     : "planes without friction";
    if (const std::string t = trouble_of(k.fit, what, false); !t.empty()) return t;
  }
  return "";
}

FormFit fit_form(LawForm form, const std::vector<MultiContactStates>& states, double discrepancy, bool thorough,
                 const MultiContactModel& start, const MultiContactStates* without) {
  FormFit out;
  out.model = start;
  out.model.multi_contact = form;
  const bool together = all_together(states, form);
  const auto select = [&](const auto& selects) {
    return selection_of(states, [&](const MultiContactStates& c) { return &c != without && selects(c); });
  };
  out.planes =
      fit_planes(out.model, select([&](const MultiContactStates& c) { return serves(c, form, PartnerKind::plane); }),
                 discrepancy, thorough, !together);
  std::size_t first = out.planes.parameters.size();
  for (const PartnerKind kind : {PartnerKind::solid, PartnerKind::soft, PartnerKind::plane}) {
    const StateSelection own = select([&](const MultiContactStates& c) {
      const bool selects = kind == PartnerKind::plane ? serves(c, form) && all_smooth(c) : serves(c, form, kind);
      return selects && c.largest_force() > 0.0;
    });
    PartnerFit& k = out.partners.emplace_back(PartnerFit{kind, ratios_of(own), {}, first});
    if (own.empty()) continue;
    k.fit = fit_partners(out.model, kind, k.ratios, own, discrepancy, thorough, !together);
    first += k.fit.parameters.size();
  }
  if (together) out = refitted(out, states, discrepancy, without);
  return out;
}

bool all_together(const std::vector<MultiContactStates>& states, LawForm form) {
  return form != LawForm::pair &&
         std::any_of(states.begin(), states.end(), [](const MultiContactStates& c) { return !c.for_multi_contact; });
}

FormFit refitted(const FormFit& near, const std::vector<MultiContactStates>& states, double discrepancy,
                 const MultiContactStates* without) {
  FormFit out = near;
  fit_together(out,
               selection_of(states,
                            [&](const MultiContactStates& c) {
                              return &c != without && serves(c, near.model.multi_contact) && c.largest_force() > 0.0;
                            }),
               discrepancy);
  return out;
}

std::vector<double> packing_weights(std::size_t packings, std::uint64_t seed, int r) {
  RandomStream random(seed, RandomPurpose::bootstrap, static_cast<std::uint64_t>(r));
  std::vector<double> weight(packings, 0.0);
  for (std::size_t k = 0; k < weight.size(); ++k) weight[random.below(weight.size())] += 1.0;
  return weight;
}

void FormRefits::take(const FormFit& fit, int draw) {
  const std::vector<double> p = fit.parameters();
  if (!fit.trouble().empty() || p.size() != columns.size()) {
    ++failed;
    return;
  }
  for (std::size_t j = 0; j < p.size(); ++j) columns[j].push_back(p[j]);
  draws.push_back(draw);
}

namespace {

/// Configurations that a form is fitted to.
std::int64_t fitted_to(const std::vector<MultiContactStates>& states, LawForm form) {
  return std::count_if(states.begin(), states.end(), [form](const MultiContactStates& c) { return serves(c, form); });
}

}  // namespace

FormRefits refit_form(const MultiContactMeasurements& data, const std::vector<MultiContactStates>& all, LawForm form,
                      const FormFit& full, const MultiContactFitOptions& options) {
  constexpr int kMostPerReplicate = 2;
  FormRefits out;
  out.columns.resize(full.parameters().size());
  const auto selects = static_cast<std::size_t>(options.replicates);
  const std::int64_t configurations = fitted_to(all, form);
  for (int tried = 0; out.draws.size() < selects && tried < kMostPerReplicate * options.replicates;) {
    const int more =
        std::min(static_cast<int>(selects - out.draws.size()), kMostPerReplicate * options.replicates - tried);
    std::vector<FormFit> fits(static_cast<std::size_t>(more));
    parallel_tasks(more, [&](std::int64_t k) {
      const auto weights = packing_weights(data.packings.size(), options.seed, tried + static_cast<int>(k));
      const auto states = average_states(data, weights);
      // A configuration with few packings may have none in a draw: that is no fit of the same law.
      if (fitted_to(states, form) < configurations) return;
      fits[static_cast<std::size_t>(k)] = all_together(states, form)
                                              ? refitted(full, states, options.discrepancy)
                                              : fit_form(form, states, options.discrepancy, false, full.model);
    });
    for (const FormFit& fit : fits) out.take(fit, tried++);
  }
  return out;
}

}  // namespace softgrain
