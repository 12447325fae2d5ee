#include "tests/verification/cases/rolling_cases.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/verification/cases/closed_forms.h"
#include "tests/verification/cases/outside_run.h"
#include "tests/verification/cases/scene_text.h"

namespace softgrain::verification {

namespace {

constexpr double kGravity = 9.81;
constexpr double kPushedSpeed = 0.1;
constexpr double kRadian = std::numbers::pi / 180.0;
const SceneMaterial kBall{"grain", 1e4, 1e9, 0.3};
const double kMass = sphere_mass(kBallRadius, kBall.density);

/// The contact of sliding_ball.toml.
LinearContact rough_contact(double mu) { return {0.9, mu, 1e4, 2857.0, "rigid"}; }

/// A ball that rests on its normal spring.
Ball resting_ball(double load) {
  Ball ball;
  ball.radius = kBallRadius;
  ball.position[2] = kBallRadius - load / rough_contact(0.0).normal;
  return ball;
}

/// `slip` of a frame has the sign of `first` until the contact point stops.
EndOfSliding end_of_sliding(const OutsideRun& run, double mu, double scale) {
  const auto slip = [&](std::size_t k) { return run.velocity(k, 0)[0] - kBallRadius * run.spin(k, 0)[1]; };
  const double sign = slip(0) > 0.0 ? 1.0 : -1.0;
  for (std::size_t k = 1; k < run.frames(); ++k) {
    if (sign * slip(k) > 0.0) continue;
    const double share = slip(k - 1) / (slip(k - 1) - slip(k));
    const auto between = [&](double a, double b) { return a + share * (b - a); };
    return {mu, between(run.time(k - 1), run.time(k)) * mu * kGravity / scale,
            between(run.velocity(k - 1, 0)[0], run.velocity(k, 0)[0]) / scale,
            between(run.spin(k - 1, 0)[1], run.spin(k, 0)[1]) * kBallRadius / scale};
  }
  throw std::runtime_error("the ball still slides at the end of the run");
}

std::string hertz_ball_scene(double mu) {
  const double modulus = kBall.youngs_modulus / (1.0 - kBall.poisson_ratio * kBall.poisson_ratio);
  Ball ball = resting_ball(0.0);
  ball.position[2] -= std::pow(kMass * kGravity / hertz_stiffness(modulus, kBallRadius), 2.0 / 3.0);
  ball.velocity[0] = kPushedSpeed;
  const double end = 1.2 * 2.0 / 7.0 * kPushedSpeed / (mu * kGravity);
  return heading("Ball slipping on a rough surface", {{0.0, 0.0, -kGravity}}) + text_of(kBall) +
         text_of(HertzContact{0.9, mu, "mindlin", "rigid"}) + text_of(ball) + plane({}, {{0.0, 0.0, 1.0}}) +
         "\n[time]\nstep = \"auto\"\nend = " + digits(end) + "\n[output]\nevery = 1e-5\n";
}

}  // namespace

std::vector<PublishedSliding> published_sliding() {
  const auto times = reference_table("mfix_dem/DEM04_POST_TIME.dat");
  const auto speeds = reference_table("mfix_dem/DEM04_POST_TVEL.dat");
  const auto spins = reference_table("mfix_dem/DEM04_POST_AVEL.dat");
  std::vector<PublishedSliding> out;
  for (std::size_t k = 0; k < times.size(); ++k)
    out.push_back(
        {{times[k][0], times[k][1], speeds[k][1], spins[k][1]}, {times[k][0], times[k][2], speeds[k][2], spins[k][2]}});
  return out;
}

EndOfSliding run_pushed_ball(double mu, RollingLaw law) {
  if (law == RollingLaw::hertz) return end_of_sliding(run_text(hertz_ball_scene(mu)), mu, kPushedSpeed);
  return end_of_sliding(run_file("sliding_ball", {"contact.0.mu=" + digits(mu)}), mu, kPushedSpeed);
}

std::string spun_ball_scene(double mu) {
  Ball ball = resting_ball(kMass * kGravity);
  ball.spin[1] = kSpunSpeed / kBallRadius;
  return heading("Spinning ball set down on a rough surface", {{0.0, 0.0, -kGravity}}) + text_of(inelastic(kBall)) +
         text_of(rough_contact(mu)) + text_of(ball) + plane({}, {{0.0, 0.0, 1.0}}) +
         "\n[time]\nstep = \"auto\"\nend = 18e-3\n[output]\nevery = 1e-5\n";
}

EndOfSliding run_spun_ball(double mu) { return end_of_sliding(run_text(spun_ball_scene(mu)), mu, kSpunSpeed); }

InclineOutcome run_incline(double angle) {
  const double down = kGravity * std::sin(angle * kRadian);
  const double press = kGravity * std::cos(angle * kRadian);
  const OutsideRun run =
      run_text(heading("Ball on an incline", {{down, 0.0, -press}}) + text_of(inelastic(kBall)) +
               text_of(rough_contact(kInclineFriction)) + text_of(resting_ball(kMass * press)) +
               plane({}, {{0.0, 0.0, 1.0}}) + "\n[time]\nstep = \"auto\"\nend = 0.02\n[output]\nevery = 1e-2\n");
  const std::size_t last = run.frames() - 1;
  const double scale = 1.0 / (kGravity * (run.time(last) - run.time(1)));
  return {angle, (run.velocity(last, 0)[0] - run.velocity(1, 0)[0]) * scale,
          (run.spin(last, 0)[1] - run.spin(1, 0)[1]) * kBallRadius * scale};
}

InclineOutcome incline_closed_form(double angle) {
  const double sine = std::sin(angle * kRadian);
  const double press = kInclineFriction * std::cos(angle * kRadian);
  if (press >= 2.0 / 7.0 * sine) return {angle, 5.0 / 7.0 * sine, 5.0 / 7.0 * sine};
  return {angle, sine - press, 2.5 * press};
}

double steepest_rolling_angle() { return std::atan(3.5 * kInclineFriction) / kRadian; }

}  // namespace softgrain::verification
