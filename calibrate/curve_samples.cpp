#include "calibrate/curve_samples.h"

#include <algorithm>
#include <cmath>

#include "calibrate/tangential_stiffness.h"
#include "common/core/statistics.h"

namespace softgrain {

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
