#include "calibrate/scattering_fit.h"

#include <fmt/format.h>
#include <gsl/gsl_sf_gamma.h>
#include <gsl/gsl_sf_psi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calibrate/least_squares.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

/// 2F1(a, b; c; y) by its series, for 0 <= y <= 1/2 where each term is about half the one before.
double hypergeometric(double a, double b, double c, double y) {
  double term = 1.0;
  double sum = 1.0;
  for (int n = 0; n < 200 && std::abs(term) > 1e-17 * std::abs(sum); ++n) {
    term *= (a + n) * (b + n) / ((c + n) * (1.0 + n)) * y;
    sum += term;
  }
  return sum;
}

}  // namespace

double fractal_decay(double dimension, double x) {
  if (!(dimension > 0.0) || !(x >= 0.0) || !std::isfinite(x)) return kNaN;
  // Pfaff: 2F1(a, b; 1; z) = (1-z)^-b 2F1(b, 1-a; 1; y) with y = z/(z-1) in [0, 1). Above 1/2 the formula that connects
  // y with 1-y: 1 - b - (1-a) = a - b = 1/2, never an integer, so it holds for every dF.
  const double b = 0.5 * dimension;
  const double q = 0.5 * (1.0 - dimension);  // 1 - a
  const double rest = 1.0 / (1.0 + x * x);   // 1 - y
  const double scale = std::pow(rest, b);
  if (rest >= 0.5) return scale * hypergeometric(b, q, 1.0, 1.0 - rest);
  const double root_pi = std::sqrt(std::numbers::pi);  // Gamma(1/2); Gamma(-1/2) = -2 sqrt(pi)
  const double even = gsl_sf_gammainv(1.0 - b) * gsl_sf_gammainv(1.0 - q) * hypergeometric(b, q, 0.5, rest);
  const double odd = gsl_sf_gammainv(b) * gsl_sf_gammainv(q) * hypergeometric(1.0 - b, 1.0 - q, 1.5, rest);
  return scale * root_pi * (even - 2.0 * std::sqrt(rest) * odd);
}

double scattering_intensity(const ScatteringModel& m, double k) {
  return m.background + m.amplitude * fractal_decay(m.dimension, m.length * k);
}

double independent_intensity(const std::vector<double>& diameters, double cell_area) {
  double squares = 0.0;
  for (const double d : diameters) squares += std::pow(0.25 * std::numbers::pi * d * d, 2);
  return squares / cell_area;
}

double scattering_lower_length(const ScatteringModel& m, double solid_fraction) {
  if (m.dimension == 2.0) return kNaN;
  const double ratio = 2.0 * std::numbers::pi * solid_fraction * std::tgamma(m.dimension) *
                       std::pow(m.length, m.dimension) / m.amplitude;
  return std::pow(ratio, 1.0 / (m.dimension - 2.0));
}

namespace {

constexpr std::size_t kParameters = 4;  ///< ln A or, where the amplitude is tied, ln l; dF, ln xi, c
constexpr std::size_t kFewestBins = 8;
constexpr ParameterBounds kDimensionBounds{0.02, 3.0};
constexpr double kWorstChi2 = 10.0;
constexpr double kWidestInterval = 2.0;
/// chi^2 that one number may cost by chance in 1 of 20 cases: more, and the amplitude is not what the disks allow.
constexpr double kDearTie = 3.84;

/// One bin as the fit sees it.
struct Datum {
  double k = 0.0;
  double log_intensity = 0.0;  ///< logarithm of the intensity, without the bias of the logarithm of a mean
  double deviation = 1.0;
};

void require_valid(const ScatteringFitOptions& o) {
  if (!(o.k_low >= 0.0) || !(o.k_high > o.k_low))
    throw InputError(fmt::format("scattering fit: range of k [{}, {}] must rise from 0 or above", o.k_low, o.k_high));
  if (!(o.disk > 0.0) || !(o.cell_length >= 0.0))
    throw InputError("scattering fit: disk must be above 0 and cell_length 0 or above");
  if (!(o.solid_fraction >= 0.0) || !(o.lower_length_min > 0.0) || !(o.lower_length_max > o.lower_length_min) ||
      !(o.background_max > 0.0))
    throw InputError(
        "scattering fit: solid_fraction must be 0 or above, lower lengths must rise from above 0, background_max be "
        "above 0");
}

/// The bins in range; `bad` counts those without a logarithm.
std::vector<Datum> select(const std::vector<ScatteringCurve>& curves, const ScatteringFitOptions& o, std::size_t& bad) {
  std::vector<Datum> data;
  bad = 0;
  for (const ScatteringCurve& curve : curves)
    for (std::size_t n = 0; n < curve.size(); ++n) {
      if (!(curve.k[n] >= o.k_low && curve.k[n] <= o.k_high)) continue;
      const double m = curve.modes[n];
      if (!(curve.intensity[n] > 0.0) || !std::isfinite(curve.intensity[n]) || !(m > 0.0)) {
        ++bad;
        continue;
      }
      data.push_back({curve.k[n], std::log(curve.intensity[n]) - (gsl_sf_psi(m) - std::log(m)),
                      std::sqrt(gsl_sf_psi_1(m > 0.0 ? m : 1.0))});
    }
  return data;
}

/// What the four parameters of the fit mean.
class Parameters {
 public:
  explicit Parameters(double solid_fraction) : solid_fraction_(solid_fraction) {}

