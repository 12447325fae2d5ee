#include "calibrate/crowd_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "calibrate/bootstrap.h"
#include "calibrate/crowd_form_fit.h"
#include "calibrate/crowd_side_fits.h"
#include "common/contact/crowd_from_table.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/parallel_tasks.h"
#include "common/core/statistics.h"
#include "common/data/crowd_interval.h"
#include "common/data/crowd_replicates.h"

namespace softgrain {

namespace {

/// Where the fit of the planes starts: near what the published soft particle gives.
CrowdModel starting_model(Crowd form) {
  CrowdModel model;
  model.crowd = form;
  model.form.pressure = {0.7, 2.9, 0.08};
  model.form.coupling = model.crowd == Crowd::directional ? CrowdCoupling{0.6, 0.9, 0.4} : CrowdCoupling{1.0, 0.0, 0.0};
  return model;
}

/// What a fitted number is: any, one that is not negative, or the logarithm of one.
enum class NumberKind { any, positive, logarithm };

/// A fitted number with its error and, where there are replicates, their interval. The covariance of a fit to
/// neighbours takes the law of planes for exact; replicates, which fit both anew, do not: the larger error holds. Both
/// are widened for the few packings that there are.
Estimate estimate(const LeastSquaresFit& fit, std::size_t j, const std::vector<double>& replicates,
                  std::size_t packings, NumberKind kind) {
  const double value = fit.parameters[j];
  double sd = fit.standard_deviations.empty() ? HUGE_VAL : fit.standard_deviations[j];
  const bool positive = kind == NumberKind::positive;
  auto [low, high] = interval95(replicates);
  if (replicates.size() < kEnoughReplicates) {
    const double half = student95(static_cast<double>(packings) - 1.0) * sd;
    low = positive ? std::max(0.0, value - half) : value - half;
    high = value + half;
  } else {
    std::tie(low, high) = widened(value, low, high, few_samples_factor(packings), positive);
    sd = std::max(sd, scatter_of(replicates));
  }
  if (kind != NumberKind::logarithm) return {value, sd, low, high};
  return {std::exp(value), std::exp(value) * sd, std::exp(low), std::exp(high)};
}

class Filler {
 public:
  Filler(const FormFit& fit, std::vector<std::vector<double>> columns, std::size_t packings)
      : fit_(fit), columns_(std::move(columns)), packings_(packings) {}

  void planes(CrowdLaw& law) const {
    law.a = estimate(fit_.planes, 0, columns_[0], packings_, NumberKind::logarithm);
    law.b = estimate(fit_.planes, 1, columns_[1], packings_, NumberKind::positive);
    law.delta = estimate(fit_.planes, 2, columns_[2], packings_, NumberKind::positive);
    const CrowdCoupling& m = fit_.model.form.coupling;
    law.m0.value = m.m0;
    if (fit_.model.crowd != Crowd::directional) return;
    law.m0 = estimate(fit_.planes, 3, columns_[3], packings_, NumberKind::any);
    law.m1 = estimate(fit_.planes, 4, columns_[4], packings_, NumberKind::any);
    law.m2 = estimate(fit_.planes, 5, columns_[5], packings_, NumberKind::any);
  }

  void partners(CrowdLaw& law, const std::vector<CrowdStates>& states, const PartnerFit& own) const {
    const std::size_t ratios = own.ratios.size();
    for (std::size_t k = 0; k < ratios; ++k) {
      PartnerRow row{own.kind,
                     own.ratios[k],
                     estimate(own.fit, k, columns_[own.first + k], packings_, NumberKind::logarithm),
                     estimate(own.fit, ratios, columns_[own.first + ratios], packings_, NumberKind::positive),
                     0.0,
                     0.0};
      describe(row, states);
      law.partners.push_back(row);
    }
  }

