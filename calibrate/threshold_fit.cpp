#include "calibrate/threshold_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "calibrate/bootstrap.h"
#include "calibrate/threshold_model.h"
#include "common/core/error.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

/// Clear points (mean above noise and two standard errors) that each curve needs: normal a, b, delta; tangential a, b.
constexpr std::array<std::size_t, kLawCurves> kClearNeeded{3, 2, 2};
constexpr std::array<const char*, kLawCurves> kCurveNames{"normal force", "initial tangential stiffness",
                                                          "secant tangential stiffness"};
/// Share of replicates beyond which an interval end is not determined.
constexpr double kTolerableShare = 0.025;

void require_valid(const FitOptions& o) {
  if (!(o.initial_angle_deg > 0.0) || !(o.secant_angle_deg.value_or(kSecantAngle) > 0.0))
    throw InputError("fit: angles must be above 0 degrees");
  if (!(o.delta_high > o.delta_low) || o.delta_low < 0.0)
    throw InputError(fmt::format("fit: range of Delta [{}, {}] must rise from 0 or above", o.delta_low, o.delta_high));
  if (!(o.noise_floor >= 0.0))
    throw InputError(fmt::format("fit: noise_floor = {}: must be 0 or above", o.noise_floor));
  if (!(o.scatter_floor > 0.0 && o.scatter_floor <= 1.0))
    throw InputError(fmt::format("fit: scatter_floor = {}: must lie in (0, 1]", o.scatter_floor));
  if (o.min_packings < 2) throw InputError(fmt::format("fit: min_packings = {}: must be 2 or above", o.min_packings));
  if (o.replicates < 0) throw InputError(fmt::format("fit: replicates = {}: must be 0 or above", o.replicates));
}

RunList select_runs(const Measurements& data, PairKind kind, const std::string& relaxation) {
  RunList runs;
  for (const PackingRun& run : data.runs)
    if (run.kind == kind && run.relaxation == relaxation) runs.push_back(&run);
  return runs;
}

/// Deltas whose mean is above the noise floor and above two standard errors; `single` holds the errors of one value.
std::vector<double> clear_deltas(const CurveMeans& means, const std::vector<double>& single, double noise_floor) {
  std::vector<double> out;
  for (std::size_t k = 0; k < means.delta.size(); ++k) {
    const double standard_error = single[k] / std::sqrt(std::max(means.count[k], 1.0));
    if (means.mean[k] > noise_floor && means.mean[k] > 2.0 * standard_error) out.push_back(means.delta[k]);
  }
  return out;
}

/// Why clear_deltas() finds nothing up to `end`: forces that are too small, or samples that differ too much.
std::string nothing_clear_text(const CurveMeans& means, const std::vector<double>& single, double noise_floor,
                               double end) {
  const auto k = static_cast<std::size_t>(std::ranges::max_element(means.mean) - means.mean.begin());
  if (!(means.mean[k] > noise_floor))
    return fmt::format(
        "no mean force above the noise floor {:.1e} E Rs^2 up to Delta = {:.4g} (largest mean {:.1e} E Rs^2)",
        noise_floor, end, means.mean[k]);
  const double count = std::max(means.count[k], 1.0);
  return fmt::format(
      "no mean force stays above two standard errors up to Delta = {:.4g} (largest mean {:.1e} +- {:.1e} E Rs^2, of "
      "{})",
      end, means.mean[k], single[k] / std::sqrt(count), counted(std::llround(count), "value"));
}

/// The force of one curve does not fall again: a point above two standard errors with points below behind it is noise.
std::vector<double> without_early_noise(const std::vector<double>& clear, const CurveMeans& means) {
  std::size_t first = means.delta.size();
  for (std::size_t left = clear.size(); first > 0 && left > 0 && means.delta[first - 1] == clear[left - 1]; --left)
    --first;
  std::vector<double> out;
  for (const double d : clear)
    if (first < means.delta.size() && d >= means.delta[first]) out.push_back(d);
  return out;
}

