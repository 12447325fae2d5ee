// Measurements made from a known law, for tests of the fits.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "common/core/random.h"
#include "common/data/measurements.h"

namespace softgrain::test {

/// Standard normal number (Box-Muller).
inline double normal_number(RandomStream& stream) {
  const double radius = std::sqrt(-2.0 * std::log(stream.uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * stream.uniform());
}

struct KnownLaw {
  double a = 0.5755;  ///< 73.669 N / (E Rs^2), E Rs^2 = 128 N
  double b = 2.799;
  double delta = 0.065;

  [[nodiscard]] double value(double d) const { return d <= delta ? 0.0 : a * (std::pow(d, b) - std::pow(delta, b)); }
};

/// How synthetic packings differ: each has its own factor on a, and noise per point proportional to the force.
struct SyntheticOptions {
  KnownLaw normal;
  double a_initial = 3.0;  ///< initial slope of kt/(E Rs); 0: no tangential points
  double b_initial = 1.2;
  double secant_share = 0.5;  ///< secant at 1 degree over initial slope
  std::vector<double> deltas{0.025, 0.05, 0.075, 0.10, 0.125, 0.15, 0.175, 0.20, 0.225, 0.25};
  int packings = 8;
  double factor_scatter = 0.0;
  double point_scatter = 0.0;
  PairKind kind = PairKind::soft_solid;
  std::uint64_t seed = 1;
};

/// Parallel force after a rotation: F0 + kt0 ht inside 0.05 degree, through the secant at 1 degree.
inline void add_tangential(PackingRun& run, const SoftParticleSpec& spec, double delta, double kt0, double share,
                           double prestrain) {
  for (const double angle : {-1.0, -0.05, -0.025, 0.0, 0.025, 0.05, 1.0}) {
    const double ht = std::numbers::pi * spec.shell_radius * angle / 180.0;
    const double slope = std::abs(angle) > 0.5 ? share * kt0 : kt0;
    run.tangential.push_back({delta, angle, prestrain + slope * ht, 0.0, 1e-6, true});
  }
}

inline Measurements synthetic(const SyntheticOptions& o) {
  Measurements data;
  const double force_unit = data.spec.youngs_modulus * data.spec.shell_radius * data.spec.shell_radius;
  const double stiffness_unit = data.spec.youngs_modulus * data.spec.shell_radius;
  const KnownLaw tangential{o.a_initial, o.b_initial, o.normal.delta};
  for (int i = 0; i < o.packings; ++i) {
    RandomStream stream(o.seed, RandomPurpose::test, static_cast<std::uint64_t>(i));
    PackingInfo info;
    info.seed = static_cast<std::uint64_t>(i);
    info.radii = {stream.uniform()};
    data.packings.push_back(info);
    PackingRun run;
    run.packing = i;
    run.kind = o.kind;
    run.relaxation = "damped";
    const double factor = 1.0 + o.factor_scatter * normal_number(stream);
    for (const double d : o.deltas) {
      const double force = o.normal.value(d) * factor * (1.0 + o.point_scatter * normal_number(stream));
      run.normal.push_back({d, force * force_unit, 1e-6, d, true});
      const double kt = tangential.value(d) * factor * (1.0 + o.point_scatter * normal_number(stream));
      if (o.a_initial > 0.0)
        add_tangential(run, data.spec, d, kt * stiffness_unit, o.secant_share, 0.1 * force * force_unit);
    }
    data.runs.push_back(run);
  }
  return data;
}

}  // namespace softgrain::test
