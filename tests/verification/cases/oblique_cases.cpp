#include "tests/verification/cases/oblique_cases.h"

#include <cmath>
#include <numbers>

#include "tests/verification/cases/closed_forms.h"
#include "tests/verification/cases/outside_run.h"
#include "tests/verification/cases/scene_text.h"

namespace softgrain::verification {

namespace {

constexpr ObliqueNumbers kPublished{};
constexpr double kRadian = std::numbers::pi / 180.0;
const SceneMaterial kOxide{"grain", 4000.0, 3.8e11, 0.23};
constexpr double kGap = 1e-6;

Vec3 velocity_at(double incidence) {
  return {{kPublished.speed * std::sin(incidence * kRadian), 0.0, -kPublished.speed * std::cos(incidence * kRadian)}};
}

/// Duration of the elastic impact at normal incidence, times (cos)^(-1/5) [s].
double duration_at(double incidence) {
  const HertzPair pair{
      hertz_stiffness(effective_modulus(kOxide.youngs_modulus, kOxide.poisson_ratio), kPublished.radius),
      sphere_mass(kPublished.radius, kOxide.density)};
  return hertz_impact(pair, kPublished.speed * std::cos(incidence * kRadian)).duration;
}

std::string contact_of(TangentialOption option) {
  if (option != TangentialOption::linear)
    return text_of(HertzContact{kPublished.restitution, kPublished.mu, name_of(option), "grain"});
  const double rate = std::numbers::pi / duration_at(0.0);
  const double normal = sphere_mass(kPublished.radius, kOxide.density) * rate * rate;
  const double ratio = 2.0 * (1.0 - kOxide.poisson_ratio) / (2.0 - kOxide.poisson_ratio);
  return text_of(LinearContact{kPublished.restitution, kPublished.mu, normal, ratio * normal, "grain"});
}

ObliqueOutcome outcome(double incidence, const Vec3& velocity, double surface_speed) {
  const double vt = kPublished.speed * std::sin(incidence * kRadian);
  ObliqueOutcome out;
  out.incidence = incidence;
  out.tangential_restitution = velocity[0] / vt;
  out.rebound_angle = std::atan((velocity[0] - surface_speed) / velocity[2]) / kRadian;
  out.spin = surface_speed / kPublished.speed;
  out.energy_ratio = (norm2(velocity) + 0.4 * surface_speed * surface_speed) / (kPublished.speed * kPublished.speed);
  return out;
}

}  // namespace

std::string name_of(TangentialOption option) {
  if (option == TangentialOption::mindlin) return "mindlin";
  return option == TangentialOption::rescaled ? "rescaled" : "linear spring";
}

std::string oblique_scene(double incidence, TangentialOption option) {
  const double duration = duration_at(incidence);
  const double flight = kGap / (kPublished.speed * std::cos(incidence * kRadian));
  Ball ball;
  ball.radius = kPublished.radius;
  ball.position[2] = kPublished.radius + kGap;
  ball.velocity = velocity_at(incidence);
  const SceneMaterial oxide = option == TangentialOption::linear ? inelastic(kOxide) : kOxide;
  return heading("Oblique impact of an aluminium oxide sphere") + text_of(oxide) + contact_of(option) + text_of(ball) +
         plane({}, {{0.0, 0.0, 1.0}}, "grain") +
         timing(duration / 400.0, static_cast<std::int64_t>(400.0 * (1.5 + flight / duration)));
}

ObliqueOutcome run_oblique(double incidence, TangentialOption option) {
  const OutsideRun run = run_text(oblique_scene(incidence, option));
  (void)only_contact(run);
  return outcome(incidence, run.final_velocity(0), run.final_spin(0)[1] * kPublished.radius);
}

ObliqueOutcome sliding_all_the_time(double incidence) {
  const Vec3 before = velocity_at(incidence);
  const double impulse = kPublished.mu * (1.0 + kPublished.restitution) * -before[2];
  return outcome(incidence, {{before[0] - impulse, 0.0, -kPublished.restitution * before[2]}}, 2.5 * impulse);
}

double least_sliding_incidence() { return std::atan(3.5 * kPublished.mu * (1.0 + kPublished.restitution)) / kRadian; }

std::vector<std::vector<double>> digitised_restitution() {
  return reference_table("chung_ooi/chung_ooi_test4_tangential_restitution.dat");
}

std::vector<std::vector<double>> digitised_rebound_angle() {
  return reference_table("chung_ooi/chung_ooi_test4_rebound_angle.dat");
}

ObliqueErrors oblique_errors(TangentialOption option, double least) {
  const auto error = [&](const std::vector<std::vector<double>>& data, double ObliqueOutcome::*value) {
    double distance = 0.0;
    double size = 0.0;
    for (const auto& row : data) {
      if (row[0] < least) continue;
      distance += std::abs(run_oblique(row[0], option).*value - row[1]);
      size += std::abs(row[1]);
    }
    return distance / size;
  };
  return {error(digitised_restitution(), &ObliqueOutcome::tangential_restitution),
          error(digitised_rebound_angle(), &ObliqueOutcome::rebound_angle)};
}

}  // namespace softgrain::verification
