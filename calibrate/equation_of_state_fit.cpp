#include "calibrate/equation_of_state_fit.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

#include "calibrate/draws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/random.h"
#include "common/core/statistics.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

/// Share of replicates that must fit for intervals to mean something.
constexpr double kLeastReplicates = 0.9;

/// Least squares with one K (parameters ln K, n, onsets) or one for each group (ln K of each, n, onsets).
class StateProblem {
 public:
  StateProblem(const StateSamples& data, StateForm form, bool own_moduli)
      : data_(data), form_(form), own_(own_moduli) {}

  [[nodiscard]] std::size_t modulus_at(std::size_t group) const { return own_ ? group : 0; }
  [[nodiscard]] std::size_t exponent_at() const { return own_ ? data_.groups.size() : 1; }
  [[nodiscard]] std::size_t onset_at(std::size_t group) const { return exponent_at() + 1 + group; }

  [[nodiscard]] PhiSlopes slopes(std::span<const double> p, std::size_t group, double pressure) const {
    return phi_slopes(form_, p[modulus_at(group)], p[exponent_at()], p[onset_at(group)], pressure);
  }

  /// `phi[s]` replaces the solid fractions of sample s.
  [[nodiscard]] LeastSquaresFit solve(const std::vector<std::vector<double>>& phi, const std::vector<double>& start,
                                      bool thorough) const {
    const std::size_t n = exponent_at() + 1 + data_.groups.size();
    LeastSquaresProblem problem;
    problem.residuals = data_.points;
    problem.bounds.assign(n, {});
    problem.bounds[exponent_at()] = {0.2, 20.0};
    for (std::size_t g = 0; g < data_.groups.size(); ++g) problem.bounds[onset_at(g)] = {0.01, 0.999};
    problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
      std::size_t at = 0;
      for (std::size_t s = 0; s < data_.samples.size(); ++s)
        for (std::size_t i = 0; i < phi[s].size(); ++i)
          r[at++] = data_.samples[s].root_weight[i] *
                    (slopes(p, data_.samples[s].group, data_.samples[s].pressure[i]).value - phi[s][i]);
      return true;
    };
    problem.jacobian = [&](std::span<const double> p, std::span<double> jacobian) {
      std::fill(jacobian.begin(), jacobian.end(), 0.0);
      double* row = jacobian.data();
      for (const StateSample& s : data_.samples)
        for (std::size_t i = 0; i < s.phi.size(); ++i, row += n) {
          const PhiSlopes d = slopes(p, s.group, s.pressure[i]);
          row[modulus_at(s.group)] = s.root_weight[i] * d.by_log_modulus;
          row[exponent_at()] = s.root_weight[i] * d.by_exponent;
          row[onset_at(s.group)] = s.root_weight[i] * d.by_onset;
        }
      return true;
    };
    LeastSquaresOptions options;
    options.thorough = thorough;
    return fit_least_squares(problem, {start}, options);
  }

  /// Start values from a Hertz-like guess: onsets a little below the loosest bearing point, K from the densest.
  [[nodiscard]] std::vector<double> start() const {
    constexpr double kExponent = 1.75;
    std::vector<double> p(exponent_at() + 1 + data_.groups.size(), 0.0);
    p[exponent_at()] = kExponent;
    std::vector<double> modulus(data_.groups.size(), 0.0);
    std::vector<double> loosest(data_.groups.size(), 1.0);
    for (const StateSample& s : data_.samples)
      loosest[s.group] = std::min(loosest[s.group], *std::min_element(s.phi.begin(), s.phi.end()));
    for (std::size_t g = 0; g < loosest.size(); ++g) p[onset_at(g)] = std::clamp(0.99 * loosest[g], 0.02, 0.99);
    for (const StateSample& s : data_.samples) {
      const double onset = p[onset_at(s.group)];
      const double x = std::max(1e-4, (s.phi.back() - onset) / (1.0 - onset));
      modulus[s.group] = s.log_pressure.back() - kExponent * std::log(x);
    }
    for (std::size_t g = 0; g < modulus.size(); ++g) p[modulus_at(g)] = own_ ? modulus[g] : mean_error(modulus).mean;
    return p;
  }

 private:
  const StateSamples& data_;
  StateForm form_;
  bool own_;
};

std::vector<std::vector<double>> measured(const StateSamples& data) {
  std::vector<std::vector<double>> out;
  for (const StateSample& s : data.samples) out.push_back(s.phi);
  return out;
}

