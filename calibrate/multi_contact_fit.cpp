#include "calibrate/multi_contact_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <tuple>

#include "calibrate/bootstrap.h"
#include "calibrate/multi_contact_side_fits.h"
#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/parallel_tasks.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/multi_contact_replicates.h"

namespace softgrain {

namespace {

/// Where the fit of the planes starts: near what the published soft particle gives.
MultiContactModel starting_model(LawForm form) {
  MultiContactModel model;
  model.multi_contact = form;
  model.form.pressure = {0.7, 2.9, 0.08};
  model.form.coupling = model.multi_contact == LawForm::directional ? MultiContactCoupling{0.6, 0.9, 0.4}
                                                                    : MultiContactCoupling{1.0, 0.0, 0.0};
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
  if (!std::isfinite(sd) && !(scatter_of(replicates) > 0.0))  // refits that all stay where they start tell nothing
    return kind == NumberKind::logarithm ? Estimate{std::exp(value), kInfinity, 0.0, kInfinity}
                                         : Estimate{value, kInfinity, positive ? 0.0 : -kInfinity, kInfinity};
  if (replicates.size() < kEnoughReplicates) {
    std::tie(low, high) = student_interval(value, sd, static_cast<double>(packings) - 1.0);
    if (positive) low = std::max(0.0, low);
  } else {
    std::tie(low, high) = widened(value, low, high, few_samples_factor(packings), positive);
    sd = std::max(sd, scatter_of(replicates));
  }
  if (kind != NumberKind::logarithm) return {value, sd, low, high};
  return {std::exp(value), std::exp(value) * sd, std::exp(low), std::exp(high)};
}

/// Packings that something was measured on; there may be more to draw from.
std::set<std::int64_t> measured_packings(const MultiContactMeasurements& data) {
  std::set<std::int64_t> out;
  for (const MultiContactRun& run : data.runs)
    if (!run.points.empty()) out.insert(run.packing);
  return out;
}

class Filler {
 public:
  Filler(const FormFit& fit, std::vector<std::vector<double>> columns, std::size_t packings)
      : fit_(fit), columns_(std::move(columns)), packings_(packings) {}

  void planes(MultiContactLaw& law) const {
    law.a = estimate(fit_.planes, 0, columns_[0], packings_, NumberKind::logarithm);
    law.b = estimate(fit_.planes, 1, columns_[1], packings_, NumberKind::positive);
    law.delta = estimate(fit_.planes, 2, columns_[2], packings_, NumberKind::positive);
    const MultiContactCoupling& m = fit_.model.form.coupling;
    law.m0.value = m.m0;
    if (fit_.model.multi_contact != LawForm::directional) return;
    law.m0 = estimate(fit_.planes, 3, columns_[3], packings_, NumberKind::any);
    law.m1 = estimate(fit_.planes, 4, columns_[4], packings_, NumberKind::any);
    law.m2 = estimate(fit_.planes, 5, columns_[5], packings_, NumberKind::any);
  }

  void partners(MultiContactLaw& law, const std::vector<MultiContactStates>& states, const PartnerFit& own) const {
    const std::size_t ratios = own.ratios.size();
    const std::size_t of_kind = packings_with(states, own.kind, {});
    for (std::size_t k = 0; k < ratios; ++k) {
      const std::size_t of_row = packings_with(states, own.kind, own.ratios[k]);
      PartnerRow row{own.kind,
                     own.ratios[k],
                     estimate(own.fit, k, columns_[own.first + k], of_row, NumberKind::logarithm),
                     estimate(own.fit, ratios, columns_[own.first + ratios], of_kind, NumberKind::positive),
                     0.0,
                     0.0};
      describe(row, states);
      law.partners.push_back(row);
    }
  }

 private:
  /// Whether neighbours of a configuration are those of a row: of this kind and, if it is given, this ratio.
  [[nodiscard]] bool has(const MultiContactStates& c, PartnerKind kind, std::optional<double> ratio) const {
    const MultiContactPartner& first = c.configuration->partners.front();
    const bool own =
        serves(c, fit_.model.multi_contact) && c.all_of(kind) && first.smooth == (kind == PartnerKind::plane);
    return own && (!ratio || table_ratio(first) == *ratio);
  }

  /// Number of packings behind such rows: of the configuration that was measured on the most. A configuration may have
  /// fewer than the table.
  [[nodiscard]] std::size_t packings_with(const std::vector<MultiContactStates>& states, PartnerKind kind,
                                          std::optional<double> ratio) const {
    std::int64_t most = 0;
    for (const MultiContactStates& c : states)
      if (has(c, kind, ratio))
        for (const MultiContactState* s : loading_states(c)) most = std::max(most, s->packings);
    return most > 0 ? std::min(packings_, static_cast<std::size_t>(most)) : packings_;
  }

