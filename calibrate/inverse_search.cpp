#include "calibrate/inverse_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrate/bootstrap.h"
#include "calibrate/draws.h"
#include "calibrate/response_surface.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/random.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

/// Streams beside those of the bootstrap over packings (1, 2): of replicates, and of the shift of points.
constexpr std::uint64_t kReplicateStream = std::uint64_t{3} << 32;
constexpr std::uint64_t kShiftStream = std::uint64_t{4} << 32;

/// Mean force over packings at one Delta.
MeanError mean_at(const InverseEvaluation& e, std::size_t j, std::size_t deltas, const std::vector<int>& times) {
  Tally sample;
  for (std::size_t k = 0; k < e.packings; ++k)
    if (const double f = e.force[k * deltas + j]; !std::isnan(f)) sample.add(f, times.empty() ? 1.0 : times[k]);
  return sample.statistics();
}

/// Everything that surfaces are laid through: values g(mean), errors of the target in the same terms.
struct Prepared {
  std::vector<std::vector<double>> points;
  std::vector<std::vector<double>> values;
  std::vector<double> misfit;
  std::vector<double> target;
  std::vector<double> error;
  std::vector<double> scale;  ///< c_j of g
};

double g(double force, double scale) { return std::asinh(force / scale); }

/// Where g turns from linear to logarithmic: at the wanted force, or at twice its error where that is more.
std::vector<double> scales(const InverseTarget& t) {
  const double largest = *std::max_element(t.force.begin(), t.force.end());
  std::vector<double> out;
  for (std::size_t j = 0; j < t.force.size(); ++j)
    out.push_back(std::max({std::abs(t.force[j]), 2.0 * t.error[j], 0.02 * largest}));
  return out;
}

/// Error of target and simulation together at each Delta [force]; the simulation's from the evaluations nearest to the
/// target.
std::vector<double> total_errors(const std::vector<InverseEvaluation>& done, const InverseTarget& t,
                                 const std::vector<int>& times) {
  const std::size_t n = t.delta.size();
  std::vector<const InverseEvaluation*> nearest;
  for (const InverseEvaluation& e : done)
    if (e.usable(n)) nearest.push_back(&e);
  std::stable_sort(nearest.begin(), nearest.end(),
                   [&](const auto* a, const auto* b) { return misfit_of(*a, t) < misfit_of(*b, t); });
  nearest.resize(std::min<std::size_t>(nearest.size(), 5));
  const double largest = *std::max_element(t.force.begin(), t.force.end());
  std::vector<double> out;
  for (std::size_t j = 0; j < n; ++j) {
    double variance =
        t.error[j] * t.error[j] + std::pow(t.discrepancy * std::max(std::abs(t.force[j]), 0.02 * largest), 2);
    for (const InverseEvaluation* e : nearest)
      variance += std::pow(mean_at(*e, j, n, times).error_or_zero(), 2) / static_cast<double>(nearest.size());
    out.push_back(std::sqrt(variance));
  }
  return out;
}

Prepared prepare(const std::vector<InverseEvaluation>& done, const InverseTarget& t, const std::vector<int>& times,
                 const std::vector<double>& wanted, const std::vector<double>& errors) {
  const std::size_t n = t.delta.size();
  Prepared out;
  out.scale = scales(t);
  for (std::size_t j = 0; j < n; ++j) {
    out.target.push_back(g(wanted[j], out.scale[j]));
    out.error.push_back(errors[j] / std::hypot(t.force[j], out.scale[j]));  // dg/dF at the target
  }
  for (const InverseEvaluation& e : done) {
    if (!e.usable(n)) continue;
    std::vector<double> row;
    double chi2 = 0.0;
    for (std::size_t j = 0; j < n; ++j) {
      double mean = mean_at(e, j, n, times).mean;
      if (std::isnan(mean)) mean = mean_at(e, j, n, {}).mean;  // a draw without any packing that has this force
      row.push_back(g(mean, out.scale[j]));
      chi2 += std::pow((row.back() - out.target[j]) / out.error[j], 2);
    }
    out.points.push_back(e.u);
    out.values.push_back(std::move(row));
    out.misfit.push_back(chi2);
  }
  return out;
}

