#include "tests/verification/cases/energy_cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/verification/cases/closed_forms.h"
#include "tests/verification/cases/outside_run.h"
#include "tests/verification/cases/scene_text.h"

namespace softgrain::verification {

namespace {

constexpr double kGravity = 9.81;
constexpr double kRadius = 0.01;
const SceneMaterial kBouncing{"grain", 2500.0, 1e9, 0.25};

double plane_stiffness(const SceneMaterial& m) {
  return hertz_stiffness(m.youngs_modulus / (1.0 - m.poisson_ratio * m.poisson_ratio), kRadius);
}

double bounce_speed() { return std::sqrt(2.0 * kGravity * kDropHeight); }

double bounce_duration() {
  return hertz_impact({plane_stiffness(kBouncing), sphere_mass(kRadius, kBouncing.density)}, bounce_speed()).duration;
}

/// Fall, then flights of 2 e^n v/g.
double time_of_bounces(std::size_t count) {
  double fall = bounce_speed() / kGravity;
  double end = fall;
  for (std::size_t n = 0; n < count; ++n) end += 2.0 * (fall *= kBounceRestitution);
  return end;
}

}  // namespace

std::string bounce_scene(std::size_t count) {
  Ball ball;
  ball.radius = kRadius;
  ball.position[2] = kRadius + kDropHeight;
  HertzContact contact;
  contact.restitution = kBounceRestitution;
  contact.partner = "rigid";
  const double step = bounce_duration() / 200.0;
  const double end = time_of_bounces(count) + 0.5 * 2.0 * bounce_speed() / kGravity *
                                                  std::pow(kBounceRestitution, static_cast<double>(count) + 1.0);
  return heading("Bouncing ball", {{0.0, 0.0, -kGravity}}) + text_of(kBouncing) + text_of(contact) + text_of(ball) +
         plane({}, {{0.0, 0.0, 1.0}}) + timing(step, static_cast<std::int64_t>(end / step), 20);
}

std::vector<Bounce> run_bounces(std::size_t count) {
  const OutsideRun run = run_text(bounce_scene(count));
  const auto gap = [&](std::size_t k) { return run.position(k, 0)[2] - kRadius; };
  const auto crossing = [&](std::size_t k) {
    return run.time(k - 1) + (run.time(k) - run.time(k - 1)) * gap(k - 1) / (gap(k - 1) - gap(k));
  };
  const double whole = 2.0 * bounce_speed() / kGravity;
  std::vector<Bounce> out;
  double left = -1.0;
  double height = 0.0;
  for (std::size_t k = 1; k < run.frames(); ++k) {
    if (gap(k - 1) <= 0.0 && gap(k) > 0.0) {
      left = crossing(k);
      const double v = run.velocity(k, 0)[2];
      height = gap(k) + 0.5 * v * v / kGravity;  // the apex of this flight
    }
    if (left >= 0.0 && gap(k - 1) > 0.0 && gap(k) <= 0.0)
      out.push_back({height / kDropHeight, (crossing(k) - left) / whole});
  }
  if (out.size() < count) throw std::runtime_error("fewer bounces than expected");
  out.resize(count);
  return out;
}

namespace {

/// Overlap and its rate.
struct ContactMotion {
  double h = 0.0;
  double rate = 0.0;
};

/// m h'' = m g - K h^(3/2) - alpha sqrt(m K) h^(1/4) h', alpha = -sqrt(5) ln e/sqrt(ln^2 e + pi^2).
ContactMotion derivative(const ContactMotion& s) {
  const double mass = sphere_mass(kRadius, kBouncing.density);
  const double stiffness = plane_stiffness(kBouncing);
  const double l = std::log(kBounceRestitution);
  const double alpha = -std::sqrt(5.0) * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
  const double h = std::max(s.h, 0.0);
  const double damping = alpha * std::sqrt(mass * stiffness) * std::pow(h, 0.25);
  return {s.rate, kGravity - (stiffness * std::pow(h, 1.5) + damping * s.rate) / mass};
}

/// Speed with which a ball that arrives with `speed` leaves.
double rebound_speed(double speed) {
  const auto moved = [](const ContactMotion& s, const ContactMotion& d, double dt) {
    return ContactMotion{s.h + dt * d.h, s.rate + dt * d.rate};
  };
  const double dt = bounce_duration() / 20000.0;
  ContactMotion s{0.0, speed};
  do {
    const ContactMotion a = derivative(s);
    const ContactMotion b = derivative(moved(s, a, 0.5 * dt));
    const ContactMotion c = derivative(moved(s, b, 0.5 * dt));
    const ContactMotion d = derivative(moved(s, c, dt));
    s.h += dt / 6.0 * (a.h + 2.0 * b.h + 2.0 * c.h + d.h);
    s.rate += dt / 6.0 * (a.rate + 2.0 * b.rate + 2.0 * c.rate + d.rate);
  } while (s.h > 0.0);
  return -s.rate;
}

}  // namespace

std::vector<Bounce> bounces_with_weight(std::size_t count) {
  std::vector<Bounce> out;
  double speed = bounce_speed();
  for (std::size_t n = 0; n < count; ++n) {
    speed = rebound_speed(speed);
    const double ratio = speed / bounce_speed();
    out.push_back({ratio * ratio, ratio});
  }
  return out;
}

namespace {

constexpr double kSpeed = 1.0;
const SceneMaterial kElastic{};

double pair_stiffness() {
  return hertz_stiffness(effective_modulus(kElastic.youngs_modulus, kElastic.poisson_ratio), 0.5 * kRadius);
}

ImpactNumbers pair_impact() {
  return hertz_impact({pair_stiffness(), 0.5 * sphere_mass(kRadius, kElastic.density)}, kSpeed);
}

/// Gap at each of the three contacts at the start; negative: overlap.
double first_gap(PairMotion motion) {
  return motion == PairMotion::pressed ? -3.0 * pair_impact().overlap : 0.7 * pair_impact().overlap;
}

std::string pair_scene(PairMotion motion, int steps_per_impact, int impacts) {
  const double gap = first_gap(motion);
  Ball left;
  left.radius = kRadius;
  left.position[0] = kRadius + gap;
  left.velocity[0] = motion == PairMotion::pressed ? 0.4 * kSpeed : 0.5 * kSpeed;
  Ball right = left;
  right.position[0] = 3.0 * kRadius + 2.0 * gap;
  right.velocity[0] = -0.3 * kSpeed;
  HertzContact wall;
  wall.partner = "rigid";
  const std::int64_t steps = std::int64_t{steps_per_impact} * impacts;
  return heading("Two elastic balls between planes") + text_of(kElastic) + text_of(HertzContact{}) + text_of(wall) +
         text_of(left) + text_of(right) + plane({}, {{1.0, 0.0, 0.0}}) +
         plane({{4.0 * kRadius + 3.0 * gap, 0.0, 0.0}}, {{-1.0, 0.0, 0.0}}) +
         timing(pair_impact().duration / steps_per_impact, steps, std::max<std::int64_t>(1, steps / 40000));
}

/// (2/5) K h^(5/2) of a contact with this gap.
double hertz_energy(double stiffness, double gap) { return gap < 0.0 ? 0.4 * stiffness * std::pow(-gap, 2.5) : 0.0; }

double energy(const OutsideRun& run, std::size_t k, double last_plane) {
  const double wall = plane_stiffness(kElastic);
  const double left = run.position(k, 0)[0];
  const double right = run.position(k, 1)[0];
  return run.result.trajectory.translational_energy[k] + hertz_energy(wall, left - kRadius) +
         hertz_energy(pair_stiffness(), right - left - 2.0 * kRadius) +
         hertz_energy(wall, last_plane - right - kRadius);
}

void summarise(EnergyCourse& course) {
  const auto n = static_cast<double>(course.time.size());
  const double middle = 0.5 * (course.time.front() + course.time.back());
  double slope = 0.0;
  double spread = 0.0;
  for (std::size_t k = 0; k < course.time.size(); ++k) {
    course.rms += course.error[k] * course.error[k] / n;
    course.largest = std::max(course.largest, std::abs(course.error[k]));
    slope += course.error[k] * (course.time[k] - middle);
    spread += (course.time[k] - middle) * (course.time[k] - middle);
  }
  course.rms = std::sqrt(course.rms);
  course.drift = slope / spread * (course.time.back() - course.time.front());
}

}  // namespace

EnergyCourse run_pair(PairMotion motion, int steps_per_impact, int impacts) {
  const OutsideRun run = run_text(pair_scene(motion, steps_per_impact, impacts));
  const double last_plane = 4.0 * kRadius + 3.0 * first_gap(motion);
  const double start = energy(run, 0, last_plane);
  EnergyCourse out;
  for (std::size_t k = 0; k < run.frames(); ++k) {
    out.time.push_back(run.time(k) / pair_impact().duration);
    out.error.push_back(energy(run, k, last_plane) / start - 1.0);
  }
  summarise(out);
  return out;
}

}  // namespace softgrain::verification