  [[nodiscard]] bool tied() const { return solid_fraction_ > 0.0; }
  [[nodiscard]] ScatteringModel model(std::span<const double> p) const {
    return {std::exp(log_amplitude(p)), p[1], std::exp(p[2]), p[3]};
  }
  /// d ln A / dp.
  [[nodiscard]] std::array<double, kParameters> slopes(std::span<const double> p) const {
    if (!tied()) return {1.0, 0.0, 0.0, 0.0};
    return {2.0 - p[1], gsl_sf_psi(p[1]) + p[2] - p[0], p[1], 0.0};
  }
  /// The first parameter of an amplitude; of a tied one as near as it can be.
  [[nodiscard]] double first_of(double log_amplitude, double dimension, double log_length) const {
    if (!tied()) return log_amplitude;
    const double known = std::log(2.0 * std::numbers::pi * solid_fraction_) + gsl_sf_lngamma(dimension);
    return (log_amplitude - known - dimension * log_length) / (2.0 - dimension);
  }

 private:
  [[nodiscard]] double log_amplitude(std::span<const double> p) const {
    if (!tied()) return p[0];
    return std::log(2.0 * std::numbers::pi * solid_fraction_) + gsl_sf_lngamma(p[1]) + 2.0 * p[0] +
           p[1] * (p[2] - p[0]);
  }

  double solid_fraction_;
};

bool residuals(const Parameters& parameters, const std::vector<Datum>& data, std::span<const double> p,
               std::span<double> r) {
  const ScatteringModel model = parameters.model(p);
  for (std::size_t n = 0; n < data.size(); ++n) {
    const double intensity = scattering_intensity(model, data[n].k);
    if (!(intensity > 0.0) || !std::isfinite(intensity)) return false;
    r[n] = (std::log(intensity) - data[n].log_intensity) / data[n].deviation;
  }
  return true;
}

/// Exact in A (or l) and c, central differences of fourth order of the decay in dF and ln xi.
bool jacobian(const Parameters& parameters, const std::vector<Datum>& data, std::span<const double> p,
              std::span<double> j) {
  constexpr double h = 1e-3;
  const ScatteringModel m = parameters.model(p);
  const auto amplitude = parameters.slopes(p);
  const auto slope = [&](const auto& f) { return (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h); };
  for (std::size_t n = 0; n < data.size(); ++n) {
    const double x = m.length * data[n].k;
    const double decay = m.amplitude * fractal_decay(m.dimension, x);
    const double by_dimension = slope([&](double e) { return fractal_decay(m.dimension + e, x); });
    const double by_length = slope([&](double e) { return fractal_decay(m.dimension, x * std::exp(e)); });
    const double scale = 1.0 / ((m.background + decay) * data[n].deviation);
    const std::array<double, kParameters> row{amplitude[0] * decay, amplitude[1] * decay + m.amplitude * by_dimension,
                                              amplitude[2] * decay + m.amplitude * by_length, 1.0};
    for (std::size_t q = 0; q < kParameters; ++q) {
      j[kParameters * n + q] = row[q] * scale;
      if (!std::isfinite(j[kParameters * n + q])) return false;
    }
  }
  return true;
}

/// Bounds of all parameters.
std::vector<ParameterBounds> bounds_of(const ScatteringFitOptions& o) {
  std::vector<ParameterBounds> bounds{{}, kDimensionBounds, {-12.0, 12.0}, {}};
  if (o.solid_fraction > 0.0) {
    bounds[0] = {std::log(o.lower_length_min), std::log(o.lower_length_max)};
    bounds[1].high = 2.0;
    bounds[2] = {std::log(o.disk), o.cell_length > 2.0 * o.disk ? std::log(0.5 * o.cell_length) : bounds[2].high};
  }
  if (std::isfinite(o.background_max)) bounds[3] = {0.0, o.background_max};
  return bounds;
}

std::vector<std::vector<double>> starts_for(const std::vector<Datum>& data, const Parameters& parameters,
                                            const std::vector<ParameterBounds>& bounds) {
  double top = data.front().log_intensity;
  double bottom = top;
  for (const Datum& d : data) {
    top = std::max(top, d.log_intensity);
    bottom = std::min(bottom, d.log_intensity);
  }
  const double k_first = std::min_element(data.begin(), data.end(), [](auto& a, auto& b) { return a.k < b.k; })->k;
  std::vector<std::vector<double>> starts;
  for (const double dimension : {1.2, 1.8})
    for (const double reach : {0.5, 3.0}) starts.push_back({top, dimension, std::log(reach / k_first), 0.0});
  starts.push_back({top, 1.5, std::log(1.0 / k_first), 0.3 * std::exp(bottom)});
  for (std::vector<double>& p : starts) {
    p[0] = parameters.first_of(p[0], p[1], p[2]);
    for (std::size_t q = 0; q < kParameters; ++q) p[q] = std::clamp(p[q], bounds[q].low, bounds[q].high);
  }
  return starts;
}

LeastSquaresFit solve(const Parameters& parameters, const std::vector<Datum>& data, const ScatteringFitOptions& o) {
  LeastSquaresProblem problem;
  problem.residuals = data.size();
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) { return residuals(parameters, data, p, r); };
  problem.jacobian = [&](std::span<const double> p, std::span<double> j) { return jacobian(parameters, data, p, j); };
  problem.bounds = bounds_of(o);
  LeastSquaresOptions options;
  options.max_iterations = 100;
  options.scale_covariance = false;
  options.thorough = false;  // several starts with one strategy are enough nearly always
  const auto starts = starts_for(data, parameters, problem.bounds);
  LeastSquaresFit found = fit_least_squares(problem, starts, options);
  if (found.end == FitEnd::converged) return found;
  options.thorough = true;
  return fit_least_squares(problem, starts, options);
}

