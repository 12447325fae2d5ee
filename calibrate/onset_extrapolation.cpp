#include "calibrate/onset_extrapolation.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "calibrate/bootstrap.h"
#include "calibrate/rod_packing.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/random.h"
#include "common/core/statistics.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr std::uint64_t kFirstStream = 2000000;  ///< of draws of known onsets: behind those of fits and predictions

struct Onsets {
  std::vector<double> span;
  std::vector<double> error;
};

/// A form and what it needs to be evaluated at the spans that occur.
class OnsetModel {
 public:
  OnsetModel(OnsetForm form, const std::vector<double>& spans, double exponent) : form_(form) {
    if (form != OnsetForm::rods) return;
    for (const double r : spans)
      if (!rods_.contains(r)) rods_.try_emplace(r, Grading::classes({{1.0 / r, 1.0, exponent, 1.0}}));
  }

  [[nodiscard]] OnsetForm form() const { return form_; }

  [[nodiscard]] double operator()(std::span<const double> p, double r) const {
    switch (form_) {
      case OnsetForm::void_power:
        return 1.0 - std::exp(p[0] - p[1] * std::log(r));
      case OnsetForm::saturating:
        return p[0] - p[1] * std::pow(r, -p[2]);
      case OnsetForm::void_ratio:
        return 1.0 / (1.0 + std::exp(p[0] - p[1] * (std::hypot(std::log(r), p[2]) - p[2])));
      case OnsetForm::rods:
        break;
    }
    return rods_.at(r).at(p[0]);
  }

  [[nodiscard]] std::size_t parameters() const { return bounds().size(); }

  [[nodiscard]] std::vector<ParameterBounds> bounds() const {
    switch (form_) {
      case OnsetForm::void_power:
        return {{-20.0, 20.0}, {0.0, 5.0}};
      case OnsetForm::saturating:
        return {{0.0, 1.0}, {0.0, 10.0}, {0.02, 5.0}};
      case OnsetForm::void_ratio:
        return {{-20.0, 20.0}, {0.0, 5.0}, {0.0, 3.0}};
      case OnsetForm::rods:
        break;
    }
    return {{RodCurve::kLeastGap, RodCurve::kLargestGap}};
  }

 private:
  OnsetForm form_;
  std::map<double, RodCurve> rods_;
};

/// Start values through the first and the last onset.
std::vector<std::vector<double>> starts(OnsetForm form, const Onsets& at, const std::vector<double>& onset) {
  const double low = at.span.front();
  const double high = at.span.back();
  const double first = onset.front();
  const double last = onset.back();
  std::vector<std::vector<double>> out;
  switch (form) {
    case OnsetForm::void_power: {
      const double b = std::clamp(std::log((1.0 - first) / (1.0 - last)) / std::log(high / low), 0.0, 5.0);
      return {{std::log(1.0 - first) + b * std::log(low), b}};
    }
    case OnsetForm::saturating:
      for (const double b : {0.05, 0.2, 0.5, 1.0, 2.0}) {
        const double fall = std::pow(low, -b) - std::pow(high, -b);
        const double a = std::max(0.0, (last - first) / fall);
        out.push_back({std::clamp(last + a * std::pow(high, -b), 0.0, 1.0), std::min(a, 10.0), b});
      }
      return out;
    case OnsetForm::void_ratio:
      for (const double w : {1.0, 0.3, 2.0}) {
        const auto rise = [&](double r) { return std::hypot(std::log(r), w) - w; };
        const double fall = std::log((1.0 / first - 1.0) / (1.0 / last - 1.0));
        const double b = std::clamp(fall / (rise(high) - rise(low)), 0.0, 5.0);
        out.push_back({std::log(1.0 / first - 1.0) + b * rise(low), b, w});
      }
      return out;
    case OnsetForm::rods:
      break;
  }
  return {{1.0}};
}

