#include "macrosim/preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/io/interrupt.h"
#include "macrosim/grain_materials.h"
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

/// Share of the bodies that may still be on their way: to wait for the last loose one takes ever longer, the more there
/// are (of 40,000 bodies 8,660 passes under the last pressure instead of 2,020, the fraction the same to 1e-4). The
/// test begins by bringing all to rest with its own law.
constexpr double kUnbalancedFraction = 1.0 / 2000.0;
/// Largest move per pass of the few bodies that are still on their way, in typical moves. In a million bodies some
/// always begin to fly, and the neighbour list was made every other pass for them. With 6 most bodies wait for others,
/// with 15 most lists remain.
constexpr double kLead = 10.0;

Material hard_material(const MacroSpec& spec) {
  return {"hard", spec.density, spec.youngs_modulus, spec.poisson_ratio, false};
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
  throw UnfitScene(fmt::format(
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
  const double least = std::min(0.05, fraction / 6.0);
  do {
    const double edge = std::cbrt(volume / fraction);
    if (place(bodies, edge, boundary, random)) return {{}, {{edge, edge, edge}}, std::move(bodies)};
    fraction *= 0.8;
  } while (fraction > least);
  throw UnusableResult("macro: could not place all bodies without overlap");
}

PreparationProtocol protocol_of(Preparation preparation, double friction) {
  PreparationProtocol p;
  if (preparation == Preparation::dense) p.coarse_share = 0.75;
  const bool rodded = preparation == Preparation::rodded;
  const bool fast = preparation == Preparation::fast || preparation == Preparation::poured || rodded;
  if (!fast && preparation != Preparation::slow) return p;
  p.inertial_number = fast ? 0.1 : 1e-3;
  p.friction = rodded ? std::min(friction, kRoddedFriction) : friction;
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
      throw UnfitScene(fmt::format(
          "macro: the solid grains jam at a solid fraction of {:.6f}, before solid_fill = {:.6f}", now, fraction));
  }
  hard.take_over(packing);
}

DampedOptions pressing_options(const MacroSpec& spec, bool last, double load, double bodies, double mean_radius) {
  DampedOptions options;
  options.tolerance = last ? spec.protocol.tolerance : std::max(kLoosePressing, spec.protocol.tolerance);
  options.max_passes = spec.protocol.max_passes;
  options.unbalanced_fraction = kUnbalancedFraction;
  if (kUnbalancedFraction * bodies >= 1.0) options.max_lead = kLead;
  options.force_floor = 1e-2 * load / bodies;
  // As little as a body can be held by: a share of the stiffness of its contacts where all bear alike.
  const double force = load / std::cbrt(bodies * bodies);
  const double modulus = lowest_modulus(spec);
  options.least_stiffness = 0.2 * std::cbrt(force * modulus * modulus * mean_radius) / mean_radius;
  return options;
}

double preparation_wall_friction(const MacroSpec& spec) {
  return spec.protocol.friction > 0.0 && spec.boundary == Boundary::walls ? spec.wall_friction : 0.0;
}

AnyLaw HardBodies::law(const MacroSpec& spec, double friction, double restitution) {
  const Material hard = hard_material(spec);
  return hertz_law(HertzCoefficients::of(hard, hard, friction, restitution, spec.rolling), false);
}

HardBodies::HardBodies(const MacroSpec& spec, const MacroPacking& packing, double friction, double restitution) {
  frictional_ = friction > 0.0;
  const std::int32_t wall = count_of_materials(spec);
  std::vector<std::int32_t> number;
  for (std::int32_t m = 0; m < wall; ++m) {
    number.push_back(m);
    system.materials.push_back(solid_material(spec, m, "hard"));
  }
  system.materials.push_back(hard_material(spec));
  system.laws = LawSet(wall + 1);
  const double wall_friction = frictional_ ? preparation_wall_friction(spec) : 0.0;
  set_solid_laws(spec, number, wall, {friction, wall_friction, restitution, spec.rolling}, system.laws);
  const bool periodic = spec.boundary == Boundary::periodic;
  const Vec3 corner = periodic ? packing.low : Vec3{};
  for (const MacroBody& b : packing.bodies) {
    NewBody<3> grain;
    grain.x = b.x - corner;
    grain.r = b.r;
    grain.mass = grain_density(spec, b.material) * kSphereVolume * cube(b.r);
    grain.material = b.material;
    if (friction > 0.0) grain.inertia = 0.4 * grain.mass * b.r * b.r;
    add_grain(system.particles, grain);
  }
  box = periodic ? add_periodic_cell(system, packing.size()) : add_box(system, packing.low, packing.high, wall);
}

double HardBodies::pressure() {
  const Vec3 edge = size();
  const Vec3 stress =
      box.periodic ? virial_.of(system) * (1.0 / (edge[0] * edge[1] * edge[2])) : box_stress(system, box);
  return (stress[0] + stress[1] + stress[2]) / 3.0;
}

double HardBodies::fraction() const {
  double volume = 0.0;
  for (std::size_t u = 0; u < at(system.particles.grains); ++u)
    volume += kSphereVolume * cube(system.particles.sphere[u].r);
  const Vec3 edge = size();
  return volume / (edge[0] * edge[1] * edge[2]);
}

std::vector<BodySpring> HardBodies::springs() const {
  std::vector<BodySpring> out;
  const auto& list = system.contacts;
  if (!frictional_ || !list.has_spring) return out;
  for (const ContactSection& section : list.sections) {
    for (auto c = at(section.begin); c < at(section.end); ++c)
      if (list.spring[c] != Stored<3>{} || (list.has_roll && list.roll[c] != Stored<3>{}))
        out.push_back({list.i[c], list.j[c], list.spring[c], list.has_roll ? Vec3(list.roll[c]) : Vec3{}});
  }
  std::ranges::sort(out, {}, [](const BodySpring& s) { return std::pair(s.i, s.j); });  // those of walls came last
  return out;
}

void HardBodies::take_over(MacroPacking& packing) const {
  packing.low = box_low(system, box);
  packing.high = box_high(system, box);
  for (std::size_t k = 0; k < packing.bodies.size(); ++k) packing.bodies[k].x = system.particles.sphere[k].x;
  packing.springs = springs();
  packing.cost += {system.cost.loop_passes, system.cost.contact_evaluations, seconds()};
}

}  // namespace softgrain