double distance2(const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& width) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow((a[i] - b[i]) / width[i], 2);
  return sum;
}

/// Weights that fall with the distance from a centre; widened until at least 1.5 times as many points as coefficients
/// count.
std::vector<double> local_weights(const Prepared& p, const std::vector<double>& centre, std::vector<double> width) {
  const double needed = 1.5 * static_cast<double>(ResponseSurface::coefficients(centre.size()));
  for (int k = 0;; ++k) {
    std::vector<double> w;
    double sum = 0.0;
    for (const std::vector<double>& u : p.points) {
      w.push_back(std::exp(-0.5 * distance2(u, centre, width)));
      sum += w.back();
    }
    if (sum >= needed || k == 40) return w;
    for (double& x : width) x *= 1.15;
  }
}

/// The best points of those evaluated, as starts.
std::vector<std::vector<double>> starts_of(const Prepared& p, std::size_t count) {
  std::vector<std::size_t> order(p.points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p.misfit[a] < p.misfit[b]; });
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < std::min(count, order.size()); ++i) out.push_back(p.points[order[i]]);
  return out;
}

/// A place and how far around it the target leaves open.
struct Place {
  std::vector<double> u;
  std::vector<double> width;
  std::vector<double> weights;
  SurfaceMinimum minimum;
};

std::vector<double> open_widths(const SurfaceMinimum& m) {
  std::vector<double> width;
  const std::size_t d = m.u.size();
  for (std::size_t a = 0; a < d; ++a) {
    const double variance = m.covariance.size() == d * d ? m.covariance[a * d + a] : 1.0;
    const double error = variance > 0.0 ? std::sqrt(variance) : 0.0;  // 0: at an end of the range
    width.push_back(error > 0.0 ? std::clamp(1.5 * error, 0.12, 0.5) : 0.2);
  }
  return width;
}

/// First over the whole box, then twice around what was found.
Place locate(const Prepared& p) {
  const std::size_t d = p.points.front().size();
  Place at{std::vector<double>(d, 0.5), std::vector<double>(d, 0.0), {}, {}};
  // Points whose curves are far from the target say little about it: their weight falls with the misfit.
  std::vector<double> sorted = p.misfit;
  std::sort(sorted.begin(), sorted.end());
  const double typical = std::max(sorted[std::min(sorted.size() - 1, 2 * ResponseSurface::coefficients(d))], 1e-12);
  for (const double m : p.misfit) at.weights.push_back(1.0 / (1.0 + m / typical));
  for (int round = 0; round < 3; ++round) {
    const ResponseSurface surface(p.points, p.values, at.weights);
    std::vector<std::vector<double>> starts = starts_of(p, 4);
    if (round > 0) starts.insert(starts.begin(), at.u);
    at.minimum = nearest_to(surface, p.target, p.error, starts);
    at.u = at.minimum.u;
    at.width = open_widths(at.minimum);
    std::vector<double> reach = at.width;
    for (double& x : reach) x *= 2.0;
    if (round < 2) at.weights = local_weights(p, at.u, reach);
  }
  return at;
}

}  // namespace

bool InverseEvaluation::usable(std::size_t deltas) const {
  for (std::size_t j = 0; j < deltas; ++j)
    if (std::isnan(mean_at(*this, j, deltas, {}).mean)) return false;
  return packings > 0;
}

double misfit_of(const InverseEvaluation& e, const InverseTarget& t) {
  const std::size_t n = t.delta.size();
  if (!e.usable(n)) return kInfinity;
  const double largest = *std::max_element(t.force.begin(), t.force.end());
  double sum = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    const MeanError m = mean_at(e, j, n, {});
    const double off = t.discrepancy * std::max(std::abs(t.force[j]), 0.02 * largest);
    sum += std::pow(m.mean - t.force[j], 2) / (t.error[j] * t.error[j] + std::pow(m.error_or_zero(), 2) + off * off);
  }
  return sum / static_cast<double>(n);
}