  /// Range and error of one row, from the configurations that have this neighbour.
  void describe(PartnerRow& row, const std::vector<MultiContactStates>& states) const {
    const bool smooth = row.kind == PartnerKind::plane;
    for (const MultiContactStates& c : states) {
      if (!has(c, row.kind, row.ratio)) continue;
      for (const MultiContactState* s : loading_states(c))
        for (std::size_t k = 0; k < c.configuration->touching(); ++k)
          row.overlap_max = std::max(
              row.overlap_max, s->overlap[k] / (smooth ? 1.0 : std::min(1.0, c.configuration->partners[k].ratio)));
      row.error = std::max(row.error, multi_contact_error(fit_.model, c));
    }
  }

  const FormFit& fit_;
  std::vector<std::vector<double>> columns_;
  std::size_t packings_;
};

/// The replicates as rows of multi_contact_numbers() of this law.
std::vector<std::vector<double>> replicate_rows(const MultiContactLaw& law, const FormFit& fit,
                                                const std::vector<std::vector<double>>& columns) {
  const std::vector<double> best = multi_contact_numbers(law);
  std::vector<std::vector<double>> rows(columns.front().size(), best);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto of = [&](std::size_t j) { return columns[j][r]; };
    rows[r][0] = std::exp(of(0));
    for (std::size_t j = 1; j < fit.planes.parameters.size(); ++j) rows[r][j] = of(j);
    std::size_t next = kMultiContactParameters.size();
    for (const PartnerFit& own : fit.partners)
      for (std::size_t k = 0; k < own.ratios.size(); ++k) {
        rows[r][next++] = std::exp(of(own.first + k));
        rows[r][next++] = of(own.first + own.ratios.size());
      }
  }
  return rows;
}

double end_ratio(const MultiContactModel& model, const MultiContactStates& c) {
  const MultiContactState& last = *loading_states(c).back();
  double law = 0.0;
  double mean = 0.0;
  const std::vector<double> force = multi_contact_forces(model, c.configuration->partners, last.overlap);
  for (std::size_t k = 0; k < force.size(); ++k) {
    law += force[k];
    mean += last.mean[k];
  }
  return mean > 0.0 ? law / mean : 0.0;
}

double noise(const MultiContactStates& c) {
  double error = 0.0;
  double all = 0.0;
  for (const MultiContactState* s : loading_states(c))
    for (std::size_t k = 0; k < s->mean.size(); ++k) {
      error += s->error[k] * s->error[k];
      all += s->mean[k] * s->mean[k];
    }
  return all > 0.0 ? std::sqrt(error / all) : 0.0;
}

/// Means over the configurations of the fit, and over those left out of it.
void set_mean_errors(MultiContactLaw& law) {
  double sums[2] = {0.0, 0.0};
  int counts[2] = {0, 0};
  for (const ConfigurationError& e : law.errors) {
    if (e.use == MultiContactUse::repeated || e.use == MultiContactUse::apart) continue;
    const bool out = e.use == MultiContactUse::predicted;
    sums[out ? 1 : 0] += e.error;
    ++counts[out ? 1 : 0];
  }
  if (counts[0] > 0) law.error_fitted = sums[0] / counts[0];
  if (counts[1] > 0) law.error_held_out = sums[1] / counts[1];
}

void judge(MultiContactLaw& law, const FormFit& fit, const std::vector<MultiContactStates>& states,
           double discrepancy) {
  for (const MultiContactStates& c : states) {
    if (c.states.empty() || loading_states(c).empty() || !(c.largest_force() > 0.0)) continue;
    ConfigurationError e{c.configuration->name,   c.use,    multi_contact_error(fit.model, c),
                         end_ratio(fit.model, c), noise(c), loading_states(c).back()->packings};
    e.in_proportion = c.configuration->in_proportion();
    const bool foreign =
        law.form == LawForm::pair ? c.use == MultiContactUse::fitted && !serves(c, law.form) : !c.for_multi_contact;
    if (c.use != MultiContactUse::repeated && foreign) e.use = MultiContactUse::apart;
    if (e.use == MultiContactUse::predicted) e.offset = form_offset(fit.model, c, discrepancy);
    law.errors.push_back(e);
  }
  set_mean_errors(law);
}

/// Leave one loading of planes, and around free shells of any neighbours, out of those that may be fitted, fit the
/// others, predict it; the pair law, which is fitted to one plane alone, predicts all others of planes. What is held
/// out has no say: errors on it would else be those of a law that was chosen by them. NaN when nothing can be left out.
double cross_validate(const FormFit& full, const std::vector<MultiContactStates>& states, double discrepancy) {
  const LawForm form = full.model.multi_contact;
  // All forms are asked for the same loadings.
  const bool together = all_together(states, form);
  const LawForm as = form == LawForm::pair ? LawForm::isotropic : form;
  const bool any_kind = all_together(states, as);
  std::vector<double> errors(states.size(), kNaN);
  parallel_tasks(static_cast<std::int64_t>(states.size()), [&](std::int64_t number) {
    const auto k = static_cast<std::size_t>(number);
    const MultiContactStates& c = states[k];
    if (!(any_kind ? serves(c, as) : serves(c, as, PartnerKind::plane)) || !(c.largest_force() > 0.0)) return;
    StateSelection rest = plane_selection(states, form);
    std::erase(rest, &c);
    if (rest.empty()) return;  // nothing else to predict it from
    MultiContactModel model = full.model;
    if (together)
      model = refitted(full, states, discrepancy, &c).model;
    else if (form != LawForm::pair)
      (void)fit_planes(model, rest, discrepancy, false);
    errors[k] = multi_contact_error(model, c);
  });
  std::erase_if(errors, [](double e) { return std::isnan(e); });
  return mean_error(errors).mean;
}

/// Corrected Akaike information criterion over all configurations of planes that may be fitted, with errors of known
/// size: S + 2 k + 2 k (k + 1)/(n - k - 1).
double criterion(const FormFit& fit, const std::vector<MultiContactStates>& states, double discrepancy) {
  const auto r = multi_contact_residuals(fit.model, plane_selection(states, LawForm::isotropic), discrepancy);
  double s = 0.0;
  for (const double x : r) s += x * x;
  const auto k = static_cast<double>(fit.planes.parameters.size());
  const auto n = static_cast<double>(r.size());
  return n > k + 1.0 ? s + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0) : HUGE_VAL;
}