/// Residual of a sample as a function of ln p: straight between its points, level beyond.
double residual_at(const StateSample& s, const std::vector<double>& residual, double log_pressure) {
  const auto at = std::lower_bound(s.log_pressure.begin(), s.log_pressure.end(), log_pressure);
  if (at == s.log_pressure.begin()) return residual.front();
  if (at == s.log_pressure.end()) return residual.back();
  const auto i = static_cast<std::size_t>(at - s.log_pressure.begin());
  const double width = s.log_pressure[i] - s.log_pressure[i - 1];
  const double t = width > 0.0 ? (log_pressure - s.log_pressure[i - 1]) / width : 0.0;
  return residual[i - 1] + t * (residual[i] - residual[i - 1]);
}

/// ln K of single samples about the fit `p`, which has a K of each group. The residuals of a sample are taken as a
/// change of its onset and one of ln K, to first order.
std::vector<double> log_moduli_of_samples(const StateSamples& data, const StateProblem& own,
                                          const std::vector<double>& p) {
  std::vector<double> out;
  for (const StateSample& s : data.samples) {
    double kk = 0.0;
    double ko = 0.0;
    double oo = 0.0;
    double kr = 0.0;
    double orr = 0.0;
    for (std::size_t i = 0; i < s.phi.size(); ++i) {
      const PhiSlopes d = own.slopes(p, s.group, s.pressure[i]);
      const double w = s.root_weight[i] * s.root_weight[i];
      const double r = s.phi[i] - d.value;
      kk += w * d.by_log_modulus * d.by_log_modulus;
      ko += w * d.by_log_modulus * d.by_onset;
      oo += w * d.by_onset * d.by_onset;
      kr += w * d.by_log_modulus * r;
      orr += w * d.by_onset * r;
    }
    out.push_back(p[own.modulus_at(s.group)] + (kr * oo - orr * ko) / (kk * oo - ko * ko));
  }
  return out;
}

/// Scatter of ln K between groups.
struct Collapse {
  /// Probability of a scatter as large as this, in units of that of samples within groups (F test of one way, exact for
  /// normal scatter); 1 where there is nothing to compare.
  double probability = 1.0;
  double deviation = 0.0;  ///< deviation between groups, without that of samples within them

  /// Whether one K for all groups is refused.
  [[nodiscard]] bool refused() const { return probability < 0.05; }
};

Collapse collapse_of(const StateSamples& data, const std::vector<double>& log_moduli) {
  const std::size_t groups = data.groups.size();
  std::vector<std::vector<double>> of_group(groups);
  for (std::size_t s = 0; s < log_moduli.size(); ++s) of_group[data.samples[s].group].push_back(log_moduli[s]);
  const double all = mean_error(log_moduli).mean;
  double between = 0.0;
  double within = 0.0;
  double shares = 0.0;  // of the variance within a group that its mean still has
  std::vector<double> means;
  for (const auto& values : of_group) {
    const MeanError own = mean_error(values);
    between += static_cast<double>(values.size()) * (own.mean - all) * (own.mean - all);
    shares += 1.0 / static_cast<double>(values.size());
    means.push_back(own.mean);
    for (const double v : values) within += (v - own.mean) * (v - own.mean);
  }
  const double up = static_cast<double>(groups) - 1.0;
  const double down = static_cast<double>(log_moduli.size() - groups);
  if (up < 1.0 || down < 1.0 || !(within > 0.0)) return {};
  const double scatter = mean_error(means).deviation;
  const double of_means = within / down * shares / static_cast<double>(groups);
  return {gsl_cdf_fdist_Q(between / up / (within / down), up, down),
          std::sqrt(std::max(0.0, scatter * scatter - of_means))};
}

/// Bounds of what a number can be.
struct StateBounds {
  double low = 0.0;
  double high = 0.0;
};

/// `more`: another deviation, of what replicates do not know. The interval stays within the bounds.
Estimate estimated(double value, const std::vector<double>& replicates, int degrees, const StateBounds& bounds,
                   double more = 0.0) {
  const double error = std::hypot(mean_error(replicates).deviation, more);
  return student_estimate(value, error, replicates.size() < 2 ? 0 : degrees, bounds.low, bounds.high);
}