/// One fit in the making: samples, means, and the reasons against using it.
struct Work {
  LawSamples samples;
  LawMeans means;
  std::array<std::vector<double>, kLawCurves> sigma;  ///< error of a single value, as the fit weights it
  std::array<std::vector<double>, kLawCurves> clear;
  FitCurves curves;
  double delta_limit = 0.0;
  JointFit joint;
  std::vector<std::string> reasons;
};

Work collect(const RunList& runs, const SoftParticleSpec& spec, const FitOptions& options, double secant_angle) {
  const CurveSelection selection{options.delta_low, options.delta_high, options.initial_angle_deg, secant_angle};
  Work w;
  w.samples = {normal_samples(runs, spec, selection), initial_slope_samples(runs, spec, selection),
               secant_samples(runs, spec, selection)};
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    w.means[j] = means_of(w.samples[j]);
    w.sigma[j] = options.experiment ? experiment_errors(w.samples[j], w.means[j],
                                                        j == 0 ? options.given_errors : std::vector<GivenError>{},
                                                        options.scatter_floor)
                                    : floored_deviations(w.means[j], options.scatter_floor);
    w.clear[j] = clear_deltas(w.means[j], options.experiment ? w.sigma[j] : w.means[j].deviation, options.noise_floor);
    if (options.experiment) w.clear[j] = without_early_noise(w.clear[j], w.means[j]);
  }
  return w;
}

/// Chooses the curves that can be fitted and the largest threshold that leaves enough clear points above it.
void prepare(Work& w) {
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (w.samples[j].empty()) continue;
    if (w.clear[j].size() < kClearNeeded[j])
      w.reasons.push_back(fmt::format("{}: {} clearly above zero, {} needed", kCurveNames[j],
                                      counted(w.clear[j].size(), "point"), kClearNeeded[j]));
    if (j > 0 && w.clear[j].size() < kClearNeeded[j]) continue;
    w.curves[j] = {w.means[j], w.sigma[j]};
  }
  const std::vector<double>& clear = w.clear[0];
  w.delta_limit = clear.size() >= 3 ? clear[clear.size() - 3] : clear.back();
}

/// Reasons that the fit itself gives against its use.
void judge_fit(Work& w) {
  const JointFit& joint = w.joint;
  if (joint.fit.rank_deficient)
    w.reasons.push_back("rank-deficient covariance: " + joint.fit.message);
  else if (joint.fit.end != FitEnd::converged)
    w.reasons.push_back("the optimiser did not converge: " + joint.fit.message);
  if (joint.delta_at_zero) w.reasons.emplace_back("delta is at its lower bound 0: the data show no threshold");
  if (joint.delta_at_limit)
    w.reasons.push_back(
        fmt::format("delta is at its upper bound {:.4g}, where three clear points are left", w.delta_limit));
  for (std::size_t j = 0; j < kLawCurves; ++j)
    if (joint.exponent_at_bound[j])
      w.reasons.push_back(
          fmt::format("exponent of the {} is at its bound {:.4g}", kCurveNames[j], joint.parameters.exponent[j]));
}

/// Overlaps above the threshold that hold the normal force, less its numbers a, b and delta.
std::ptrdiff_t normal_freedom(const Work& w) {
  const std::vector<double>& delta = w.means[0].delta;
  const auto above = std::ranges::count_if(delta, [&](double d) { return d > w.joint.parameters.delta; });
  return above - static_cast<std::ptrdiff_t>(kClearNeeded[0]);
}

/// Why the points say no errors of the normal law; empty: they do. Single curves that go through all their points have
/// no residuals to tell errors by; packings scatter even then.
std::string without_errors(const Work& w, bool from_residuals) {
  const std::ptrdiff_t freedom = normal_freedom(w);
  if (freedom >= (from_residuals ? 1 : 0)) return "";
  const auto needed = static_cast<std::ptrdiff_t>(kClearNeeded[0]);
  return fmt::format(
      "{} overlap{} above the threshold for the {} numbers a, b and delta: errors are not determined, "
      "{} are needed",
      freedom + needed, freedom + needed == 1 ? "" : "s", needed, needed + (from_residuals ? 1 : 0));
}