ScatteringEstimate plain(double value, double error, double quantile) {
  return {value, error, value - quantile * error, value + quantile * error};
}
ScatteringEstimate logarithmic(double log_value, double error, double quantile) {
  const double value = std::exp(log_value);
  return {value, value * error, std::exp(log_value - quantile * error), std::exp(log_value + quantile * error)};
}

/// Covariance of (ln A, dF, ln xi, c) from that of the parameters.
std::vector<double> covariance_of(const LeastSquaresFit& found, const std::array<double, kParameters>& slopes) {
  std::vector<double> half(kParameters * kParameters, 0.0);
  std::vector<double> whole(kParameters * kParameters, 0.0);
  const auto row = [&](std::size_t a, std::size_t q) { return a == 0 ? slopes[q] : a == q ? 1.0 : 0.0; };
  for (std::size_t a = 0; a < kParameters; ++a)
    for (std::size_t b = 0; b < kParameters; ++b)
      for (std::size_t q = 0; q < kParameters; ++q)
        half[kParameters * a + b] += row(a, q) * found.covariance[kParameters * q + b];
  for (std::size_t a = 0; a < kParameters; ++a)
    for (std::size_t b = 0; b < kParameters; ++b)
      for (std::size_t q = 0; q < kParameters; ++q) whole[kParameters * a + b] += half[kParameters * a + q] * row(b, q);
  return whole;
}

/// Names and values of the numbers that ended at a bound; the data would have them elsewhere.
std::string bounded_text(const LeastSquaresFit& found, const ScatteringFitOptions& o) {
  std::string text;
  const auto add = [&](std::size_t q, const std::string& name, double value) {
    if (found.at_bound[q]) append_part(text, fmt::format("{} = {:.3g}", name, value), ", ");
  };
  if (o.solid_fraction > 0.0) add(0, "l", std::exp(found.parameters[0]));
  add(3, "c", found.parameters[3]);
  return text;
}

void fill(const LeastSquaresFit& found, const Parameters& parameters, ScatteringFit& out) {
  const auto& p = found.parameters;
  out.model = parameters.model(p);
  const auto degrees = static_cast<double>(found.degrees_of_freedom);
  out.chi2_per_degree = found.residual_sum_of_squares / degrees;
  const double widening = std::max(1.0, out.chi2_per_degree);
  const double quantile = widening > 1.0 ? student95(degrees) : kNormal95;
  out.covariance = covariance_of(found, parameters.slopes(p));
  for (double& c : out.covariance) c *= widening;
  const auto error = [&](std::size_t q) { return std::sqrt(widening) * found.standard_deviations[q]; };
  if (parameters.tied()) out.lower_length = logarithmic(p[0], error(0), quantile);
  out.amplitude = logarithmic(std::log(out.model.amplitude), std::sqrt(out.covariance[0]), quantile);
  out.dimension = plain(p[1], error(1), quantile);
  out.length = logarithmic(p[2], error(2), quantile);
  out.background = plain(p[3], error(3), quantile);
}

