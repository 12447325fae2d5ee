#include "calibrate/curve_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/statistics.h"

namespace softgrain {

namespace {

/// Angles are equal when they differ by less than this share of the larger one [-], plus rounding.
constexpr double kAngleTolerance = 1e-6;

bool usable(const TangentialPoint& p) { return p.converged && std::isfinite(p.force_parallel); }

std::optional<double> force_at(const std::vector<TangentialPoint>& points, double angle_deg) {
  for (const TangentialPoint& p : points)
    if (usable(p) && same_angle(p.angle_deg, angle_deg)) return p.force_parallel;
  return std::nullopt;
}

}  // namespace

bool same_angle(double a, double b) {
  return std::abs(a - b) <= kAngleTolerance * std::max(std::abs(a), std::abs(b)) + 1e-12;
}

double tangential_displacement(double angle_deg, double shell_radius) {
  return std::numbers::pi * shell_radius * angle_deg / 180.0;
}

std::optional<double> initial_slope(const std::vector<TangentialPoint>& points, double angle_deg, double shell_radius) {
  double n = 0.0;
  double sum_h = 0.0;
  double sum_f = 0.0;
  const auto used = [&](const TangentialPoint& p) {
    return usable(p) && std::abs(p.angle_deg) <= angle_deg * (1.0 + kAngleTolerance);
  };
  for (const TangentialPoint& p : points) {
    if (!used(p)) continue;
    n += 1.0;
    sum_h += tangential_displacement(p.angle_deg, shell_radius);
    sum_f += p.force_parallel;
  }
  if (n < 2.0) return std::nullopt;
  double hh = 0.0;
  double hf = 0.0;
  for (const TangentialPoint& p : points) {
    if (!used(p)) continue;
    const double h = tangential_displacement(p.angle_deg, shell_radius) - sum_h / n;
    hh += h * h;
    hf += h * (p.force_parallel - sum_f / n);
  }
  const double resolution = kAngleTolerance * tangential_displacement(angle_deg, shell_radius);
  if (hh <= resolution * resolution) return std::nullopt;
  return hf / hh;
}

std::optional<double> secant(const std::vector<TangentialPoint>& points, double angle_deg, double shell_radius) {
  const double ht = tangential_displacement(angle_deg, shell_radius);
  const auto plus = force_at(points, angle_deg);
  const auto minus = force_at(points, -angle_deg);
  if (plus && minus) return (*plus - *minus) / (2.0 * ht);
  const auto before = force_at(points, 0.0);
  if (plus && before) return (*plus - *before) / ht;
  if (minus && before) return (*before - *minus) / ht;
  return std::nullopt;
}

namespace {

/// Overlap ratios are the same when they differ by less than this.
constexpr double kDeltaTolerance = 1e-7;

struct Entry {
  double delta = 0.0;
  std::size_t packing = 0;
  double value = 0.0;
};

bool inside(double delta, const CurveSelection& s) {
  return delta >= s.delta_low - kDeltaTolerance && delta <= s.delta_high + kDeltaTolerance;
}

CurveSamples arrange(std::vector<Entry> entries, std::size_t packings, int left_out) {
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.delta < b.delta; });
  CurveSamples out;
  out.packings = packings;
  out.left_out = left_out;
  for (const Entry& e : entries)
    if (out.delta.empty() || e.delta - out.delta.back() > kDeltaTolerance) out.delta.push_back(e.delta);
  out.value.assign(packings * out.delta.size(), std::numeric_limits<double>::quiet_NaN());
  std::size_t k = 0;
  for (const Entry& e : entries) {
    while (e.delta - out.delta[k] > kDeltaTolerance) ++k;
    out.value[e.packing * out.delta.size() + k] = e.value;
  }
  return out;
}

/// Tangential points of one run that share a Delta.
std::vector<std::vector<TangentialPoint>> by_delta(const PackingRun& run, const CurveSelection& selection) {
  std::vector<TangentialPoint> points;
  for (const TangentialPoint& p : run.tangential)
    if (inside(p.delta, selection)) points.push_back(p);
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.delta < b.delta; });
  std::vector<std::vector<TangentialPoint>> groups;
  for (const TangentialPoint& p : points) {
    if (groups.empty() || p.delta - groups.back().front().delta > kDeltaTolerance) groups.emplace_back();
    groups.back().push_back(p);
  }
  return groups;
}