void run_bootstrap(const FitOptions& options, Work& w, FitReport& report) {
  report.from_residuals = options.experiment && report.law.packings < options.min_packings;
  const bool enough = report.from_residuals || report.law.packings >= options.min_packings;
  if (!enough)
    w.reasons.push_back(fmt::format("{} packing{}, {} needed for an interval", report.law.packings,
                                    report.law.packings == 1 ? "" : "s", options.min_packings));
  else if (options.replicates < 1)
    w.reasons.emplace_back("no bootstrap replicates were asked for");
  const std::string unknown = without_errors(w, report.from_residuals);
  if (!unknown.empty()) w.reasons.push_back(unknown);
  if (!enough || options.replicates < 1 || w.joint.fit.rank_deficient || !unknown.empty()) return;
  report.drawn_packings = report.from_residuals ? 0 : static_cast<std::size_t>(report.law.packings);
  BootstrapInput input{w.samples,           w.curves, w.delta_limit, w.joint.parameters, {}, options.scatter_floor,
                       options.zeroed_below};
  const std::uint64_t stream = static_cast<std::uint64_t>(report.law.kind) + 1;
  BootstrapResult result =
      report.from_residuals ? residual_bootstrap(input, options.given_errors, options.replicates, options.seed, stream)
                            : bootstrap(input, options.replicates, options.seed, stream);
  report.replicates = std::move(result.replicates);
  report.replicates_failed = result.failed;
  report.replicates_at_bound = result.at_bound;
  const double total = options.replicates;
  if (result.failed > kTolerableShare * total)
    w.reasons.push_back(
        fmt::format("{:.1f} % of bootstrap replicates are rank-deficient", 100.0 * result.failed / total));
  if (result.at_bound > kTolerableShare * total)
    w.reasons.push_back(fmt::format("unbounded interval: {:.1f} % of bootstrap replicates ran to a bound",
                                    100.0 * result.at_bound / total));
}

void fill_law(const FitOptions& options, Work& w, FitReport& report) {
  PairLaw& law = report.law;
  law.covariance.assign(49, 0.0);
  run_bootstrap(options, w, report);
  const bool errors_known = (report.from_residuals ? report.replicates.size() >= 2 : law.packings >= 2) &&
                            !w.joint.fit.rank_deficient && without_errors(w, report.from_residuals).empty();
  if (errors_known)
    law.covariance = report.from_residuals
                         ? replicate_covariance(report.replicates)
                         : packing_covariance(w.joint, w.curves, {&w.samples[0], &w.samples[1], &w.samples[2]});
  const auto p = w.joint.parameters.law_parameters();
  law.normal = estimated_law(report, p, 0, errors_known);
  law.has_tangential_initial = w.curves[1].present();
  law.has_tangential_secant = w.curves[2].present();
  if (w.curves[1].present()) law.tangential_initial = estimated_law(report, p, 1, errors_known);
  if (w.curves[2].present()) law.tangential_secant = estimated_law(report, p, 2, errors_known);
  if (law.packings >= 2 || options.experiment) fill_goodness(w.curves, w.joint.parameters, options.noise_floor, law);
}

void conclude(PairLaw& law, LawStatus status, const std::vector<std::string>& reasons) {
  law.status = status;
  law.reason = join_text(reasons, "; ");
  if (!law.reason.empty()) law.reason += ".";
}

}  // namespace

double default_secant_angle(PairKind kind, const std::vector<const PackingRun*>& runs) {
  constexpr double kOfTwo = 0.5;
  const auto measured = [](const PackingRun* run) {
    return std::ranges::any_of(run->tangential,
                               [](const TangentialPoint& p) { return same_angle(std::abs(p.angle_deg), kOfTwo); });
  };
  const bool of_two = kind == PairKind::soft_soft && std::ranges::any_of(runs, measured);
  return of_two ? kOfTwo : kSecantAngle;
}

