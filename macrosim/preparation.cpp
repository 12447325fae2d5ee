#include "macrosim/preparation.h"

#include <cmath>
#include <string>

#include "common/core/error.h"
#include "common/core/solid_sphere.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/io/interrupt.h"
#include "macrosim/box.h"
#include "macrosim/placed_spheres.h"
#include "macrosim/pressed_box.h"

namespace softgrain {

namespace {

/// Largest first at random places of a cube; false when one finds none.
bool place(std::vector<MacroBody>& bodies, double edge, RandomStream& random) {
  constexpr int kTrials = 100000;
  std::vector<double> radii;
  for (const MacroBody& b : bodies) radii.push_back(b.r);
  PlacedSpheres placed(edge, radii);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    stop_if_interrupted("placing bodies");
    const double r = bodies[k].r;
    int trial = 0;
    do {
      for (int a = 0; a < 3; ++a) bodies[k].x[a] = r + random.uniform() * (edge - 2.0 * r);
    } while (placed.collides(bodies[k].x, r) && ++trial < kTrials);
    if (trial == kTrials) return false;
    placed.add(bodies[k].x, r);
  }
  return true;
}

Material hard_material(const MacroSpec& spec) {
  return {"hard", spec.density, spec.youngs_modulus, spec.poisson_ratio, false};
}

System3 hard_system(const MacroSpec& spec, const MacroPacking& packing, Box& box) {
  System3 s;
  s.materials = {hard_material(spec)};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hard_law(spec));
  for (const MacroBody& b : packing.bodies) {
    NewBody<3> grain;
    grain.x = b.x;
    grain.r = b.r;
    grain.mass = spec.density * kSphereVolume * cube(b.r);
    add_grain(s.particles, grain);
  }
  box = add_box(s, packing.low, packing.high, 0);
  return s;
}

/// Places of bodies and walls, back from the system that moved them.
void take_over(const System3& s, const Box& box, MacroPacking& packing) {
  packing.low = box_low(s, box);
  packing.high = box_high(s, box);
  for (std::size_t k = 0; k < packing.bodies.size(); ++k) packing.bodies[k].x = s.particles.sphere[k].x;
}

DampedOptions preparation_options(const CompactionProtocol& protocol) {
  DampedOptions options;
  options.tolerance = protocol.tolerance;
  options.max_passes = protocol.max_passes;
  options.force_floor = protocol.force_floor;
  return options;
}

/// As little as a body can be held by: a share of the stiffness of its contacts where all bear this pressure alike.
double least_stiffness(const System3& s, const Vec3& size, double pressure, double youngs_modulus) {
  double radii = 0.0;
  for (Slot i = 0; i < s.particles.grains; ++i) radii += s.particles.sphere[at(i)].r;
  const double n = s.particles.grains;
  const double force = pressure * size[0] * size[1] / std::cbrt(n * n);
  const double radius = radii / n;
  return 0.6 * std::cbrt(force * youngs_modulus * youngs_modulus * radius) / radius;
}

/// Relaxes bodies and walls together under a pressure that falls to the one asked for.
void compact(System3& s, const Box& box, const PressureLadder& ladder, double youngs_modulus) {
  WallControl control{{true, true, true}, {}, true};
  for (double over = ladder.first; over >= 1.0; over *= 0.5) {
    const bool last = over < 2.0;
    const double pressure = last ? ladder.pressure : over * ladder.pressure;
    const Vec3 size = box_high(s, box) - box_low(s, box);
    control.stress = {{pressure, pressure, pressure}};
    control.tolerance = last ? ladder.tolerance : ladder.loose;
    DampedOptions options;
    options.tolerance = control.tolerance;
    options.max_passes = ladder.max_passes;
    options.force_floor = 1e-2 * pressure * size[0] * size[1] / static_cast<double>(s.particles.grains);
    options.least_stiffness = least_stiffness(s, size, pressure, youngs_modulus);
    PressedBox walls(box, control);
    const RelaxationResult rest = DampedRelaxation<3>(options).relax(s, walls);
    if (last && rest.end != RelaxationEnd::converged) throw NotUsable(not_jammed_text(ladder.pressure, youngs_modulus));
  }
}

}  // namespace

double power_law_radius(double exponent, double rmax, double polydispersity, double u) {
  const double power = 1.0 - exponent;
  const double low = std::pow(rmax / polydispersity, power);
  const double high = std::pow(rmax, power);
  return std::pow(low + u * (high - low), 1.0 / power);
}

MacroPacking place_loosely(std::vector<MacroBody> bodies, std::uint64_t seed, std::uint64_t sample, double fraction) {
  double volume = 0.0;
  for (const MacroBody& b : bodies) volume += kSphereVolume * cube(b.r);
  RandomStream random(seed, kMacroPositions, sample);
  for (; fraction > 0.05; fraction *= 0.8) {
    const double edge = std::cbrt(volume / fraction);
    if (place(bodies, edge, random)) return {{}, {{edge, edge, edge}}, std::move(bodies)};
  }
  throw NotUsable("macro: could not place all bodies without overlap");
}

AnyLaw hard_law(const MacroSpec& spec) {
  const Material hard = hard_material(spec);
  return hertz_law(HertzCoefficients::of(hard, hard, 0.0, 1.0), false);
}

CompactionProtocol compaction_protocol(const MacroSpec& spec, const Vec3& size, std::size_t bodies) {
  CompactionProtocol protocol;
  protocol.pressure = spec.start_pressure * spec.youngs_modulus;
  protocol.force_floor = 1e-2 * protocol.pressure * size[0] * size[1] / static_cast<double>(bodies);
  return protocol;
}

std::string not_jammed_text(double pressure, double youngs_modulus) {
  return "macro: the preparation did not reach a pressure of " + std::to_string(pressure / youngs_modulus) + " E";
}

void bring_into_touch(const MacroSpec& spec, MacroPacking& packing) {
  Box box;
  System3 s = hard_system(spec, packing, box);
  compact(s, box, {.pressure = spec.start_pressure * spec.youngs_modulus}, spec.youngs_modulus);
  take_over(s, box, packing);
}

void compact_to_fraction(const MacroSpec& spec, MacroPacking& packing, double fraction) {
  constexpr double kStep = 0.01;
  Box box;
  System3 s = hard_system(spec, packing, box);
  const double pressure = spec.start_pressure * spec.youngs_modulus;
  for (;;) {
    const Vec3 size = box_high(s, box) - box_low(s, box);
    const double now = packing.body_volume() / (size[0] * size[1] * size[2]);
    if (now >= fraction * (1.0 - 1e-9)) break;
    const double step = std::min(kStep, 1.0 - std::cbrt(now / fraction));
    strain_box(s, box, {{step, step, step}});
    const Vec3 strained = box_high(s, box) - box_low(s, box);
    DampedRelaxation<3>(preparation_options(compaction_protocol(spec, strained, packing.bodies.size()))).relax(s);
    const Vec3 stress = wall_stress(s, box);
    if (stress[0] + stress[1] + stress[2] > 3.0 * pressure)
      throw BadInput("macro: the solid grains jam at a solid fraction of " + std::to_string(now) +
                     ", before solid_fill = " + std::to_string(fraction));
  }
  take_over(s, box, packing);
}

}  // namespace softgrain