std::vector<double> spread_point(std::uint64_t seed, std::size_t index, std::size_t dimensions) {
  constexpr std::array<std::size_t, 8> kPrimes{2, 3, 5, 7, 11, 13, 17, 19};
  RandomStream shift(seed, RandomPurpose::bootstrap, kShiftStream);
  std::vector<double> u;
  for (std::size_t a = 0; a < dimensions; ++a) {
    double value = shift.uniform();
    double share = 1.0;
    for (std::size_t i = index + 1; i > 0; i /= kPrimes[a]) {
      share /= static_cast<double>(kPrimes[a]);
      value += share * static_cast<double>(i % kPrimes[a]);
    }
    u.push_back(value - std::floor(value));
  }
  return u;
}

namespace {

/// Whether this point was evaluated already, near enough.
bool is_known(const std::vector<InverseEvaluation>& done, const std::vector<double>& u) {
  constexpr double kSame = 1e-3;
  for (const InverseEvaluation& e : done) {
    double farthest = 0.0;
    for (std::size_t a = 0; a < u.size(); ++a) farthest = std::max(farthest, std::abs(e.u[a] - u[a]));
    if (farthest < kSame) return true;
  }
  return false;
}

}  // namespace

std::vector<std::vector<double>> next_points(const std::vector<InverseEvaluation>& done, const InverseTarget& t,
                                             std::uint64_t seed, std::size_t count) {
  const std::size_t d = done.front().u.size();
  const Prepared p = prepare(done, t, {}, t.force, total_errors(done, t, {}));
  std::vector<std::vector<double>> out;
  if (p.points.size() < ResponseSurface::coefficients(d)) {  // still too little known for a surface
    for (std::size_t k = 0; k < count; ++k) out.push_back(spread_point(seed, done.size() + k, d));
    return out;
  }
  const Place at = locate(p);
  if (!is_known(done, at.u)) out.push_back(at.u);
  for (std::size_t k = 1; out.size() < count; ++k) {
    std::vector<double> u = spread_point(seed, done.size() + k, d);
    for (std::size_t a = 0; a < d; ++a) {
      const double low = std::clamp(at.u[a] - at.width[a], 0.0, 1.0);
      const double high = std::clamp(at.u[a] + at.width[a], 0.0, 1.0);
      u[a] = low + (high - low) * u[a];
    }
    out.push_back(std::move(u));
  }
  return out;
}

