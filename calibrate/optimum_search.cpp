#include "calibrate/optimum_search.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include "calibrate/bootstrap.h"
#include "calibrate/draws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

using BoxPoint = std::vector<double>;

constexpr int kReplicates = 400;

/// The best of what a quadratic function takes on [0, 1]: exact from its values at 0, 1/2 and 1.
double best_of_quadratic(const std::function<double(double)>& f) {
  const double a = f(0.0);
  const double b = f(0.5);
  const double c = f(1.0);
  double best = c > a ? 1.0 : 0.0;
  const double curvature = 2.0 * (a - 2.0 * b + c);
  if (curvature < 0.0) {
    const double top = std::clamp(0.5 - 0.5 * (c - a) / curvature, 0.0, 1.0);
    if (f(top) > f(best)) best = top;
  }
  return best;
}

/// Stationary point of a surface of two inputs inside the box.
std::optional<BoxPoint> stationary_point(const ResponseSurface& surface) {
  const BoxPoint g = surface.gradient({0.0, 0.0});
  const BoxPoint by_x = surface.gradient({1.0, 0.0});
  const BoxPoint by_y = surface.gradient({0.0, 1.0});
  const double xx = by_x[0] - g[0];
  const double xy = by_x[1] - g[1];
  const double yy = by_y[1] - g[1];
  const double determinant = xx * yy - xy * xy;
  if (!(std::abs(determinant) > 0.0)) return std::nullopt;
  const double x = (-g[0] * yy + g[1] * xy) / determinant;
  const double y = (-g[1] * xx + g[0] * xy) / determinant;
  const bool inside = x > 0.0 && x < 1.0 && y > 0.0 && y < 1.0;
  return inside ? std::optional(BoxPoint{x, y}) : std::nullopt;
}

double box_distance(const BoxPoint& a, const BoxPoint& b) {
  double square = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(square);
}

/// Surface through some of the points.
ResponseSurface surface_of(const std::vector<BoxPoint>& points, const std::vector<double>& values,
                           const std::vector<std::size_t>& some) {
  std::vector<BoxPoint> at;
  std::vector<std::vector<double>> z;
  for (const std::size_t p : some) {
    at.push_back(points[p]);
    z.push_back({values[p]});
  }
  // Rounds come as near to each other as 1e-3 of the range: the ridge of surfaces over the box would flatten that.
  constexpr double kRidge = 1e-11;
  return {at, z, std::vector<double>(some.size(), 1.0), kRidge};
}

std::vector<std::size_t> nearest_points(const std::vector<BoxPoint>& points, const BoxPoint& to, std::size_t count) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return box_distance(points[a], to) < box_distance(points[b], to);
  });
  order.resize(std::min(count, order.size()));
  std::sort(order.begin(), order.end());
  return order;
}

bool is_inside(const BoxPoint& u) {
  return std::all_of(u.begin(), u.end(), [](double x) { return x > 0.0 && x < 1.0; });
}

/// Values at all points of one replicate.
std::vector<double> drawn_values(const SearchedPoints& data, const OptimumEstimate& fit, RandomStream& random) {
  std::vector<double> out(data.points.size(), 0.0);
  if (fit.over_seeds) {
    const std::size_t seeds = data.values.front().size();
    for (std::size_t k = 0; k < seeds; ++k) {
      const auto s = static_cast<std::size_t>(random.below(seeds));
      for (std::size_t p = 0; p < out.size(); ++p) out[p] += data.values[p][s] / static_cast<double>(seeds);
    }
    return out;
  }
  const auto n = static_cast<double>(fit.fitted.size());
  const auto free = n - static_cast<double>(ResponseSurface::coefficients(data.points.front().size()));
  const double scale = free > 0.0 ? std::sqrt(n / free) : 0.0;
  for (const std::size_t p : fit.fitted)
    out[p] = fit.surfaces.front().value(data.points[p])[0] + scale * fit.residuals[random.below(fit.residuals.size())];
  return out;
}

