#include "macrosim/preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/io/interrupt.h"
#include "macrosim/hard_bodies.h"
#include "macrosim/placed_spheres.h"

namespace softgrain {

namespace {

/// Largest first at random places of a cube; false when one finds none.
bool place(std::vector<MacroBody>& bodies, double edge, Boundary boundary, RandomStream& random) {
  constexpr int kTrials = 100000;
  std::vector<double> radii;
  for (const MacroBody& b : bodies) radii.push_back(b.r);
  PlacedSpheres placed(edge, radii, boundary == Boundary::periodic);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    stop_if_interrupted("placing bodies");
    const double r = bodies[k].r;
    int trial = 0;
    do {
      bodies[k].x = placed.place_of(r, random);
    } while (placed.collides(bodies[k].x, r) && ++trial < kTrials);
    if (trial == kTrials) return false;
    placed.add(bodies[k].x, r);
  }
  return true;
}

}  // namespace

double power_law_radius(double exponent, double rmax, double polydispersity, double u) {
  const double power = 1.0 - exponent;
  const double low = std::pow(rmax / polydispersity, power);
  const double high = std::pow(rmax, power);
  return std::pow(low + u * (high - low), 1.0 / power);
}

void require_room_for_images(const std::vector<MacroBody>& bodies) {
  double volume = 0.0;
  double largest = 0.0;
  for (const MacroBody& b : bodies) {
    volume += kSphereVolume * cube(b.r);
    largest = std::max(largest, b.r);
  }
  const double edge = std::cbrt(volume / kPackedShare);
  if (edge >= kShortestPeriod * largest) return;
  const double enough = static_cast<double>(bodies.size()) * cube(kShortestPeriod * largest / edge);
  throw InputError(fmt::format(
      "{} bodies are too few for a periodic cell: packed, its edge is about {:.3g} m, and images of the largest "
      "(radius {:.3g} m) must be two diameters apart: about {:.2g} have room",
      bodies.size(), edge, largest, 1.1 * enough));
}

MacroPacking place_loosely(std::vector<MacroBody> bodies, std::uint64_t seed, std::uint64_t sample, double fraction,
                           Boundary boundary) {
  double volume = 0.0;
  for (const MacroBody& b : bodies) volume += kSphereVolume * cube(b.r);
  if (boundary == Boundary::periodic) require_room_for_images(bodies);
  RandomStream random(seed, kMacroPositions, sample);
  for (; fraction > 0.05; fraction *= 0.8) {
    const double edge = std::cbrt(volume / fraction);
    if (place(bodies, edge, boundary, random)) return {{}, {{edge, edge, edge}}, std::move(bodies)};
  }
  throw UnusableResult("macro: could not place all bodies without overlap");
}

PreparationProtocol protocol_of(Preparation preparation, double friction) {
  PreparationProtocol p;
  if (preparation == Preparation::dense) p.coarse_share = 0.75;
  if (preparation != Preparation::fast && preparation != Preparation::slow) return p;
  p.inertial_number = preparation == Preparation::fast ? 0.1 : 1e-3;
  p.friction = friction;
  p.first_pressure = 1.0;
  return p;
}

AnyLaw hard_law(const MacroSpec& spec) { return HardBodies::law(spec, 0.0, 1.0); }

std::string not_jammed_text(const MacroSpec& spec) {
  return fmt::format("macro: the preparation did not reach a pressure of {:.6g} E", spec.start_pressure);
}

void compact_to_fraction(const MacroSpec& spec, MacroPacking& packing, double fraction) {
  constexpr double kStep = 0.01;
  const double pressure = spec.start_pressure * spec.youngs_modulus;
  HardBodies hard(spec, packing);
  DampedOptions options;
  options.tolerance = 1e-3;
  options.max_passes = 50000;
  for (double now = hard.fraction(); now < fraction * (1.0 - 1e-9); now = hard.fraction()) {
    const double step = std::min(kStep, 1.0 - std::cbrt(now / fraction));
    strain_box(hard.system, hard.box, {{step, step, step}});
    const Vec3 size = hard.size();
    options.force_floor = 1e-2 * pressure * size[0] * size[1] / static_cast<double>(packing.bodies.size());
    DampedRelaxation<3>(options).relax(hard.system);
    if (hard.pressure() > pressure)
      throw InputError(fmt::format(
          "macro: the solid grains jam at a solid fraction of {:.6f}, before solid_fill = {:.6f}", now, fraction));
  }
  hard.take_over(packing);
}

}  // namespace softgrain
