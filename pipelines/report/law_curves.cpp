// Curves of laws as figures draw them: laws to set measured forces against, and the 95 % band of a fitted law.
#include "pipelines/report/law_curves.h"

#include <algorithm>
#include <cmath>

namespace softgrain::report {

namespace {

double force_scale(double youngs_modulus, double shell_radius) { return youngs_modulus * shell_radius * shell_radius; }

}  // namespace

double published_normal_force(double overlap_ratio, const SoftParticleSpec& spec) {
  namespace law = published_soft_solid;
  if (overlap_ratio < law::delta) return 0.0;
  const double scale =
      force_scale(spec.youngs_modulus, spec.shell_radius) / force_scale(law::youngs_modulus, law::shell_radius);
  const double force = law::a * std::pow(overlap_ratio, law::b) + law::c;
  return force > 0.0 ? scale * force : 0.0;
}

double hertz_force(double overlap_ratio, const SoftParticleSpec& spec, PairKind kind) {
  if (overlap_ratio <= 0.0) return 0.0;
  const double radius = kind == PairKind::soft_solid ? spec.shell_radius : 0.5 * spec.shell_radius;
  const double compliance = 0.75 * 2.0 * (1.0 - spec.poisson_ratio * spec.poisson_ratio) / spec.youngs_modulus;
  return std::sqrt(radius) * std::pow(overlap_ratio * spec.shell_radius, 1.5) / compliance;
}

std::vector<double> spread(double low, double high, int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(low + (high - low) * i / std::max(1, n - 1));
  return values;
}

std::optional<LawBand> law_band(const PairLaw& law, LawPart part) {
  if (!has_part(law, part)) return std::nullopt;
  if (auto stored = stored_band(law, part)) return stored;
  return linearised_band(law, part, spread(0.0, law.delta_max, 121));
}

}  // namespace softgrain::report