 private:
  /// Range and error of one row, from the configurations that have this neighbour.
  void describe(PartnerRow& row, const std::vector<CrowdStates>& states) const {
    for (const CrowdStates& c : states) {
      const CrowdPartner& first = c.configuration->partners.front();
      const bool smooth = row.kind == PartnerKind::plane;
      const bool own = serves(c, fit_.model.crowd) && c.all_of(row.kind) && first.smooth == smooth;
      if (!own || table_ratio(first) != row.ratio) continue;
      for (const CrowdState* s : loading_states(c))
        for (std::size_t k = 0; k < c.configuration->touching(); ++k)
          row.overlap_max = std::max(
              row.overlap_max, s->overlap[k] / (smooth ? 1.0 : std::min(1.0, c.configuration->partners[k].ratio)));
      row.error = std::max(row.error, crowd_error(fit_.model, c));
    }
  }

  const FormFit& fit_;
  std::vector<std::vector<double>> columns_;
  std::size_t packings_;
};

/// The replicates as rows of crowd_numbers() of this law.
std::vector<std::vector<double>> replicate_rows(const CrowdLaw& law, const FormFit& fit,
                                                const std::vector<std::vector<double>>& columns) {
  const std::vector<double> best = crowd_numbers(law);
  std::vector<std::vector<double>> rows(columns.front().size(), best);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto of = [&](std::size_t j) { return columns[j][r]; };
    rows[r][0] = std::exp(of(0));
    for (std::size_t j = 1; j < fit.planes.parameters.size(); ++j) rows[r][j] = of(j);
    std::size_t next = kCrowdParameters.size();
    for (const PartnerFit& own : fit.partners)
      for (std::size_t k = 0; k < own.ratios.size(); ++k) {
        rows[r][next++] = std::exp(of(own.first + k));
        rows[r][next++] = of(own.first + own.ratios.size());
      }
  }
  return rows;
}

double end_ratio(const CrowdModel& model, const CrowdStates& c) {
  const CrowdState& last = *loading_states(c).back();
  double law = 0.0;
  double mean = 0.0;
  const std::vector<double> force = crowd_forces(model, c.configuration->partners, last.overlap);
  for (std::size_t k = 0; k < force.size(); ++k) {
    law += force[k];
    mean += last.mean[k];
  }
  return mean > 0.0 ? law / mean : 0.0;
}

double noise(const CrowdStates& c) {
  double error = 0.0;
  double all = 0.0;
  for (const CrowdState* s : loading_states(c))
    for (std::size_t k = 0; k < s->mean.size(); ++k) {
      error += s->error[k] * s->error[k];
      all += s->mean[k] * s->mean[k];
    }
  return all > 0.0 ? std::sqrt(error / all) : 0.0;
}

void judge(CrowdLaw& law, const FormFit& fit, const std::vector<CrowdStates>& states, double discrepancy) {
  double sums[2] = {0.0, 0.0};
  int counts[2] = {0, 0};
  for (const CrowdStates& c : states) {
    if (c.states.empty() || loading_states(c).empty() || !(c.largest_force() > 0.0)) continue;
    ConfigurationError e{c.configuration->name,   c.use,    crowd_error(fit.model, c),
                         end_ratio(fit.model, c), noise(c), loading_states(c).back()->packings};
    e.in_proportion = c.configuration->in_proportion();
    if (c.use != CrowdUse::repeated && law.form != Crowd::pair && !c.for_crowds) e.use = CrowdUse::apart;
    if (e.use == CrowdUse::predicted) e.offset = form_offset(fit.model, c, discrepancy);
    law.errors.push_back(e);
    if (e.use == CrowdUse::repeated || e.use == CrowdUse::apart) continue;
    const bool out = c.use == CrowdUse::predicted;
    sums[out ? 1 : 0] += e.error;
    ++counts[out ? 1 : 0];
  }
  if (counts[0] > 0) law.error_fitted = sums[0] / counts[0];
  if (counts[1] > 0) law.error_held_out = sums[1] / counts[1];
}

/// Leave one loading of planes, and around free shells of any neighbours, out of those that may be fitted, fit the
/// others, predict it; the pair law, which is fitted to one plane alone, predicts all others of planes. What is held
/// out has no say: errors on it would else be those of a law that was chosen by them. NaN when nothing can be left out.
double cross_validate(const FormFit& full, const std::vector<CrowdStates>& states, double discrepancy) {
  const Crowd form = full.model.crowd;
  // All forms are asked for the same loadings.
  const bool together = all_together(states, form);
  const Crowd as = form == Crowd::pair ? Crowd::bag : form;
  const bool any_kind = all_together(states, as);
  std::vector<double> errors(states.size(), kNaN);
  parallel_tasks(static_cast<std::int64_t>(states.size()), [&](std::int64_t number) {
    const auto k = static_cast<std::size_t>(number);
    const CrowdStates& c = states[k];
    if (!(any_kind ? serves(c, as) : serves(c, as, PartnerKind::plane)) || !(c.largest_force() > 0.0)) return;
    StateSelection rest = plane_selection(states, form);
    std::erase(rest, &c);
    if (rest.empty()) return;  // nothing else to predict it from
    CrowdModel model = full.model;
    if (together)
      model = refitted(full, states, discrepancy, &c).model;
    else if (form != Crowd::pair)
      (void)fit_planes(model, rest, discrepancy, false);
    errors[k] = crowd_error(model, c);
  });
  std::erase_if(errors, [](double e) { return std::isnan(e); });
  return mean_error(errors).mean;
}

/// Corrected Akaike information criterion over all configurations of planes that may be fitted, with errors of known
/// size: S + 2 k + 2 k (k + 1)/(n - k - 1).
double criterion(const FormFit& fit, const std::vector<CrowdStates>& states, double discrepancy) {
  const auto r = crowd_residuals(fit.model, plane_selection(states, Crowd::bag), discrepancy);
  double s = 0.0;
  for (const double x : r) s += x * x;
  const auto k = static_cast<double>(fit.planes.parameters.size());
  const auto n = static_cast<double>(r.size());
  return n > k + 1.0 ? s + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0) : HUGE_VAL;
}

