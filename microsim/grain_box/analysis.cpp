#include "microsim/grain_box/analysis.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "common/core/limits.h"
#include "common/core/particles.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

constexpr double kNear = 0.1;
constexpr double kJammed = 0.63;
constexpr double kContacts = 6.0;
constexpr double kBytesPerGrain = 11000.0;  // a process with 2740 grains had 31 MB

double mean_radius_cubed(const GrainBoxMaterial& m) {
  if (m.sizes) return m.sizes->mean_volume();
  const double a = m.radius_min;
  const double b = m.radius_max;
  return 0.25 * (a + b) * (a * a + b * b);
}

double medium_bulk(const GrainBoxSpec& spec, double pressure) {
  const GrainBoxMaterial& m = spec.material;
  return effective_medium(
             {pressure, kJammed, kContacts, m.youngs_modulus / (2.0 * (1.0 + m.poisson_ratio)), m.poisson_ratio})
      .bulk;
}

/// Largest axis strain of the loading. K = A sigma^(1/3), so eps_v = 3/2 (sigma_2^(2/3) - sigma_1^(2/3))/A.
double loading_strain(const GrainBoxSpec& spec) {
  double strain = spec.loading.end_strain;
  if (std::isfinite(spec.loading.end_stress)) {
    const double start = spec.generation.pressure;
    const double end = std::max(start, spec.loading.end_stress);
    const double a = medium_bulk(spec, end) / std::cbrt(end);
    const double volume = 1.5 * (std::cbrt(end * end) - std::cbrt(start * start)) / a;
    double rate = 0.0;
    double fastest = 0.0;
    for (int k = 0; k < 3; ++k) {
      if (spec.loading.control[static_cast<std::size_t>(k)] == AxisControl::stress) continue;
      rate += spec.loading.strain_rate[k];
      fastest = std::max(fastest, std::abs(spec.loading.strain_rate[k]));
    }
    if (rate > 0.0) strain = std::min(strain, volume * fastest / rate);
  }
  return strain;
}

}  // namespace

ModuliAt moduli_at(const GrainBoxResult& result, double pressure) {
  std::vector<double> bulk;
  std::vector<double> shear;
  std::vector<double> force;
  for (const BoxPoint* p : result.points_of(BoxPhase::loading)) {
    if (std::abs(p->pressure / pressure - 1.0) > kNear) continue;
    force.push_back(p->mean_force / p->pressure * pressure);
    if (std::isfinite(p->bulk)) bulk.push_back(p->bulk);
    if (std::isfinite(p->shear_modulus)) shear.push_back(p->shear_modulus);
  }
  const auto known = [](const std::vector<double>& values) {
    return values.size() < 3 ? MeanError{values.size(), kNaN, kNaN, kNaN} : mean_error(values);
  };
  const MeanError k = known(bulk);
  const MeanError g = known(shear);
  const MeanError f = known(force);
  return {pressure, k.mean, k.error, g.mean, g.error, f.mean, f.error, k.n};
}

std::vector<double> comparison_stresses(const std::vector<GrainBoxResult>& results) {
  double low = 0.0;
  double high = 0.0;
  for (const GrainBoxResult& r : results)
    for (const BoxPoint* p : r.points_of(BoxPhase::loading)) {
      low = low > 0.0 ? std::min(low, p->pressure) : p->pressure;
      high = std::max(high, p->pressure);
    }
  std::vector<double> out;
  if (!(low > 0.0)) return out;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high; decade *= 10.0)
    for (const double digit : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0})
      if (digit * decade >= low && digit * decade <= high) out.push_back(digit * decade);
  return out;
}

double pressure_of_smallest_shear(const GrainBoxResult& result) {
  constexpr std::size_t window = 10;
  std::vector<const BoxPoint*> points = result.points_of(BoxPhase::friction);
  const std::vector<const BoxPoint*> loading = result.points_of(BoxPhase::loading);
  points.insert(points.end(), loading.begin(), loading.end());
  double smallest = std::numeric_limits<double>::infinity();
  double pressure = kNaN;
  for (std::size_t k = 0; k + window <= points.size(); ++k) {
    double shear = 0.0;
    double stress = 0.0;
    for (std::size_t n = k; n < k + window; ++n) {
      shear += points[n]->shear_modulus;
      stress += points[n]->pressure;
    }
    if (!(shear < smallest)) continue;
    smallest = shear;
    pressure = stress / static_cast<double>(window);
  }
  return pressure;
}