class StateBootstrap {
 public:
  /// `between`: standard deviation of ln K between groups, where these have a K of their own.
  StateBootstrap(const StateSamples& data, const StateFitOptions& options, const LeastSquaresFit& shared,
                 const LeastSquaresFit& separate, double between)
      : data_(data), options_(options), shared_(data, options.form, false), fit_(shared.parameters), between_(between) {
    const StateProblem own(data, options.form, true);
    const auto n = static_cast<double>(data.samples.size());
    const auto groups = static_cast<double>(data.groups.size());
    const double widen = n > groups ? std::sqrt(n / (n - groups)) : 1.0;
    for (const StateSample& s : data.samples) {
      std::vector<double> r;
      for (std::size_t i = 0; i < s.phi.size(); ++i)
        r.push_back(widen * (s.phi[i] - own.slopes(separate.parameters, s.group, s.pressure[i]).value));
      residual_.push_back(std::move(r));
    }
  }

  /// Parameters of the shared fit to drawn samples; replicates that cannot be fitted are missing.
  [[nodiscard]] std::vector<std::vector<double>> run() const {
    auto all = bootstrap_replicates(options_.replicates, options_.seed, 0, "refitting to drawn samples",
                                    [this](RandomStream& random) {
                                      LeastSquaresFit fit = shared_.solve(draw(random), fit_, false);
                                      return fit.usable() ? std::move(fit.parameters) : std::vector<double>();
                                    });
    std::erase_if(all, [](const auto& one) { return one.empty(); });
    return all;
  }

 private:
  [[nodiscard]] std::vector<std::vector<double>> draw(RandomStream& random) const {
    std::vector<std::vector<double>> out;
    std::vector<double> own(data_.groups.size(), fit_[0]);
    if (between_ > 0.0)
      for (double& log_modulus : own) log_modulus += between_ * random.normal();
    for (const StateSample& s : data_.samples) {
      const auto from = static_cast<std::size_t>(random.below(data_.samples.size()));
      std::vector<double> phi;
      for (std::size_t i = 0; i < s.phi.size(); ++i)
        phi.push_back(
            phi_slopes(options_.form, own[s.group], fit_[1], fit_[shared_.onset_at(s.group)], s.pressure[i]).value +
            residual_at(data_.samples[from], residual_[from], s.log_pressure[i]));
      out.push_back(std::move(phi));
    }
    return out;
  }

  const StateSamples& data_;
  const StateFitOptions& options_;
  StateProblem shared_;
  std::vector<double> fit_;
  double between_;
  std::vector<std::vector<double>> residual_;
};

/// How far pressures are from the curve of their own sample, and onsets of samples from their group.
void describe_scatter(const StateSamples& data, const StateProblem& problem, StateForm form, StateFit& out) {
  const auto& p = out.fit.parameters;
  double squares = 0.0;
  double points = 0.0;
  double offsets = 0.0;
  for (const StateSample& s : data.samples) {
    std::vector<double> shift;
    for (std::size_t i = 0; i < s.phi.size(); ++i) {
      const PhiSlopes d = problem.slopes(p, s.group, s.pressure[i]);
      shift.push_back((s.phi[i] - d.value) / d.by_onset);
    }
    const double own = mean_error(shift).mean;
    offsets += own * own;
    for (std::size_t i = 0; i < s.phi.size(); ++i) {
      const double model = state_pressure(form, std::exp(p[0]), p[1], p[problem.onset_at(s.group)] + own, s.phi[i]);
      if (!(model > 0.0)) continue;
      squares += std::pow(std::log(s.pressure[i] / model), 2);
      points += 1.0;
    }
  }
  out.pressure_deviation = points > 0.0 ? std::sqrt(squares / points) : 0.0;
  out.sample_deviation = out.degrees > 0 ? std::sqrt(offsets / out.degrees) : kInfinity;
}

/// K may be off by this factor to either side; beyond, curves do not determine it.
constexpr double kWidestFactor = 100.0;
/// Factor to either side beyond which the message says that curves hardly determine K.
constexpr double kWideFactor = 3.0;
/// Points that must be left when every number has taken one.
constexpr int kLeastFreedom = 3;

