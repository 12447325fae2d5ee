#include "calibrate/consolidation_fit.h"

#include <fmt/format.h>
#include <gsl/gsl_fit.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrate/least_squares.h"
#include "common/core/error.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

struct Line {
  double slope = 0.0;
  double offset = 0.0;
  double slope_error = 0.0;
};

/// y over x between two points, both counted.
Line line_through(const std::vector<double>& x, const std::vector<double>& y, std::size_t first, std::size_t last) {
  Line out;
  double c00 = 0.0;
  double c01 = 0.0;
  double c11 = 0.0;
  double squares = 0.0;
  gsl_fit_linear(&x[first], 1, &y[first], 1, last - first + 1, &out.offset, &out.slope, &c00, &c01, &c11, &squares);
  out.slope_error = std::sqrt(c11);
  return out;
}

std::vector<double> inverse(const std::vector<double>& fraction) {
  std::vector<double> out;
  for (const double f : fraction) out.push_back(1.0 / f);
  return out;
}

std::vector<double> mean_of(const std::vector<std::vector<double>>& samples) {
  std::vector<double> out(samples.front().size(), 0.0);
  for (const auto& s : samples)
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += s[k] / static_cast<double>(samples.size());
  return out;
}

struct Stretch {
  std::size_t first = 0;
  std::size_t last = 0;
  Line line{};
};

/// Where y falls fastest over x.
std::optional<Stretch> steepest(const std::vector<double>& x, const std::vector<double>& y) {
  std::optional<Stretch> best;
  for (std::size_t a = 0; a < x.size(); ++a)
    for (std::size_t b = a + kSlopePoints - 1; b < x.size(); ++b) {
      if (x[b] - x[a] < std::log(kSlopeSpan) * (1.0 - 1e-12)) continue;
      const Line line = line_through(x, y, a, b);
      if (line.slope < 0.0 && (!best || line.slope < best->line.slope)) best = Stretch{a, b, line};
    }
  return best;
}

/// Phi = Phi_max - c P^-alpha.
void fit_approach(const std::vector<double>& pressure, const std::vector<double>& fraction, std::size_t first,
                  ConsolidationFit& out) {
  const std::size_t n = pressure.size() - first;
  if (n < kApproachPoints) {
    out.reason =
        fmt::format("alpha: {} pressures from P* = {:.3g} on, {} are needed", n, pressure[first], kApproachPoints);
    return;
  }
  LeastSquaresProblem problem;
  problem.residuals = n;
  constexpr std::array<const char*, 3> kNames{"Phi_max", "c of Phi_max - c P*^-alpha", "alpha"};
  problem.bounds = {{0.1, 2.0}, {-20.0, 5.0}, {0.01, 20.0}};
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
    for (std::size_t k = 0; k < n; ++k)
      r[k] = p[0] - std::exp(p[1]) * std::pow(pressure[first + k], -p[2]) - fraction[first + k];
    return true;
  };
  const LeastSquaresFit fit = fit_least_squares(problem, {{fraction.back() + 0.01, -4.0, 1.0}});
  if (!fit.usable()) {
    out.reason = "alpha: " + fit.message;
    return;
  }
  for (std::size_t k = 0; k < fit.at_bound.size(); ++k)
    if (fit.at_bound[k]) {
      out.reason = fmt::format(
          "alpha: the pressures from P* = {:.3g} on do not determine it: the fit ends at a limit of its search ({} = "
          "{:.3g}); higher pressures may do",
          pressure[first], kNames[k], k == 1 ? std::exp(fit.parameters[k]) : fit.parameters[k]);
      return;
    }
  out.densest = {fit.parameters[0], fit.standard_deviations[0]};
  out.exponent = {fit.parameters[2], fit.standard_deviations[2]};
}

void check(const ConsolidationCurves& c) {
  const bool rising =
      std::adjacent_find(c.pressure.begin(), c.pressure.end(), std::greater_equal<>()) == c.pressure.end();
  const bool whole =
      std::all_of(c.fraction.begin(), c.fraction.end(), [&](const auto& f) { return f.size() == c.pressure.size(); });
  if (!rising || !whole || c.fraction.empty())
    throw InputError("consolidation: pressures must rise, and every sample have a solid fraction at each");
}

}  // namespace

ConsolidationFit fit_consolidation(const ConsolidationCurves& c) {
  check(c);
  ConsolidationFit out;
  std::vector<double> x;
  for (const double p : c.pressure) x.push_back(std::log(p));
  const std::vector<double> mean = mean_of(c.fraction);
  const std::vector<double> y = inverse(mean);
  const auto stretch = steepest(x, y);
  if (!stretch) {
    out.reason = fmt::format("lambda: the solid fraction does not grow over {} pressures that span a factor of {}",
                             kSlopePoints, kSlopeSpan);
    return out;
  }
  out.usable = true;
  out.low = c.pressure[stretch->first];
  out.high = c.pressure[stretch->last];
  out.begin = std::exp((y.front() - stretch->line.offset) / stretch->line.slope);
  std::vector<double> own;
  for (const auto& f : c.fraction) own.push_back(-line_through(x, inverse(f), stretch->first, stretch->last).slope);
  const MeanError over_samples = mean_error(own);
  out.slope = {over_samples.mean, own.size() > 1 ? over_samples.error : stretch->line.slope_error};
  fit_approach(c.pressure, mean, stretch->last, out);
  return out;
}

}  // namespace softgrain