double largest_over_pressure(const GrainBoxResult& result, double BoxPoint::*stress) {
  double largest = 0.0;
  for (const BoxPoint* p : result.points_of(BoxPhase::loading))
    largest = larger_or_nan(largest, p->*stress / p->pressure);
  return largest;
}

StepEffort total_effort(const GrainBoxState& state) {
  StepEffort sum;
  for (const BoxPoint& p : state.points) {
    sum.residual = std::max(sum.residual, p.effort.residual);
    sum.iterations += p.effort.iterations;
    sum.loop_passes += p.effort.loop_passes;
    sum.contact_evaluations += p.effort.contact_evaluations;
    sum.factorisations += p.effort.factorisations;
    sum.linear_iterations += p.effort.linear_iterations;
    sum.solutions += p.effort.solutions;
    sum.retries += p.effort.retries;
  }
  return sum;
}

GrainBoxForecast forecast(const GrainBoxSpec& spec) {
  GrainBoxForecast out;
  const auto grains = static_cast<double>(spec.grains);
  const double cubed = mean_radius_cubed(spec.material);
  out.box_length = std::cbrt(grains * kSphereVolume * cubed / kJammed);
  double left = loading_strain(spec);
  for (std::size_t k = 0; k < spec.loading.stage_strains.size() && left > 0.0; ++k) {
    const double part = std::min(left, spec.loading.stage_strains[k]);
    out.increments += part / spec.loading.increments[k];
    left -= part;
  }
  out.increments += left / spec.loading.increments.back();
  double stress = spec.generation.pressure;
  if (std::isfinite(spec.loading.end_stress)) stress = std::max(stress, spec.loading.end_stress);
  for (const double held : spec.loading.stress.v) stress = std::max(stress, held);
  // Mean normal force P = 4 pi R^2 sigma/(phi C); Hertz: P = 4/3 E* sqrt(R/2) h^(3/2).
  const double r = std::cbrt(cubed);
  const double force = 4.0 * std::numbers::pi * r * r * stress / (kJammed * kContacts);
  const double nu = spec.material.poisson_ratio;
  const double modulus = spec.material.youngs_modulus / (2.0 * (1.0 - nu * nu));
  out.overlap_ratio = std::pow(force / (4.0 / 3.0 * modulus * std::sqrt(0.5 * r)), 2.0 / 3.0) / r;
  out.contacts = 0.5 * kContacts * grains;
  out.bytes = kBytesPerGrain * grains;
  return out;
}

namespace {

using Arrangements = std::vector<const GrainBoxResult*>;

MeanError mean_over(const Arrangements& all, const std::function<double(const GrainBoxResult&)>& value) {
  std::vector<double> values;
  for (const GrainBoxResult* r : all)
    if (const double v = value(*r); std::isfinite(v)) values.push_back(v);
  MeanError m = mean_error(values);
  if (m.n < 2) m.mean = m.error = kNaN;
  return m;
}

OverArrangements statistics_of(const Arrangements& all, const std::vector<double>& stresses) {
  OverArrangements out;
  out.pack = all.front()->spec.of;
  out.arrangements = all.size();
  for (const double stress : stresses) {
    const MeanError bulk = mean_over(all, [&](const GrainBoxResult& r) { return moduli_at(r, stress).bulk; });
    const MeanError shear = mean_over(all, [&](const GrainBoxResult& r) { return moduli_at(r, stress).shear; });
    const MeanError force = mean_over(all, [&](const GrainBoxResult& r) { return moduli_at(r, stress).force; });
    out.moduli.push_back({stress, bulk.mean, bulk.error, shear.mean, shear.error, force.mean, force.error, bulk.n});
  }
  const MeanError sliding = mean_over(all, [&](const GrainBoxResult& r) {
    const auto points = r.points_of(BoxPhase::loading);
    return points.empty() ? kNaN : points.back()->sliding_share;
  });
  out.sliding = sliding.mean;
  out.sliding_error = sliding.error;
  return out;
}

}  // namespace

std::vector<OverArrangements> over_arrangements(const std::vector<GrainBoxResult>& results) {
  const std::vector<double> stresses = comparison_stresses(results);
  std::vector<Arrangements> packs;
  for (const GrainBoxResult& r : results) {
    if (!r.usable) continue;
    const auto known = std::find_if(packs.begin(), packs.end(),
                                    [&](const Arrangements& a) { return a.front()->spec.of == r.spec.of; });
    if (known == packs.end())
      packs.push_back({&r});
    else
      known->push_back(&r);
  }
  std::vector<OverArrangements> out;
  for (const Arrangements& pack : packs)
    if (pack.size() > 1) out.push_back(statistics_of(pack, stresses));
  return out;
}

}  // namespace softgrain