/// Why the numbers are no result; empty: they are.
std::string not_determined(const StateSamples& data, const StateFit& fit) {
  const auto numbers = static_cast<int>(fit.fit.parameters.size());
  const auto points = static_cast<int>(data.points);
  if (points - numbers < kLeastFreedom)
    return fmt::format(
        "too few points: {} of {} for {} numbers (K, n, phi_J of each packing), at least {} are needed: "
        "record more points along the test, or more samples",
        points, counted(data.samples.size(), "sample"), numbers, numbers + kLeastFreedom);
  if (fit.fit.at_bound.size() > 1 && fit.fit.at_bound[1])
    return fmt::format("n is not determined: it runs to {:.3g}, the end of what is tried, and K with it",
                       fit.exponent.value);
  return "";
}

std::string message_of(const StateFit& fit) {
  if (fit.degrees < 1) return "fitted; one sample in every group: errors are not known";
  std::string text = "fitted";
  if (!fit.one_modulus)
    text += fmt::format(
        "; one K for all packings is refused (as much scatter has a probability of {:.2g}): intervals hold that of K "
        "between packings",
        fit.collapse_probability);
  const double factor = std::max(fit.modulus.high / fit.modulus.value, fit.modulus.value / fit.modulus.low);
  if (!(factor < kWidestFactor))
    text += fmt::format(
        "; K is not determined (95 %: {:.2g} to {:.2g}): it goes with n, and both say pressures within the range of "
        "the fit alone",
        fit.modulus.low, fit.modulus.high);
  else if (!(factor < kWideFactor))
    text += fmt::format("; K is known to a factor of {:.2g} alone: it goes with n", factor);
  return text;
}

}  // namespace

StateFit fit_equation_of_state(const std::vector<StateCurve>& curves, const StateFitOptions& options) {
  if (options.replicates < 40)
    throw InputError(fmt::format("equation of state: {} replicates; 40 or more are needed", options.replicates));
  const StateSamples data = read_state_curves(curves);
  StateFit out;
  for (const auto& g : data.groups) out.groups.push_back({g.name, g.span, g.samples, g.points, {}, 0.0});
  out.left_out = data.left_out;
  out.degrees = static_cast<int>(data.samples.size()) - static_cast<int>(data.groups.size());
  const StateProblem shared(data, options.form, false);
  const StateProblem own(data, options.form, true);
  const auto phi = measured(data);
  out.fit = shared.solve(phi, shared.start(), true);
  const LeastSquaresFit separate = own.solve(phi, own.start(), true);
  if (!out.fit.usable() || !separate.usable()) {
    out.message = "no fit: " + (out.fit.usable() ? separate.message : out.fit.message);
    return out;
  }
  const Collapse collapse = collapse_of(data, log_moduli_of_samples(data, own, separate.parameters));
  out.collapse_probability = collapse.probability;
  out.one_modulus = !collapse.refused();
  const double between = out.one_modulus ? 0.0 : collapse.deviation;
  describe_scatter(data, shared, options.form, out);
  if (!out.one_modulus) out.degrees = std::min(out.degrees, static_cast<int>(data.groups.size()) - 1);
  out.replicates = StateBootstrap(data, options, out.fit, separate, between).run();
  const auto of = [&](std::size_t k, const StateBounds& bounds, double more = 0.0) {
    std::vector<double> values;
    for (const auto& r : out.replicates) values.push_back(r[k]);
    return estimated(out.fit.parameters[k], values, out.degrees, bounds, more);
  };
  const Estimate log_modulus = of(0, {-kInfinity, kInfinity}, between);
  out.modulus = {std::exp(log_modulus.value), std::exp(log_modulus.value) * log_modulus.standard_error,
                 std::exp(log_modulus.low), std::exp(log_modulus.high)};
  out.exponent = of(1, {0.0, kInfinity});
  const std::vector<double> moduli(separate.parameters.begin(),
                                   separate.parameters.begin() + static_cast<std::ptrdiff_t>(data.groups.size()));
  std::vector<double> values;
  for (std::size_t g = 0; g < out.groups.size(); ++g) {
    out.groups[g].onset = of(shared.onset_at(g), {0.0, 1.0});
    values.push_back(out.groups[g].own_modulus = std::exp(moduli[g]));
  }
  const MeanError moments = mean_error(values);
  out.modulus_scatter = moments.deviation_or_zero() / moments.mean;
  out.message = static_cast<double>(out.replicates.size()) < kLeastReplicates * options.replicates
                    ? fmt::format("only {} of {} replicates could be fitted", out.replicates.size(), options.replicates)
                    : not_determined(data, out);
  out.usable = out.message.empty();
  if (out.usable) out.message = message_of(out);
  return out;
}

}  // namespace softgrain