void set_status(CrowdLaw& law, const FormFit& fit, const std::vector<CrowdStates>& states) {
  const CrowdPressure& p = fit.model.form.pressure;
  double deepest = 0.0;
  for (const CrowdStates& c : states)
    if (serves(c, fit.model.crowd, PartnerKind::plane))
      for (const CrowdState& s : c.states)
        deepest = std::max(deepest, *std::max_element(s.overlap.begin(), s.overlap.end()));
  if (!(p.delta < deepest)) {
    law.status = LawStatus::no_threshold_crossing;
    law.reason = fmt::format("the threshold {:.3f} lies beyond the largest overlap {:.3f}", p.delta, deepest);
  } else if (const std::string trouble = fit.trouble(); !trouble.empty()) {
    law.status = LawStatus::underdetermined;
    law.reason = trouble;
  }
}

/// A law and the replicates behind each row of CrowdLaw::replicates.
struct FittedLaw {
  CrowdLaw law;
  std::vector<int> draws;
};

FittedLaw make_law(const CrowdMeasurements& data, const std::vector<CrowdStates>& states, Crowd form,
                   const CrowdFitOptions& options) {
  const FormFit fit = fit_form(form, states, options.discrepancy, true, starting_model(form));
  FittedLaw out;
  CrowdLaw& law = out.law;
  law.form = form;
  law.parameters = static_cast<int>(fit.planes.parameters.size());
  const FormRefits refits = refit_form(data, states, form, fit, options);
  law.replicates_failed = refits.failed;
  const Filler filler(fit, refits.columns, data.packings.size());
  filler.planes(law);
  for (const PartnerFit& own : fit.partners) filler.partners(law, states, own);
  law.replicates = replicate_rows(law, fit, refits.columns);
  out.draws = refits.draws;
  set_status(law, fit, states);
  judge(law, fit, states, options.discrepancy);
  law.error_cross = cross_validate(fit, states, options.discrepancy);
  law.criterion = criterion(fit, states, options.discrepancy);
  return out;
}

/// Of the packings and the law of every replicate.
std::vector<SideValues> drawn_sides(const CrowdMeasurements& data, const FittedLaw& fitted, const CrowdFitOptions& o) {
  std::vector<SideValues> out;
  for (std::size_t k = 0; k < fitted.draws.size(); ++k)
    out.push_back(side_values(average_states(data, packing_weights(data.packings.size(), o.seed, fitted.draws[k])),
                              crowd_model(with_numbers(fitted.law, fitted.law.replicates[k]))));
  return out;
}