double squared_residuals(const ResponseSurface& surface, const std::vector<BoxPoint>& points,
                         const std::vector<double>& means, const std::vector<std::size_t>& some) {
  double sum = 0.0;
  for (const std::size_t p : some) sum += std::pow(means[p] - surface.value(points[p])[0], 2);
  return sum;
}

/// The most of the points nearest to a place, `least` or more, whose surface is that of the nearest `least` as far as
/// their scatter tells (predictive test of Chow 1960, doi:10.2307/1910133; a
/// rejection by chance costs more than some bias, so the level is low): a surface of few points close to
/// each other says less about the place of a flat top than one of many.
std::vector<std::size_t> widest_window(const std::vector<BoxPoint>& points, const std::vector<double>& means,
                                       const BoxPoint& place, std::size_t least, std::size_t coefficients) {
  constexpr double kLevel = 0.002;
  const auto residuals = [&](const std::vector<std::size_t>& some) {
    return squared_residuals(surface_of(points, means, some), points, means, some);
  };
  const std::vector<std::size_t> narrow = nearest_points(points, place, least);
  const double near = residuals(narrow);
  const auto free = static_cast<double>(least - coefficients);
  for (std::size_t count = points.size(); count > least; --count) {
    const std::vector<std::size_t> wide = nearest_points(points, place, count);
    const auto more = static_cast<double>(count - least);
    const double ratio = (residuals(wide) - near) / more / (near / free);
    if (near > 0.0 && gsl_cdf_fdist_Q(std::max(ratio, 0.0), more, free) > kLevel) return wide;
  }
  return narrow;
}

/// Fits `out` to the points near the optimum, which the window follows.
SurfaceOptimum fit_window(const std::vector<BoxPoint>& points, const std::vector<double>& means,
                          std::size_t coefficients, bool maximise, OptimumEstimate& out) {
  const std::size_t least = std::max(coefficients + 2, (points.size() + 1) / 2);
  out.fitted = nearest_points(points, points.front(), points.size());
  SurfaceOptimum best = optimum_of(surface_of(points, means, out.fitted), maximise);
  constexpr int kTurns = 3;
  for (int turn = 0; turn < kTurns && least < points.size(); ++turn) {
    out.fitted = widest_window(points, means, best.u, least, coefficients);
    best = optimum_of(surface_of(points, means, out.fitted), maximise);
  }
  out.surfaces.push_back(surface_of(points, means, out.fitted));
  for (const std::size_t p : out.fitted) out.residuals.push_back(means[p] - out.surfaces.front().value(points[p])[0]);
  return best;
}

/// By what intervals of replicates are too narrow; infinite where nothing scatters about the surface.
double widening_of(const SearchedPoints& data, const OptimumEstimate& fit) {
  if (fit.over_seeds) return few_samples_factor(data.values.front().size());
  const std::size_t coefficients = ResponseSurface::coefficients(data.points.front().size());
  if (fit.fitted.size() <= coefficients) return kInfinity;
  return student_over_normal(static_cast<double>(fit.fitted.size() - coefficients));
}

Estimate interval_estimate(double value, const std::vector<double>& replicates, double factor, double least,
                           double most) {
  if (!std::isfinite(factor)) return {value, kInfinity, least, most};
  const auto [from, to] = interval95(replicates);
  const auto [low, high] = widened(value, std::min(from, value), std::max(to, value), factor, false);
  return {value, scatter_of(replicates), std::max(least, low), std::min(most, high)};
}

}  // namespace