LeastSquaresFit solve(const OnsetModel& model, const Onsets& at, const std::vector<double>& onset,
                      const std::vector<std::vector<double>>& from) {
  LeastSquaresProblem problem;
  problem.residuals = onset.size();
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
    for (std::size_t k = 0; k < onset.size(); ++k) r[k] = (model(p, at.span[k]) - onset[k]) / at.error[k];
    return true;
  };
  problem.bounds = model.bounds();
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

/// `values`: at the span asked for, of every replicate; NaN where there is no fit.
OnsetFormFit fit_form(const OnsetModel& model, const Onsets& at, const std::vector<double>& onset,
                      const std::vector<std::vector<double>>& replicates, int degrees, double span,
                      const OnsetOptions& options, std::vector<double>& values) {
  OnsetFormFit out;
  out.form = model.form();
  const LeastSquaresFit best = solve(model, at, onset, starts(model.form(), at, onset));
  if (!found(best)) {
    out.message = "no fit: " + best.message;
    return out;
  }
  out.parameters = best.parameters;
  out.chi2 = best.residual_sum_of_squares;
  const auto freedom = static_cast<double>(onset.size()) - static_cast<double>(model.parameters());
  if (freedom > 0.0) out.probability = gsl_cdf_fdist_Q(out.chi2 / freedom, freedom, degrees);
  values.assign(replicates.size(), std::numeric_limits<double>::quiet_NaN());
#pragma omp parallel for schedule(dynamic)
  for (std::size_t r = 0; r < replicates.size(); ++r) {
    const LeastSquaresFit one =
        solve(model, at, replicates[r], {best.parameters, starts(model.form(), at, replicates[r]).front()});
    if (found(one)) values[r] = model(one.parameters, span);
  }
  std::vector<double> numbers = values;
  std::erase_if(numbers, [](double v) { return std::isnan(v); });
  const auto [low, high] = interval95(numbers);
  out.onset = {model(best.parameters, span), mean_error(numbers).deviation, low, high};
  out.usable = out.probability >= options.refused_below && numbers.size() > 1;
  out.message = out.usable ? "fitted"
                           : fmt::format("refused by the data: chi^2 {:.3g} has a probability of {:.2g}", out.chi2,
                                         out.probability);
  return out;
}

bool wanted(const StateGroup& g, const OnsetOptions& options) {
  return options.groups.empty() || std::ranges::find(options.groups, g.name) != options.groups.end();
}

void require_fit(const StateFit& fit) {
  if (!fit.usable) throw InputError("onsets: the equation of state could not be fitted: " + fit.message);
  if (fit.degrees < 1) throw InputError("onsets: without two samples in a group nobody knows their errors");
}

void require_span(double span) {
  if (!(span >= 1.0) || !std::isfinite(span))
    throw InputError(fmt::format("onsets: span {}; it must be 1 or more", span));
}

void require_input(const StateFit& fit, double span, const OnsetOptions& options) {
  require_fit(fit);
  require_span(span);
  for (const auto& name : options.groups)
    if (fit.find(name) == nullptr) throw InputError(fmt::format("onsets: no group {}", name));
}

}  // namespace

std::string to_string(OnsetForm form) {
  switch (form) {
    case OnsetForm::void_power:
      return "void power";
    case OnsetForm::saturating:
      return "saturating";
    case OnsetForm::void_ratio:
      return "void ratio";
    case OnsetForm::rods:
      break;
  }
  return "rods";
}

