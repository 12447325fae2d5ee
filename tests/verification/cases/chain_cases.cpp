#include "tests/verification/cases/chain_cases.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/verification/cases/bead.h"
#include "tests/verification/cases/outside_run.h"
#include "tests/verification/cases/scene_text.h"

namespace softgrain::verification {

namespace {

constexpr double kGap = 2e-4;
constexpr double kSpeed = 1.0;

std::string chain_text(const std::vector<Ball>& balls, const HertzContact& contact, double step, double end) {
  std::string text = heading("Chain of beads") + text_of(kSteel) + text_of(contact);
  for (const Ball& b : balls) text += text_of(b);
  return text + timing(step, static_cast<std::int64_t>(end / step));
}

std::vector<double> final_speeds(const OutsideRun& run) {
  std::vector<double> out;
  for (std::size_t i = 0; i < static_cast<std::size_t>(run.result.system.particles.grains); ++i)
    out.push_back(run.final_velocity(i)[0]);
  return out;
}

double mass_ratio(const TaperedChain& chain) { return std::pow(chain.ratio, 3); }

}  // namespace

std::string cradle_scene(std::size_t strikers) {
  std::vector<Ball> balls(kCradleBeads);
  for (std::size_t i = 0; i < kCradleBeads; ++i) {
    balls[i].radius = kBeadRadius;
    balls[i].position[0] = static_cast<double>(i) * (2.0 * kBeadRadius + kGap);
    if (i < strikers) balls[i].velocity[0] = kSpeed;
  }
  const double duration = hertz_impact(bead_pair(), kSpeed).duration;
  const double end = static_cast<double>(kCradleBeads + 1) * (kGap / kSpeed + duration);
  return chain_text(balls, {}, duration / 200.0, end);
}

std::vector<double> run_cradle(std::size_t strikers) { return final_speeds(run_text(cradle_scene(strikers))); }

std::vector<double> run_tapered(const TaperedChain& chain) {
  std::vector<Ball> balls(chain.beads);
  double edge = 0.0;
  for (std::size_t i = 0; i < chain.beads; ++i) {
    balls[i].radius = kBeadRadius * std::pow(chain.ratio, static_cast<double>(i));
    balls[i].position[0] = edge + balls[i].radius;
    edge += 2.0 * balls[i].radius + kGap;
  }
  balls[0].velocity[0] = kSpeed;
  // The smallest impact is the shortest: duration goes as the radius.
  const double smallest =
      hertz_impact(bead_pair(), 2.0 * kSpeed).duration * std::pow(chain.ratio, static_cast<double>(chain.beads));
  HertzContact contact;
  contact.restitution = chain.restitution;
  const double end = 2.0 * kGap * static_cast<double>(chain.beads) / kSpeed;
  return final_speeds(run_text(chain_text(balls, contact, smallest / 200.0, end)));
}

std::vector<double> tapered_closed_form(const TaperedChain& chain) {
  const double q = mass_ratio(chain);
  std::vector<double> out(chain.beads);
  double v = kSpeed;
  for (std::size_t i = 0; i + 1 < chain.beads; ++i) {
    out[i] = v * (1.0 - chain.restitution * q) / (1.0 + q);
    v *= (1.0 + chain.restitution) / (1.0 + q);
  }
  out.back() = v;
  return out;
}

namespace {

constexpr double kOverlap = 1e-3 * kBeadRadius;
constexpr double kSpacing = 2.0 * kBeadRadius - kOverlap;

std::string ring_scene(const std::vector<double>& shape, double amplitude, double step, std::int64_t steps) {
  std::string text = heading("Standing wave in a ring of beads") + text_of(kSteel) + text_of(HertzContact{});
  for (std::size_t i = 0; i < shape.size(); ++i) {
    Ball b;
    b.radius = kBeadRadius;
    b.position[0] = kSpacing * (static_cast<double>(i) + 0.5);
    b.velocity[0] = amplitude * shape[i];
    text += text_of(b);
  }
  return text + cell({{kSpacing * kRingBeads, 1.0, 1.0}}, true, false, false) + timing(step, steps, 1);
}

/// From the first to the last passage through zero of the velocity's share in the mode.
double measured_frequency(const OutsideRun& run, const std::vector<double>& shape) {
  std::vector<double> crossings;
  double before = 0.0;
  for (std::size_t k = 0; k < run.frames(); ++k) {
    double now = 0.0;
    for (std::size_t i = 0; i < shape.size(); ++i) now += shape[i] * run.velocity(k, i)[0];
    if (before * now < 0.0)
      crossings.push_back(run.time(k - 1) + (run.time(k) - run.time(k - 1)) * before / (before - now));
    before = now;
  }
  if (crossings.size() < 2) throw std::runtime_error("no oscillation");
  return std::numbers::pi * static_cast<double>(crossings.size() - 1) / (crossings.back() - crossings.front());
}

}  // namespace

SoundMode run_sound(int mode) {
  const double rate = std::sqrt(1.5 * bead_pair().stiffness * std::sqrt(kOverlap) / (2.0 * bead_pair().effective_mass));
  const double half_angle = std::numbers::pi * mode / kRingBeads;
  SoundMode out;
  out.mode = mode;
  out.closed_form = 2.0 * rate * std::sin(half_angle);
  out.long_wave = kSpacing * rate;
  std::vector<double> shape;
  for (int i = 0; i < kRingBeads; ++i) shape.push_back(std::cos(2.0 * half_angle * (i + 0.25)));
  const double step = 2.0 * std::numbers::pi / out.closed_form / 400.0;
  // Displacements of 3e-4 of the overlap: what is not linear moves the frequency by its square.
  const double amplitude = 3e-4 * kOverlap * out.closed_form;
  out.frequency = measured_frequency(run_text(ring_scene(shape, amplitude, step, 1300)), shape);
  out.wave_speed = out.frequency * kSpacing / (2.0 * half_angle);
  return out;
}

}  // namespace softgrain::verification