template <class Stiffness>
CurveSamples stiffness_samples(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection,
                               Stiffness stiffness) {
  std::vector<Entry> entries;
  int left_out = 0;
  const double unit = spec.youngs_modulus * spec.shell_radius;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const auto& points : by_delta(*runs[i], selection)) {
      left_out +=
          static_cast<int>(std::count_if(points.begin(), points.end(), [](const auto& p) { return !p.converged; }));
      if (const auto kt = stiffness(points)) entries.push_back({points.front().delta, i, *kt / unit});
    }
  }
  return arrange(std::move(entries), runs.size(), left_out);
}

}  // namespace

LostTurns lost_turns(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection) {
  LostTurns out;
  for (const PackingRun* run : runs)
    for (const auto& points : by_delta(*run, selection)) {
      ++out.turns;
      if (initial_slope(points, selection.initial_angle_deg, spec.shell_radius) ||
          secant(points, selection.secant_angle_deg, spec.shell_radius))
        continue;
      ++out.lost;
      const auto reaches = [&](const TangentialPoint& p) {
        const double angle = std::abs(p.angle_deg);
        return angle > selection.secant_angle_deg || same_angle(angle, selection.secant_angle_deg);
      };
      out.short_of += std::none_of(points.begin(), points.end(), reaches) ? 1 : 0;
    }
  return out;
}

CurveMeans means_of(const CurveSamples& samples, std::span<const int> multiplicity) {
  CurveMeans out;
  out.delta = samples.delta;
  for (std::size_t k = 0; k < samples.delta.size(); ++k) {
    Tally sample;
    for (std::size_t i = 0; i < samples.packings; ++i)
      if (!std::isnan(samples.at(i, k))) sample.add(samples.at(i, k), multiplicity.empty() ? 1.0 : multiplicity[i]);
    const MeanError m = sample.statistics();
    out.count.push_back(static_cast<double>(m.n));
    out.mean.push_back(m.n > 0 ? m.mean : 0.0);
    out.deviation.push_back(m.deviation_or_zero());
  }
  return out;
}

std::vector<double> floored_deviations(const CurveMeans& means, double scatter_floor) {
  constexpr double kShareOfLargest = 1e-4;
  double squares = 0.0;
  double largest = 0.0;
  for (std::size_t k = 0; k < means.delta.size(); ++k) {
    squares += means.deviation[k] * means.deviation[k];
    largest = std::max(largest, std::abs(means.mean[k]));
  }
  const double pooled = means.delta.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(means.delta.size()));
  double floor = std::max(scatter_floor * pooled, kShareOfLargest * largest);
  if (floor <= 0.0) floor = 1.0;  // every value is zero: the scale is immaterial
  std::vector<double> out = means.deviation;
  for (double& s : out) s = std::max(s, floor);
  return out;
}

CurveSamples normal_samples(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection) {
  std::vector<Entry> entries;
  int left_out = 0;
  const double unit = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const NormalPoint& p : runs[i]->normal) {
      if (!inside(p.delta, selection)) continue;
      if (p.converged && std::isfinite(p.force))
        entries.push_back({p.delta, i, p.force / unit});
      else
        ++left_out;
    }
  }
  return arrange(std::move(entries), runs.size(), left_out);
}

CurveSamples initial_slope_samples(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection) {
  return stiffness_samples(runs, spec, selection, [&](const std::vector<TangentialPoint>& points) {
    return initial_slope(points, selection.initial_angle_deg, spec.shell_radius);
  });
}

CurveSamples secant_samples(const RunList& runs, const SoftParticleSpec& spec, const CurveSelection& selection) {
  return stiffness_samples(runs, spec, selection, [&](const std::vector<TangentialPoint>& points) {
    return secant(points, selection.secant_angle_deg, spec.shell_radius);
  });
}

}  // namespace softgrain
