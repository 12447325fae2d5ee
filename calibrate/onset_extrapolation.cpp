#include "calibrate/onset_extrapolation.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

#include "calibrate/bootstrap.h"
#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

struct Onsets {
  std::vector<double> span;
  std::vector<double> error;
};

double model(OnsetForm form, std::span<const double> p, double r) {
  if (form == OnsetForm::void_power) return 1.0 - std::exp(p[0] - p[1] * std::log(r));
  return p[0] - p[1] * std::pow(r, -p[2]);
}

std::size_t parameters_of(OnsetForm form) { return form == OnsetForm::void_power ? 2 : 3; }

/// Start values through the first and the last onset.
std::vector<std::vector<double>> starts(OnsetForm form, const Onsets& at, const std::vector<double>& onset) {
  const double low = at.span.front();
  const double high = at.span.back();
  const double first = onset.front();
  const double last = onset.back();
  if (form == OnsetForm::void_power) {
    const double b = std::clamp(std::log((1.0 - first) / (1.0 - last)) / std::log(high / low), 0.0, 5.0);
    return {{std::log(1.0 - first) + b * std::log(low), b}};
  }
  std::vector<std::vector<double>> out;
  for (const double b : {0.05, 0.2, 0.5, 1.0, 2.0}) {
    const double fall = std::pow(low, -b) - std::pow(high, -b);
    const double a = std::max(0.0, (last - first) / fall);
    out.push_back({std::clamp(last + a * std::pow(high, -b), 0.0, 1.0), std::min(a, 10.0), b});
  }
  return out;
}

LeastSquaresFit solve(OnsetForm form, const Onsets& at, const std::vector<double>& onset,
                      const std::vector<std::vector<double>>& from) {
  LeastSquaresProblem problem;
  problem.residuals = onset.size();
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
    for (std::size_t k = 0; k < onset.size(); ++k) r[k] = (model(form, p, at.span[k]) - onset[k]) / at.error[k];
    return true;
  };
  if (form == OnsetForm::void_power)
    problem.bounds = {{-20.0, 20.0}, {0.0, 5.0}};
  else
    problem.bounds = {{0.0, 1.0}, {0.0, 10.0}, {0.02, 5.0}};
  LeastSquaresOptions options;
  options.thorough = false;  // starts are many; a sum that is as small elsewhere gives the same value at small spans
  options.scale_covariance = false;
  LeastSquaresFit best;
  for (const auto& start : from) {
    LeastSquaresFit fit = fit_least_squares(problem, {start}, options);
    if (fit.residual_sum_of_squares < best.residual_sum_of_squares) best = std::move(fit);
  }
  return best;
}

/// A value is wanted, not its parameters: they may be correlated to any degree, as long as the sum of squares is a
/// number.
bool found(const LeastSquaresFit& fit) {
  return std::isfinite(fit.residual_sum_of_squares) && fit.end != FitEnd::failed && fit.end != FitEnd::not_run;
}

OnsetFormFit fit_form(OnsetForm form, const Onsets& at, const std::vector<double>& onset,
                      const std::vector<std::vector<double>>& replicates, int degrees, double span,
                      const OnsetOptions& options) {
  OnsetFormFit out;
  out.form = form;
  if (onset.size() < parameters_of(form)) {
    out.message = fmt::format("needs groups of {} spans", parameters_of(form));
    return out;
  }
  const LeastSquaresFit best = solve(form, at, onset, starts(form, at, onset));
  if (!found(best)) {
    out.message = "no fit: " + best.message;
    return out;
  }
  out.parameters = best.parameters;
  out.chi2 = best.residual_sum_of_squares;
  const auto freedom = static_cast<double>(onset.size() - parameters_of(form));
  if (freedom > 0.0) out.probability = gsl_cdf_fdist_Q(out.chi2 / freedom, freedom, degrees);
  std::vector<double> values(replicates.size(), std::numeric_limits<double>::quiet_NaN());
#pragma omp parallel for schedule(dynamic)
  for (std::size_t r = 0; r < replicates.size(); ++r) {
    const LeastSquaresFit one =
        solve(form, at, replicates[r], {best.parameters, starts(form, at, replicates[r]).front()});
    if (found(one)) values[r] = model(form, one.parameters, span);
  }
  std::erase_if(values, [](double v) { return std::isnan(v); });
  const auto [low, high] = interval95(values);
  out.onset = {model(form, best.parameters, span), mean_error(values).deviation, low, high};
  out.usable = out.probability >= options.refused_below && values.size() > 1;
  out.message = out.usable ? "fitted"
                           : fmt::format("refused by the data: chi^2 {:.3g} has a probability of {:.2g}", out.chi2,
                                         out.probability);
  return out;
}

