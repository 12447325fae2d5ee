#include "tests/verification/cases/restitution_cases.h"

#include <cmath>
#include <numbers>

#include "tests/verification/cases/closed_forms.h"
#include "tests/verification/cases/outside_run.h"
#include "tests/verification/cases/scene_text.h"

namespace softgrain::verification {

namespace {

constexpr double kRadius = 0.01;
constexpr double kSpring = 1e6;  // of the linear law [N/m]
const SceneMaterial kGlass{};

HertzPair pair_of(const RestitutionCase& c) {
  const double mass = sphere_mass(kRadius, kGlass.density);
  const double modulus = effective_modulus(kGlass.youngs_modulus, kGlass.poisson_ratio);
  if (c.ratio == 0.0) return {hertz_stiffness(modulus, kRadius), mass};
  const double other = mass * c.ratio * c.ratio * c.ratio;
  return {hertz_stiffness(modulus, kRadius * c.ratio / (1.0 + c.ratio)), mass * other / (mass + other)};
}

double duration_of(const RestitutionCase& c) {
  const HertzPair pair = pair_of(c);
  if (c.law == NormalLaw::linear) return std::numbers::pi * std::sqrt(pair.effective_mass / kSpring);
  return hertz_impact(pair, c.speed).duration;
}

std::string contact_of(const RestitutionCase& c) {
  if (c.law == NormalLaw::linear) return text_of(LinearContact{c.restitution, 0.0, kSpring, 0.0, "grain"});
  return text_of(HertzContact{c.restitution, 0.0, "mindlin", "grain"});
}

}  // namespace

std::string restitution_scene(const RestitutionCase& c) {
  const double step = duration_of(c) / c.steps_per_impact;
  Ball ball;
  ball.radius = kRadius;
  ball.position[0] = -kRadius - (3.0 + c.phase) * step * c.speed;
  ball.velocity[0] = c.speed;
  Ball target;
  target.radius = kRadius * c.ratio;
  target.position[0] = target.radius;
  const std::string other = c.ratio > 0.0 ? text_of(target) : plane({}, {{-1.0, 0.0, 0.0}}, "grain");
  // Strong damping holds the bodies together for up to five times the elastic duration.
  const SceneMaterial glass = c.law == NormalLaw::linear ? inelastic(kGlass) : kGlass;
  return heading("Normal impact with restitution") + text_of(glass) + contact_of(c) + text_of(ball) + other +
         timing(step, static_cast<std::int64_t>(6.0 * c.steps_per_impact));
}

double recovered_restitution(const RestitutionCase& c) {
  const OutsideRun run = run_text(restitution_scene(c));
  (void)only_contact(run);
  const double other = c.ratio > 0.0 ? run.final_velocity(1)[0] : 0.0;
  return (other - run.final_velocity(0)[0]) / c.speed;
}

}  // namespace softgrain::verification
