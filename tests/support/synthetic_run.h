// A made-up run directory: data with known means, for tests of comparisons and reports.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"

namespace softgrain::synthetic {

/// A repeatable number in (-1, 1) out of two indices.
inline double wobble(int i, int j) {
  const double x = std::sin(12.9898 * (i + 1) + 78.233 * (j + 1)) * 43758.5453;
  return 2.0 * (x - std::floor(x)) - 1.0;
}

inline constexpr double kA = 0.58, kB = 2.8, kDelta = 0.065;
inline constexpr double kKtA = 3.1, kKtB = 1.9;

/// F/(E Rs^2) of a law a (D^b - delta^b).
inline double law(double a, double b, double overlap) {
  return overlap < kDelta ? 0.0 : a * (std::pow(overlap, b) - std::pow(kDelta, b));
}

inline PackingInfo packing(int index) {
  PackingInfo p;
  p.seed = static_cast<std::uint64_t>(100 + index);
  p.grains = 400 + index;
  p.solid_fraction = 0.71 + 0.01 * wobble(index, 7);
  p.contacts_per_grain = 0.8;
  p.exponent = 3.5 + 0.1 * wobble(index, 8);
  p.exponent_error = 0.1;
  const double low = std::pow(0.8e-3, -2.5);
  const double high = std::pow(8.0e-3, -2.5);
  for (int k = 0; k < 400; ++k) p.radii.push_back(std::pow(low + (0.5 + 0.5 * wobble(index, k)) * (high - low), -0.4));
  return p;
}

/// Fn = factor (1 + scatter) law, kt likewise; both signs of three angles, prestrain of its own for each packing.
inline PackingRun packing_run(int index, PairKind kind, const std::string& relaxation, double factor,
                              const SoftParticleSpec& spec) {
  PackingRun run;
  run.packing = index;
  run.kind = kind;
  run.relaxation = relaxation;
  const double force = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const double per_degree = spec.youngs_modulus * spec.shell_radius * 3.141592653589793 * spec.shell_radius / 180.0;
  for (int k = 1; k <= 6; ++k) {
    const double overlap = 0.05 * k;
    const double scatter = 1.0 + 0.05 / overlap * wobble(index, k) * (kind == PairKind::soft_soft ? 1.4 : 1.0);
    const double mean = factor * force * law(kind == PairKind::soft_soft ? 0.4 * kA : kA, kB, overlap);
    run.normal.push_back({overlap, mean * std::max(0.05, scatter), 1e-3, 0.1 + overlap, !(index == 3 && k == 2)});
    if (kind == PairKind::soft_soft) continue;
    for (const double angle : {-1.0, -0.5, -0.05, 0.0, 0.05, 0.5, 1.0}) {
      const double slope = factor * per_degree * law(kKtA, kKtB, overlap) * std::max(0.1, scatter);
      const double bent = angle / std::sqrt(1.0 + 4.0 * angle * angle);
      run.tangential.push_back({overlap, angle, slope * (bent + 0.05 * wobble(index, 20 + k)),
                                0.05 * slope * wobble(index, k + 40 + static_cast<int>(20 * angle)), 1e-3, true});
    }
  }
  const bool slow = relaxation == "published";
  run.normal_cost = slow ? Cost{240000, 190000000, 36.0} : Cost{2400, 1900000, 0.4};
  run.tangential_cost = slow ? Cost{1600000, 1300000000, 240.0} : Cost{21000, 17000000, 3.2};
  return run;
}

inline Measurements measurements(int packings = 12) {
  Measurements data;
  for (int i = 0; i < packings; ++i) {
    data.packings.push_back(packing(i));
    data.runs.push_back(packing_run(i, PairKind::soft_solid, "damped", 1.0, data.spec));
    data.runs.push_back(packing_run(i, PairKind::soft_soft, "damped", 1.0, data.spec));
    if (i < 8) data.runs.push_back(packing_run(i, PairKind::soft_solid, "published", 0.96, data.spec));
  }
  return data;
}

inline Estimate estimate(double value, double error) {
  return {value, error, value - 1.96 * error, value + 1.96 * error};
}

inline ThresholdPowerLaw threshold_law(double a, double b) {
  return {estimate(a, 0.06 * a), estimate(b, 0.05), estimate(-a * std::pow(kDelta, b), 2e-5), estimate(kDelta, 0.004)};
}

inline PairLaw pair_law(PairKind kind, double a) {
  PairLaw p;
  p.kind = kind;
  p.status = LawStatus::good;
  p.normal = threshold_law(a, kB);
  p.has_tangential_initial = p.has_tangential_secant = kind == PairKind::soft_solid;
  p.tangential_initial = threshold_law(kKtA, kKtB);
  p.tangential_secant = threshold_law(0.45 * kKtA, kKtB);
  p.covariance.assign(49, 0.0);
  const double deviation[7] = {0.06 * a, 0.05, 0.004, 0.1, 0.05, 0.06, 0.05};
  for (std::size_t i = 0; i < 7; ++i) p.covariance[8 * i] = deviation[i] * deviation[i];
  p.delta_min = 0.05;
  p.delta_max = 0.30;
  p.max_overlap = 0.4;
  p.packings = 12;
  p.points = 72;
  p.chi2_per_dof = 1.1;
  p.quality = 0.34;
  return p;
}

inline LawCard card() {
  LawCard c;
  c.relaxation = "damped";
  c.pairs = {pair_law(PairKind::soft_solid, kA), pair_law(PairKind::soft_soft, 0.4 * kA)};
  return c;
}

/// Stress factor * 2e3 (strain)^1.5 Pa up to 4 % strain, lateral 0.45 of it.
inline MacroCurve macro_curve(const std::string& engine, int sample, double factor, int points = 11) {
  MacroCurve c;
  c.engine = engine;
  c.test = MacroTest::oedometric;
  c.sample = sample;
  c.bodies = 320;
  c.soft = 200;
  c.grains = engine == "shelled" ? 80000 : 0;
  c.soft_volume_share = 0.28;
  c.solid_fraction = 0.63;
  for (int k = 0; k < points; ++k) {
    const double strain = 0.04 * k / (points - 1);
    c.strain.push_back(strain);
    c.stress_axial.push_back(factor * 2e5 * std::pow(strain, 1.5));
    c.stress_lateral.push_back(0.45 * c.stress_axial.back());
  }
  c.stress_axial_contacts = c.stress_axial;
  c.coordination.assign(c.strain.size(), 4.2);
  c.residual.assign(c.strain.size(), 1e-3);
  c.cost = engine == "law" ? Cost{4000, 6000000, 1.5} : Cost{90000, 2400000000, 610.0};
  return c;
}

inline std::vector<MacroCurve> macro() {
  return {macro_curve("law", 0, 0.80), macro_curve("law", 1, 0.86, 21), macro_curve("shelled", 0, 1.0),
          macro_curve("shelled", 1, 1.05)};
}

}  // namespace softgrain::synthetic
