#include "pipelines/report/reference_curves.h"

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

}  // namespace softgrain::report