namespace {

/// One answer from packings, evaluations and target drawn anew.
std::vector<double> redrawn(const std::vector<InverseEvaluation>& done, const InverseTarget& t, const Place& best,
                            const std::vector<double>& errors, RandomStream& random) {
  std::size_t packings = 0;
  for (const InverseEvaluation& e : done) packings = std::max(packings, e.packings);
  std::vector<int> times(packings, 0);
  for (std::size_t k = 0; k < packings; ++k) ++times[random.below(packings)];
  // Errors along a measured curve are partly common to it: half of the variance is taken so.
  const double common = random.normal();
  std::vector<double> wanted = t.force;
  for (std::size_t j = 0; j < wanted.size(); ++j) wanted[j] += t.error[j] * std::sqrt(0.5) * (common + random.normal());
  const Prepared p = prepare(done, t, times, wanted, errors);
  std::vector<double> weights = best.weights;
  for (double& w : weights)
    w *= -std::log(random.uniform());  // Bayesian bootstrap: how far the answer hangs on single points
  const ResponseSurface surface(p.points, p.values, weights);
  return nearest_to(surface, p.target, p.error, {best.u}).u;
}

/// 95 % interval of one coordinate, widened as bootstraps over few packings are too narrow.
void fill_interval(const std::vector<double>& values, double centre, std::size_t packings, InverseAnswer& out) {
  const double widen = factor_of_several(static_cast<std::int64_t>(packings));
  const auto [low, high] = interval95(values);
  out.low.push_back(std::clamp(centre - widen * std::max(centre - low, 0.0), 0.0, 1.0));
  out.high.push_back(std::clamp(centre + widen * std::max(high - centre, 0.0), 0.0, 1.0));
}

/// A valley of good points may be longer than the surface at its best point knows: what was evaluated and is as good,
/// by chi^2 within 3.84 (95 % of one parameter) of the best, belongs to the interval.
void include_good_points(const std::vector<InverseEvaluation>& done, const InverseTarget& t, InverseAnswer& out) {
  constexpr double kChi2 = 3.841458820694124;
  const auto n = static_cast<double>(t.delta.size());
  double best = kInfinity;
  for (const InverseEvaluation& e : done) best = std::min(best, n * misfit_of(e, t));
  for (const InverseEvaluation& e : done) {
    if (!(n * misfit_of(e, t) <= best + kChi2)) continue;
    for (std::size_t a = 0; a < e.u.size(); ++a) {
      out.low[a] = std::min(out.low[a], e.u[a]);
      out.high[a] = std::max(out.high[a], e.u[a]);
    }
  }
}

/// rms over the points that count of (mean - surface)/error.
double lack_of_fit(const Prepared& p, const Place& at, const ResponseSurface& surface) {
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const std::vector<double> z = surface.value(p.points[i]);
    for (std::size_t j = 0; j < z.size(); ++j) {
      sum += at.weights[i] * std::pow((z[j] - p.values[i][j]) / p.error[j], 2);
      weight += at.weights[i];
    }
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

}  // namespace

InverseAnswer answer(const std::vector<InverseEvaluation>& done, const InverseTarget& t, std::uint64_t seed,
                     int replicates) {
  const std::size_t d = done.front().u.size();
  const std::vector<double> errors = total_errors(done, t, {});
  const Prepared p = prepare(done, t, {}, t.force, errors);
  if (p.points.size() < ResponseSurface::coefficients(d))
    throw UnusableResult(fmt::format("search: {} of {} evaluations gave forces at every overlap, {} are needed",
                                     p.points.size(), done.size(), ResponseSurface::coefficients(d)));
  const Place at = locate(p);
  const ResponseSurface surface(p.points, p.values, at.weights);
  InverseAnswer out;
  out.u = at.u;
  out.misfit = at.minimum.chi2 / static_cast<double>(t.delta.size());
  out.lack_of_fit = lack_of_fit(p, at, surface);
  const std::vector<double> z = surface.value(at.u);
  for (std::size_t j = 0; j < z.size(); ++j) out.predicted.push_back(p.scale[j] * std::sinh(z[j]));
  const auto draws = bootstrap_replicates(replicates, seed, kReplicateStream, "drawing intervals",
                                          [&](RandomStream& random) { return redrawn(done, t, at, errors, random); });
  out.replicates = replicates;
  std::size_t packings = 0;
  for (const InverseEvaluation& e : done) packings = std::max(packings, e.packings);
  for (std::size_t a = 0; a < d; ++a) {
    std::vector<double> values;
    for (const auto& u : draws) values.push_back(u[a]);
    fill_interval(values, out.u[a], packings, out);
    const double variance = at.minimum.covariance.size() == d * d ? at.minimum.covariance[a * d + a] : 0.0;
    out.standard_error.push_back(std::sqrt(std::max(variance, 0.0)));
  }
  include_good_points(done, t, out);
  constexpr double kAtEnd = 1e-6;
  for (std::size_t a = 0; a < d; ++a) out.open.push_back(out.low[a] <= kAtEnd || out.high[a] >= 1.0 - kAtEnd);
  out.correlation = correlations(draws, d);
  return out;
}

}  // namespace softgrain