SurfaceOptimum optimum_of(const ResponseSurface& surface, bool maximise) {
  if (surface.dimensions() < 1 || surface.dimensions() > 2 || surface.quantities() != 1)
    throw InputError("optimum of a surface: one or two inputs and one quantity");
  const double sign = maximise ? 1.0 : -1.0;
  const auto height = [&](const BoxPoint& u) { return sign * surface.value(u)[0]; };
  std::vector<BoxPoint> candidates;
  if (surface.dimensions() == 1) {
    candidates.push_back({best_of_quadratic([&](double x) { return height({x}); })});
  } else {
    if (const auto top = stationary_point(surface)) candidates.push_back(*top);
    for (const double end : {0.0, 1.0}) {
      candidates.push_back({best_of_quadratic([&](double x) { return height({x, end}); }), end});
      candidates.push_back({end, best_of_quadratic([&](double y) { return height({end, y}); })});
    }
  }
  const auto best = std::max_element(candidates.begin(), candidates.end(),
                                     [&](const BoxPoint& a, const BoxPoint& b) { return height(a) < height(b); });
  return {*best, sign * height(*best)};
}

OptimumEstimate find_optimum(const SearchedPoints& data, bool maximise, std::uint64_t seed) {
  OptimumEstimate out;
  const std::size_t inputs = data.points.empty() ? 0 : data.points.front().size();
  const std::size_t coefficients = ResponseSurface::coefficients(inputs);
  if (data.points.size() < coefficients || inputs == 0) {
    out.message =
        fmt::format("{} with the number, a surface needs {}", counted(data.points.size(), "point"), coefficients);
    return out;
  }
  std::vector<double> means;
  for (const std::vector<double>& v : data.values) means.push_back(mean_error(v).mean);
  const SurfaceOptimum best = fit_window(data.points, means, coefficients, maximise, out);
  out.over_seeds = data.values.front().size() >= kLeastSearchSeeds;
  const auto drawn = bootstrap_replicates(kReplicates, seed, 0, "refitting the surface",
                                          [&](RandomStream& random) { return drawn_values(data, out, random); });
  std::vector<std::vector<double>> places(inputs);
  std::vector<double> values;
  for (const std::vector<double>& one : drawn) {
    out.surfaces.push_back(surface_of(data.points, one, out.fitted));
    const SurfaceOptimum top = optimum_of(out.surfaces.back(), maximise);
    for (std::size_t k = 0; k < inputs; ++k) places[k].push_back(top.u[k]);
    values.push_back(top.value);
    out.inside += is_inside(top.u) ? 1.0 / kReplicates : 0.0;
  }
  const double factor = widening_of(data, out);
  for (std::size_t k = 0; k < inputs; ++k) out.u.push_back(interval_estimate(best.u[k], places[k], factor, 0.0, 1.0));
  out.value = interval_estimate(best.value, values, factor, -kInfinity, kInfinity);
  out.usable = true;
  out.message = "";
  return out;
}

std::vector<std::vector<double>> first_search_points(std::size_t inputs) {
  if (inputs == 1) return {{0.0}, {0.25}, {0.5}, {0.75}, {1.0}};
  std::vector<BoxPoint> out;
  for (const double x : {0.0, 0.5, 1.0})
    for (const double y : {0.0, 0.5, 1.0}) out.push_back({x, y});
  return out;
}

std::vector<std::vector<double>> next_search_points(const std::vector<double>& optimum,
                                                    const std::vector<std::vector<double>>& there, int round) {
  const double step = (optimum.size() == 1 ? 0.25 : 0.5) * std::pow(0.5, round);
  std::vector<BoxPoint> wanted{optimum};
  for (std::size_t k = 0; k < optimum.size(); ++k)
    for (const double side : {-step, step}) {
      wanted.push_back(optimum);
      wanted.back()[k] = std::clamp(optimum[k] + side, 0.0, 1.0);
    }
  std::vector<BoxPoint> out;
  for (const BoxPoint& u : wanted) {
    const auto near = [&](const BoxPoint& known) { return box_distance(known, u) < 0.25 * step; };
    if (std::none_of(there.begin(), there.end(), near) && std::none_of(out.begin(), out.end(), near)) out.push_back(u);
  }
  return out;
}

}  // namespace softgrain
