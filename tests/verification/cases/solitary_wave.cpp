// The pulse in an uncompressed chain of beads, and what theory says of it; declared in chain_cases.h.
#include <algorithm>
#include <cmath>

#include "tests/verification/cases/bead.h"
#include "tests/verification/cases/chain_cases.h"
#include "tests/verification/cases/outside_run.h"

namespace softgrain::verification {

namespace {

constexpr std::size_t kBeads = 80;
constexpr std::size_t kFirst = 35;  // here the pulse has its shape, and has left what follows it behind
constexpr std::size_t kLast = 65;

/// c0 of the closed forms [m/s].
double chain_speed() {
  const double mass = 2.0 * bead_pair().effective_mass;
  return std::sqrt(bead_pair().stiffness * std::pow(2.0 * kBeadRadius, 2.5) / mass);
}

OutsideRun run_struck(double striker) {
  std::string text = heading("Solitary wave in a chain of beads") + text_of(kSteel) + text_of(HertzContact{});
  for (std::size_t i = 0; i < kBeads; ++i) {
    Ball b;
    b.radius = kBeadRadius;
    b.position[0] = 2.0 * kBeadRadius * static_cast<double>(i);
    if (i == 0) b.velocity[0] = striker;
    text += text_of(b);
  }
  const double step = hertz_impact(bead_pair(), striker).duration / 400.0;
  // The pulse goes at about the speed of the long-wave theory for an amplitude of 0.7 of the striker's speed.
  const double end = 2.0 * kBeadRadius * static_cast<double>(kLast + 8) / long_wave_speed(0.68 * striker);
  return run_text(text + timing(step, static_cast<std::int64_t>(end / step), 4));
}

struct Peak {
  double time = 0.0;
  double value = 0.0;
};

/// Vertex of the parabola through the largest recorded speed and its neighbours.
Peak peak_of(const OutsideRun& run, std::size_t bead) {
  std::size_t top = 1;
  for (std::size_t k = 1; k + 1 < run.frames(); ++k)
    if (run.velocity(k, bead)[0] > run.velocity(top, bead)[0]) top = k;
  const double before = run.velocity(top - 1, bead)[0];
  const double here = run.velocity(top, bead)[0];
  const double after = run.velocity(top + 1, bead)[0];
  const double bend = before - 2.0 * here + after;
  const double slope = 0.5 * (after - before);
  return {run.time(top) - (run.time(top + 1) - run.time(top)) * slope / bend, here - 0.5 * slope * slope / bend};
}

SolitaryWave wave_of(const OutsideRun& run, double striker) {
  const Peak first = peak_of(run, kFirst);
  const Peak last = peak_of(run, kLast);
  return {striker, 0.5 * (first.value + last.value),
          2.0 * kBeadRadius * static_cast<double>(kLast - kFirst) / (last.time - first.time)};
}

constexpr int kPerBead = 400;  // grid points
constexpr int kHalfRange = 5;  // beads; beyond, the wave is below 1e-30

double tent_average(const std::vector<double>& f, std::size_t at) {
  const auto n = static_cast<std::ptrdiff_t>(f.size());
  double sum = 0.0;
  for (std::ptrdiff_t d = -kPerBead + 1; d < kPerBead; ++d) {
    const std::ptrdiff_t k = static_cast<std::ptrdiff_t>(at) + d;
    if (k < 0 || k >= n) continue;
    sum += f[static_cast<std::size_t>(k)] * (1.0 - std::abs(static_cast<double>(d)) / kPerBead);
  }
  return sum / kPerBead;
}

std::vector<double> to_three_halves(const std::vector<double>& r) {
  std::vector<double> out;
  for (const double x : r) out.push_back(x * std::sqrt(x));
  return out;
}

/// Integral of values on the grid over one bead around `x` (trapezoids).
double over_one_bead(const std::vector<double>& f, std::size_t at) {
  double sum = 0.0;
  for (int d = -kPerBead / 2; d <= kPerBead / 2; ++d) {
    const double weight = std::abs(d) == kPerBead / 2 ? 0.5 : 1.0;
    sum += weight * f[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + d)];
  }
  return sum / kPerBead;
}

DiscreteWave solve_discrete_wave() {
  DiscreteWave out;
  for (int k = -kHalfRange * kPerBead; k <= kHalfRange * kPerBead; ++k) {
    out.x.push_back(static_cast<double>(k) / kPerBead);
    out.r.push_back(std::exp(-out.x.back() * out.x.back()));
  }
  const std::size_t middle = out.r.size() / 2;
  double change = 1.0;
  while (change > 1e-13) {
    const std::vector<double> force = to_three_halves(out.r);
    out.g = tent_average(force, middle);
    change = 0.0;
    for (std::size_t k = 0; k < out.r.size(); ++k) {
      const double next = tent_average(force, k) / out.g;
      change = std::max(change, std::abs(next - out.r[k]));
      out.r[k] = next;
    }
  }
  out.j = over_one_bead(to_three_halves(out.r), middle);
  return out;
}

}  // namespace

const DiscreteWave& discrete_wave() {
  static const DiscreteWave wave = solve_discrete_wave();
  return wave;
}

SolitaryWave run_solitary(double striker) { return wave_of(run_struck(striker), striker); }

double long_wave_speed(double amplitude) { return std::pow(16.0 / 25.0 * std::pow(chain_speed(), 4) * amplitude, 0.2); }

double discrete_wave_speed(double amplitude) {
  const DiscreteWave& w = discrete_wave();
  return std::pow(w.g * w.g * w.g / w.j * std::pow(chain_speed(), 4) * amplitude, 0.2);
}

PulseShape pulse_shape() {
  const OutsideRun run = run_struck(1.0);
  const SolitaryWave wave = wave_of(run, 1.0);
  const Peak peak = peak_of(run, 50);
  const std::vector<double> force = to_three_halves(discrete_wave().r);
  PulseShape out;
  for (std::size_t k = 0; k < run.frames(); ++k) {
    const double x = (run.time(k) - peak.time) * wave.speed / (2.0 * kBeadRadius);
    if (std::abs(x) > 4.0) continue;
    out.x.push_back(x);
    out.here.push_back(run.velocity(k, 50)[0] / peak.value);
    // v = (1/(m c)) times the integral of the force over one bead; symmetric in x.
    const double place = (x + kHalfRange) * kPerBead;
    const auto at = static_cast<std::size_t>(place);
    const double below = over_one_bead(force, at);
    const double above = over_one_bead(force, at + 1);
    out.discrete.push_back((below + (place - std::floor(place)) * (above - below)) / discrete_wave().j);
  }
  return out;
}

}  // namespace softgrain::verification