/// What is far off on loadings that it has not seen is no law to use, however well it was fitted. Said after the choice
/// of form, in which held-out loadings have no part.
void judge_accuracy(CrowdLaw& law, double largest) {
  if (law.status != LawStatus::good) return;
  const bool held_out = law.error_held_out > largest;
  if (!held_out && !(law.error_cross > largest)) return;
  law.status = LawStatus::inaccurate;
  law.reason = fmt::format(
      "off by {:.0f} % on {}; at most {:.0f} % are allowed", 100.0 * (held_out ? law.error_held_out : law.error_cross),
      held_out ? "loadings that were held out" : "fitted loadings when each is left out", 100.0 * largest);
}

/// Nothing measured at all, or no force anywhere: there is no law to fit.
void require_data(const CrowdMeasurements& data, const std::vector<CrowdStates>& states, const CrowdFitOptions& o) {
  if (static_cast<int>(data.packings.size()) < o.min_packings)
    throw BadInput(fmt::format("crowd laws: {} packings are too few, at least {} are needed", data.packings.size(),
                               o.min_packings));
  double force = 0.0;
  for (const CrowdStates* c : plane_selection(states, Crowd::pair)) force = std::max(force, c->largest_force());
  if (!(force > 0.0))
    throw NotUsable(
        "crowd laws: no configuration with one plane crossed its threshold (no force at any recorded overlap); press "
        "deeper");
}

void describe_packings(const CrowdMeasurements& data, LawTableEntry& entry) {
  Tally fractions;
  for (const PackingInfo& p : data.packings) fractions.add(p.solid_fraction);
  const MeanError m = fractions.statistics();
  entry.solid_fraction = m.mean;
  entry.solid_fraction_error = m.error;
  entry.packings = static_cast<int>(data.packings.size());
  for (const PackingInfo& p : data.packings)
    entry.grains += static_cast<double>(p.grains) / static_cast<double>(data.packings.size());
}

void describe_range(const std::vector<CrowdStates>& states, const CrowdModel& model, LawTableEntry& entry) {
  for (const CrowdStates& c : states) {
    if (!serves(c, model.crowd, PartnerKind::plane)) continue;
    for (const CrowdState* s : loading_states(c)) {
      entry.volume_max = std::max(entry.volume_max, crowd_volume(model, c.configuration->partners, s->overlap));
      entry.grain_overlap_max = std::max(entry.grain_overlap_max, s->max_overlap);
      for (const double x : s->overlap) entry.overlap_max = std::max(entry.overlap_max, x);
    }
  }
}

}  // namespace

LawTableEntry fit_crowd_laws(const CrowdMeasurements& measured, const CrowdFitOptions& options) {
  const CrowdMeasurements data = mean_over_orientations(measured);
  const std::vector<CrowdStates> states = average_states(data);
  require_data(data, states, options);
  LawTableEntry entry;
  entry.spec = data.spec;
  entry.relaxation = data.relaxation;
  describe_packings(data, entry);
  std::vector<FittedLaw> laws;
  for (const Word<Crowd>& form : words<Crowd>) laws.push_back(make_law(data, states, form.value, options));
  // What the data do not determine is not preferred, however well it follows them.
  const auto rank = [&](const FittedLaw& f) {
    const CrowdLaw& law = f.law;
    return std::tuple{options.best && law.form != *options.best, law.status != LawStatus::good,
                      std::isnan(law.error_cross) ? HUGE_VAL : law.error_cross, law.parameters};
  };
  const auto best = std::min_element(laws.begin(), laws.end(),
                                     [&](const FittedLaw& a, const FittedLaw& b) { return rank(a) < rank(b); });
  entry.best = best->law.form;
  const CrowdModel model = crowd_model(best->law);
  describe_range(states, model, entry);
  fit_sides(side_values(states, model), drawn_sides(data, *best, options), options.seed, entry);
  for (FittedLaw& f : laws) {
    judge_accuracy(f.law, options.largest_error);
    entry.laws.push_back(std::move(f.law));
  }
  return entry;
}

}  // namespace softgrain