void set_status(MultiContactLaw& law, const FormFit& fit, const std::vector<MultiContactStates>& states) {
  const MultiContactPressure& p = fit.model.form.pressure;
  double deepest = 0.0;
  for (const MultiContactStates& c : states)
    if (serves(c, fit.model.multi_contact, PartnerKind::plane))
      for (const MultiContactState& s : c.states)
        deepest = std::max(deepest, *std::max_element(s.overlap.begin(), s.overlap.end()));
  if (!(p.delta < deepest)) {
    law.status = LawStatus::no_threshold_crossing;
    law.reason = fmt::format("the threshold {:.3f} lies beyond the largest overlap {:.3f}", p.delta, deepest);
  } else if (const std::string trouble = fit.trouble(); !trouble.empty()) {
    law.status = LawStatus::underdetermined;
    law.reason = trouble;
  }
}

/// A law and the replicates behind each row of MultiContactLaw::replicates.
struct FittedLaw {
  MultiContactLaw law;
  std::vector<int> draws;
};

FittedLaw make_law(const MultiContactMeasurements& data, const std::vector<MultiContactStates>& states, LawForm form,
                   const MultiContactFitOptions& options) {
  const FormFit fit = fit_form(form, states, options.discrepancy, true, starting_model(form));
  FittedLaw out;
  MultiContactLaw& law = out.law;
  law.form = form;
  law.parameters = static_cast<int>(fit.planes.parameters.size());
  const FormRefits refits = refit_form(data, states, form, fit, options);
  law.replicates_failed = refits.failed;
  const Filler filler(fit, refits.columns, measured_packings(data).size());
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

/// Side values from the packings and the law of every replicate.
std::vector<SideValues> drawn_sides(const MultiContactMeasurements& data, const FittedLaw& fitted,
                                    const MultiContactFitOptions& o) {
  std::vector<SideValues> out;
  for (std::size_t k = 0; k < fitted.draws.size(); ++k)
    out.push_back(side_values(average_states(data, packing_weights(data.packings.size(), o.seed, fitted.draws[k])),
                              multi_contact_model(with_numbers(fitted.law, fitted.law.replicates[k]))));
  return out;
}

/// What is far off on loadings that it has not seen is no law to use, however well it was fitted. Said after the choice
/// of form, in which held-out loadings have no part.
void judge_accuracy(MultiContactLaw& law, double largest) {
  if (law.status != LawStatus::good) return;
  const bool held_out = law.error_held_out > largest;
  if (!held_out && !(law.error_cross > largest)) return;
  law.status = LawStatus::inaccurate;
  law.reason = fmt::format(
      "off by {:.0f} % on {}; at most {:.0f} % are allowed", 100.0 * (held_out ? law.error_held_out : law.error_cross),
      held_out ? "loadings that were held out" : "fitted loadings when each is left out", 100.0 * largest);
}

/// Nothing measured at all, or no force anywhere: there is no law to fit.
void require_data(const MultiContactMeasurements& data, const std::vector<MultiContactStates>& states,
                  const MultiContactFitOptions& o) {
  if (static_cast<int>(data.packings.size()) < o.min_packings)
    throw InputError(fmt::format("multi-contact laws: only {}, at least {} are needed",
                                 counted(data.packings.size(), "packing"), o.min_packings));
  if (const std::size_t measured = measured_packings(data).size(); measured < static_cast<std::size_t>(o.min_packings))
    throw UnusableResult(fmt::format("multi-contact laws: measured on {} only, at least {} are needed",
                                     counted(measured, "packing"), o.min_packings));
  double force = 0.0;
  for (const MultiContactStates* c : plane_selection(states, LawForm::pair))
    force = std::max(force, c->largest_force());
  if (!(force > 0.0))
    throw UnusableResult(
        "multi-contact laws: no configuration with one plane crossed its threshold (no force at any recorded overlap); "
        "press deeper");
}

void describe_packings(const MultiContactMeasurements& data, LawTableEntry& entry) {
  Tally fractions;
  const std::set<std::int64_t> measured = measured_packings(data);
  for (const std::int64_t k : measured) {
    const PackingInfo& p = data.packings[static_cast<std::size_t>(k)];
    fractions.add(p.solid_fraction);
    entry.grains += static_cast<double>(p.grains) / static_cast<double>(measured.size());
  }
  const MeanError m = fractions.statistics();
  entry.solid_fraction = m.mean;
  entry.solid_fraction_error = m.error;
  entry.packings = static_cast<int>(measured.size());
}

void describe_range(const std::vector<MultiContactStates>& states, const MultiContactModel& model,
                    LawTableEntry& entry) {
  for (const MultiContactStates& c : states) {
    if (!serves(c, model.multi_contact, PartnerKind::plane)) continue;
    for (const MultiContactState* s : loading_states(c)) {
      entry.volume_max = std::max(entry.volume_max, multi_contact_volume(model, c.configuration->partners, s->overlap));
      entry.grain_overlap_max = std::max(entry.grain_overlap_max, s->max_overlap);
      for (const double x : s->overlap) entry.overlap_max = std::max(entry.overlap_max, x);
    }
  }
}

}  // namespace