std::string chosen_relaxation(const Measurements& data, const FitOptions& options) {
  std::set<std::string> present;
  for (const PackingRun& run : data.runs) present.insert(run.relaxation);
  std::string names;
  for (const std::string& name : present) names += (names.empty() ? "\"" : ", \"") + name + "\"";
  if (present.empty()) throw InputError("fit: the measurements hold no runs");
  if (options.relaxation.empty() && present.size() > 1)
    throw InputError("fit: relaxation is not given and the measurements hold " + names + "; choose one");
  if (options.relaxation.empty()) return *present.begin();
  if (present.count(options.relaxation) == 0)
    throw InputError(fmt::format("fit: relaxation = \"{}\": the measurements hold {}", options.relaxation, names));
  return options.relaxation;
}

FitReport fit_pair_law(const Measurements& data, PairKind kind, const FitOptions& options) {
  require_valid(options);
  FitReport report;
  report.law.kind = kind;
  const RunList runs = select_runs(data, kind, chosen_relaxation(data, options));
  if (runs.empty()) {
    report.law.reason = "No measurements of this pair kind.";
    return report;
  }
  report.law.initial_angle_deg = options.initial_angle_deg;
  report.law.secant_angle_deg =
      options.secant_angle_deg.value_or(options.experiment ? kSecantAngle : default_secant_angle(kind, runs));
  Work w = collect(runs, data.spec, options, report.law.secant_angle_deg);
  describe_data(runs, w.samples, w.means, report);
  if (w.samples[0].empty()) {
    conclude(report.law, LawStatus::underdetermined, {"no converged normal point in the fitted range"});
    return report;
  }
  if (w.clear[0].empty()) {
    conclude(report.law, LawStatus::no_threshold_crossing,
             {nothing_clear_text(w.means[0], options.experiment ? w.sigma[0] : w.means[0].deviation,
                                 options.noise_floor, report.law.delta_max)});
    return report;
  }
  prepare(w);
  w.joint = fit_joint(w.curves, w.delta_limit);
  report.iterations = w.joint.fit.iterations;
  report.fit_message = w.joint.fit.message;
  judge_fit(w);
  fill_law(options, w, report);
  conclude(report.law, w.reasons.empty() ? LawStatus::good : LawStatus::underdetermined, w.reasons);
  return report;
}

void add_bands(PairLaw& law, const FitReport& report) {
  constexpr int kSteps = 120;
  if (report.replicates.empty() || !(law.delta_max > 0.0)) return;
  for (int k = 0; k <= kSteps; ++k) law.band_delta.push_back(law.delta_max * k / kSteps);
  const auto add = [&](const char* name, LawCurve curve) {
    LawBandRows rows{name, {}, {}};
    for (const Band& b : law_band(report, curve, law.band_delta)) {
      if (!std::isfinite(b.low) || !std::isfinite(b.high)) return;  // not determined: no band
      rows.low.push_back(b.low);
      rows.high.push_back(b.high);
    }
    law.bands.push_back(std::move(rows));
  };
  add("normal", LawCurve::normal);
  if (law.has_tangential_initial) add("tangential_initial", LawCurve::tangential_initial);
  if (law.has_tangential_secant) add("tangential_secant", LawCurve::tangential_secant);
}

LawCard calibrate(const Measurements& data, const FitOptions& options, std::vector<FitReport>* reports) {
  LawCard card;
  card.spec = data.spec;
  card.relaxation = chosen_relaxation(data, options);
  card.turn = data.turn;
  for (const PairKind kind : kPairKinds) {
    if (select_runs(data, kind, card.relaxation).empty()) continue;
    FitReport report = fit_pair_law(data, kind, options);
    card.pairs.push_back(report.law);
    add_bands(card.pairs.back(), report);
    if (reports != nullptr) reports->push_back(std::move(report));
  }
  return card;
}

}  // namespace softgrain