StateFit with_known_onsets(const StateFit& fit, const std::vector<KnownOnset>& known, std::uint64_t seed) {
  if (known.empty()) return fit;
  require_fit(fit);
  StateFit out = fit;
  const double widen = student_over_normal(fit.degrees);
  for (std::size_t k = 0; k < known.size(); ++k) {
    const KnownOnset& one = known[k];
    require_span(one.span);
    if (!(one.value > 0.0 && one.value < 1.0))
      throw InputError(fmt::format("onsets: {} at span {}; it must lie between 0 and 1", one.value, one.span));
    if (!(one.standard_error > 0.0) || !std::isfinite(one.standard_error))
      throw InputError(
          fmt::format("onsets: standard error {} at span {}; it must be positive", one.standard_error, one.span));
    StateGroup group;
    group.name = fmt::format("span {:g}, measured elsewhere", one.span);
    group.span = one.span;
    const double half = kNormal95 * one.standard_error;
    group.onset = {one.value, one.standard_error, one.value - half, one.value + half};
    const auto after = std::ranges::upper_bound(out.groups, one.span, {}, &StateGroup::span);
    const auto at = 2 + (after - out.groups.begin());  // behind ln K and n
    out.groups.insert(after, std::move(group));
    for (std::size_t r = 0; r < out.replicates.size(); ++r) {
      RandomStream random(seed, RandomPurpose::bootstrap, kFirstStream + k * out.replicates.size() + r);
      out.replicates[r].insert(out.replicates[r].begin() + at,
                               one.value + one.standard_error * random.normal() / widen);
    }
  }
  return out;
}

OnsetExtrapolation extrapolate_onset(const StateFit& fit, double span, const OnsetOptions& options) {
  require_input(fit, span, options);
  const double widen = student_over_normal(fit.degrees);
  Onsets at;
  std::vector<double> onset;
  std::vector<std::vector<double>> replicates(fit.replicates.size());
  for (std::size_t g = 0; g < fit.groups.size(); ++g) {
    if (!wanted(fit.groups[g], options)) continue;
    at.span.push_back(fit.groups[g].span);
    at.error.push_back(fit.groups[g].onset.standard_error);
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
    throw InputError(
        fmt::format("onsets: groups of {}; two or more are needed for an extrapolation", counted(spans, "span")));
  OnsetExtrapolation out;
  out.span = span;
  out.largest_span = at.span.back();
  std::vector<double> needed = at.span;
  needed.push_back(span);
  std::vector<std::vector<double>> values;
  for (const OnsetForm form : {OnsetForm::void_power, OnsetForm::saturating, OnsetForm::void_ratio, OnsetForm::rods}) {
    values.emplace_back();
    if (form == OnsetForm::rods && !(options.exponent > 0.0)) {
      out.forms.push_back({form, false, "sizes are no power law", {}, 0.0, 1.0, {}});
      continue;
    }
    const OnsetModel model(form, needed, options.exponent);
    if (spans < static_cast<std::ptrdiff_t>(model.parameters())) {
      out.forms.push_back({form, false, fmt::format("needs groups of {} spans", model.parameters()), {}, 0.0, 1.0, {}});
      continue;
    }
    out.forms.push_back(fit_form(model, at, onset, replicates, fit.degrees, span, options, values.back()));
  }
  // The saturating form contains the void power, so it is as possible as that, with its further parameter or without.
  OnsetFormFit& wide = out.forms[1];
  if (out.forms[0].usable && !wide.parameters.empty() && !wide.usable) {
    wide.usable = true;
    wide.message = "fitted";
  }
  double count = 0.0;
  out.onset = {0.0, 0.0, kInfinity, -kInfinity};
  for (std::size_t f = 0; f < out.forms.size(); ++f) {
    const OnsetFormFit& form = out.forms[f];
    if (!form.usable) continue;
    out.replicates.push_back(values[f]);
    count += 1.0;
    out.onset.value += form.onset.value;
    out.onset.standard_error = std::max(out.onset.standard_error, form.onset.standard_error);
    out.onset.low = std::min(out.onset.low, form.onset.low);
    out.onset.high = std::max(out.onset.high, form.onset.high);
  }
  out.usable = count > 0.0;
  if (out.usable) out.onset.value /= count;
  std::string names;
  for (const OnsetFormFit& form : out.forms)
    if (form.usable) append_part(names, to_string(form.form), ", ");
  out.message = !out.usable   ? "all forms are refused by the data"
                : count < 2.0 ? "one form alone, " + names + ": its difference from others is not in the interval"
                              : names;
  return out;
}

}  // namespace softgrain