void judge_again(MultiContactLaw& law, const MultiContactMeasurements& measured, double discrepancy) {
  const MultiContactMeasurements data = mean_over_orientations(measured);
  const MultiContactModel model = multi_contact_model(law);
  for (const MultiContactStates& c : average_states(data)) {
    if (c.states.empty() || loading_states(c).empty()) continue;
    for (ConfigurationError& e : law.errors) {
      if (e.name != c.configuration->name) continue;
      e.error = multi_contact_error(model, c);
      e.end_ratio = end_ratio(model, c);
      if (e.offset) e.offset = form_offset(model, c, discrepancy);
    }
  }
  set_mean_errors(law);
}

LawTableEntry fit_multi_contact_laws(const MultiContactMeasurements& measured, const MultiContactFitOptions& options) {
  const MultiContactMeasurements data = mean_over_orientations(measured);
  const std::vector<MultiContactStates> states = average_states(data);
  require_data(data, states, options);
  LawTableEntry entry;
  entry.spec = data.spec;
  entry.relaxation = data.relaxation;
  describe_packings(data, entry);
  std::vector<FittedLaw> laws;
  for (const EnumName<LawForm>& form : enum_names<LawForm>) laws.push_back(make_law(data, states, form.value, options));
  // What the data do not determine is not preferred, however well it follows them.
  const auto rank = [&](const FittedLaw& f) {
    const MultiContactLaw& law = f.law;
    return std::tuple{options.best && law.form != *options.best, law.status != LawStatus::good,
                      std::isnan(law.error_cross) ? HUGE_VAL : law.error_cross, law.parameters};
  };
  const auto best = std::min_element(laws.begin(), laws.end(),
                                     [&](const FittedLaw& a, const FittedLaw& b) { return rank(a) < rank(b); });
  entry.best = best->law.form;
  const MultiContactModel model = multi_contact_model(best->law);
  describe_range(states, model, entry);
  fit_sides(side_values(states, model), drawn_sides(data, *best, options), options.seed, entry);
  for (FittedLaw& f : laws) {
    judge_accuracy(f.law, options.largest_error);
    entry.laws.push_back(std::move(f.law));
  }
  return entry;
}

}  // namespace softgrain