/// Everything that speaks against relying on the result.
std::string judge(const LeastSquaresFit& found, const ScatteringFit& fit, const ScatteringFitOptions& o) {
  std::vector<std::string> reasons;
  if (found.rank_deficient)
    reasons.emplace_back("the data do not determine all parameters");
  else if (found.end != FitEnd::converged)
    reasons.push_back("not converged: " + found.message);
  const double xi = fit.model.length;
  if (fit.model.dimension > 2.0 || found.at_bound[1])
    reasons.push_back(fmt::format("dF = {:.3f} is outside (0, 2]", fit.model.dimension));
  if (o.solid_fraction > 0.0 && found.at_bound[2])
    reasons.push_back(fmt::format("xi ends at {:.3g}, {}", xi, xi < 2.0 * o.disk ? "the disks" : "half the cell"));
  else if (xi < o.disk)
    reasons.push_back(fmt::format("xi = {:.3g} is below the disks", xi));
  if (!(o.solid_fraction > 0.0) && o.cell_length > 0.0 && xi > 0.5 * o.cell_length)
    reasons.push_back(fmt::format("xi = {:.3g} is beyond half the cell, {:.3g}", xi, 0.5 * o.cell_length));
  if (!(fit.dimension.high - fit.dimension.low < kWidestInterval))
    reasons.emplace_back("the interval of dF is wider than all it can be");
  if (fit.chi2_per_degree > kWorstChi2)
    reasons.push_back(fmt::format("the curve is another: chi^2 per degree {:.3g}", fit.chi2_per_degree));
  return join_text(reasons, "; ");
}

/// Fits with an amplitude that is tied or free, as the options say.
void fit_data(const std::vector<Datum>& data, const ScatteringFitOptions& options, ScatteringFit& fit) {
  const Parameters parameters(options.solid_fraction);
  const LeastSquaresFit found = solve(parameters, data, options);
  if (found.parameters.size() != kParameters || found.standard_deviations.size() != kParameters) {
    fit.reason = "no fit: " + found.message;
    return;
  }
  fill(found, parameters, fit);
  fit.bounded = bounded_text(found, options);
  fit.reason = judge(found, fit, options);
  fit.usable = fit.reason.empty();
}

double chi2_of(const ScatteringFit& fit) { return fit.chi2_per_degree * static_cast<double>(fit.bins - kParameters); }

/// The fit with a free amplitude in place of a tied one, where the tie costs more than chance explains. Where nothing
/// is at a bound both are the same fit in other parameters.
ScatteringFit untied_if_dear(const std::vector<Datum>& data, ScatteringFitOptions options, const ScatteringFit& tied) {
  if (options.solid_fraction == 0.0 || tied.amplitude.value == 0.0 || (tied.usable && tied.bounded.empty()))
    return tied;
  ScatteringFit free = tied;
  free.lower_length = {};
  free.bounded.clear();
  options.solid_fraction = 0.0;
  fit_data(data, options, free);
  const double cost = chi2_of(tied) - chi2_of(free);
  if (!(cost > kDearTie)) return tied;
  free.tie_cost = cost;
  return free;
}

}  // namespace

ScatteringFit fit_scattering(const std::vector<ScatteringCurve>& curves, const ScatteringFitOptions& options) {
  require_valid(options);
  ScatteringFit fit;
  std::size_t bad = 0;
  const std::vector<Datum> data = select(curves, options, bad);
  fit.bins = data.size();
  if (bad > 0) {
    fit.reason = fmt::format("{} bins hold no positive, finite intensity", bad);
    return fit;
  }
  if (data.size() < kFewestBins) {
    fit.reason = fmt::format("{} bins of k in the range, {} needed", data.size(), kFewestBins);
    return fit;
  }
  const auto [first, last] =
      std::minmax_element(data.begin(), data.end(), [](const Datum& a, const Datum& b) { return a.k < b.k; });
  fit.k_low = first->k;
  fit.k_high = last->k;
  fit_data(data, options, fit);
  return untied_if_dear(data, options, fit);
}

ScatteringCurve pooled_curve(const std::vector<ScatteringCurve>& curves, const std::vector<double>& edges) {
  ScatteringCurve out;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    double modes = 0.0;
    double k = 0.0;
    double sum = 0.0;
    for (const ScatteringCurve& c : curves)
      for (std::size_t n = 0; n < c.size(); ++n) {
        if (c.k[n] < edges[b] || c.k[n] >= edges[b + 1]) continue;
        modes += c.modes[n];
        k += c.modes[n] * c.k[n];
        sum += c.modes[n] * c.intensity[n];
      }
    if (modes == 0.0) continue;
    out.k.push_back(k / modes);
    out.intensity.push_back(sum / modes);
    out.modes.push_back(modes);
  }
  return out;
}

}  // namespace softgrain
