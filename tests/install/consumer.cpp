// Prints the force between a soft particle and a plane by the published card (results/published/law.toml) at
// Delta = 0.2, and that of two glass beads.
#include <softgrain/laws.h>

#include <cstdio>

int main() {
  softgrain::SoftContact soft;
  soft.delta = 0.09424152728466292;
  soft.normal = softgrain::threshold_term(0.8294107615342468, 3.1213208150310874, soft.delta);
  soft.modulus = 0.5e6;
  const double radius = 0.016;
  softgrain::ContactState<3> contact;
  contact.normal = {{0.0, 0.0, 1.0}};
  contact.overlap = 0.2 * radius;
  contact.constants = soft.pair_constants({.radius_i = radius, .radius_j = 0.0});
  std::printf("%.17g\n", soft.evaluate(contact).normal_force);

  const softgrain::Material glass{.name = "glass", .density = 2500.0, .youngs_modulus = 70e9, .poisson_ratio = 0.2};
  using Beads = softgrain::HertzMindlin<softgrain::Tangential::none, false>;
  const Beads beads{softgrain::HertzCoefficients::of(glass, glass, 0.0, 1.0)};
  contact.overlap = 1e-6;
  contact.constants = beads.pair_constants({.radius_i = 1e-3, .radius_j = 1e-3});
  std::printf("%.17g\n", beads.evaluate(contact).normal_force);
}