bool wanted(const StateGroup& g, const OnsetOptions& options) {
  const bool named =
      options.groups.empty() || std::find(options.groups.begin(), options.groups.end(), g.name) != options.groups.end();
  return named && (options.largest_span <= 0.0 || g.span <= options.largest_span);
}

void require_input(const StateFit& fit, double span, const OnsetOptions& options) {
  if (!fit.usable) throw BadInput("onsets: the equation of state could not be fitted: " + fit.message);
  if (fit.degrees < 1) throw BadInput("onsets: without two samples in a group nobody knows their errors");
  if (!(span >= 1.0) || !std::isfinite(span))
    throw BadInput(fmt::format("onsets: span {}; it must be 1 or more", span));
  for (const auto& name : options.groups)
    if (std::none_of(fit.groups.begin(), fit.groups.end(), [&](const StateGroup& g) { return g.name == name; }))
      throw BadInput(fmt::format("onsets: no group {}", name));
}

}  // namespace

std::string to_string(OnsetForm form) { return form == OnsetForm::void_power ? "void power" : "saturating"; }

OnsetExtrapolation extrapolate_onset(const StateFit& fit, double span, const OnsetOptions& options) {
  require_input(fit, span, options);
  const double widen = gsl_cdf_tdist_Pinv(0.975, fit.degrees) / kNormal95;
  Onsets at;
  std::vector<double> onset;
  std::vector<std::vector<double>> replicates(fit.replicates.size());
  for (std::size_t g = 0; g < fit.groups.size(); ++g) {
    if (!wanted(fit.groups[g], options)) continue;
    at.span.push_back(fit.groups[g].span);
    at.error.push_back(fit.groups[g].onset.error);
    onset.push_back(fit.groups[g].onset.value);
    for (std::size_t r = 0; r < replicates.size(); ++r) {
      const double drawn = onset.back() + widen * (fit.replicates[r][2 + g] - onset.back());
      replicates[r].push_back(std::clamp(drawn, 1e-3, 1.0 - 1e-6));
    }
  }
  const auto spans = [&] {
    auto all = at.span;
    return std::unique(all.begin(), all.end()) - all.begin();  // groups are ordered by span
  }();
  if (spans < 2)
    throw BadInput(fmt::format("onsets: groups of {} span(s); two or more are needed for an extrapolation", spans));
  OnsetExtrapolation out;
  out.span = span;
  out.largest_span = at.span.back();
  for (const OnsetForm form : {OnsetForm::void_power, OnsetForm::saturating}) {
    if (form == OnsetForm::saturating && spans < 3) {
      out.forms.push_back({form, false, "needs groups of 3 spans", {}, 0.0, 1.0, {}});
      continue;
    }
    out.forms.push_back(fit_form(form, at, onset, replicates, fit.degrees, span, options));
  }
  // The saturating form contains the void power, so it is as possible as that, with its further parameter or without.
  OnsetFormFit& wide = out.forms[1];
  if (out.forms[0].usable && !wide.parameters.empty() && !wide.usable) {
    wide.usable = true;
    wide.message = "fitted";
  }
  double count = 0.0;
  out.onset = {0.0, 0.0, kInfinity, -kInfinity};
  for (const OnsetFormFit& form : out.forms) {
    if (!form.usable) continue;
    count += 1.0;
    out.onset.value += form.onset.value;
    out.onset.error = std::max(out.onset.error, form.onset.error);
    out.onset.low = std::min(out.onset.low, form.onset.low);
    out.onset.high = std::max(out.onset.high, form.onset.high);
  }
  out.usable = count > 0.0;
  if (out.usable) out.onset.value /= count;
  out.message = !out.usable   ? "both forms are refused by the data"
                : count < 2.0 ? "one form alone: its difference from the other is not in the interval"
                              : "both forms";
  return out;
}

}  // namespace softgrain
