// The ways into touch: relaxation under a falling pressure, motion at a rate, fines that grow between coarse bodies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"
#include "common/neighbours/verlet_list.h"
#include "macrosim/grain_materials.h"
#include "macrosim/placed_spheres.h"
#include "macrosim/preparation.h"
#include "macrosim/pressed_box.h"

namespace softgrain {

namespace {

double mean_radius(const System3& s) {
  double sum = 0.0;
  for (std::size_t u = 0; u < at(s.particles.grains); ++u) sum += s.particles.sphere[u].r;
  return sum / s.particles.grains;
}

DampedOptions options_under(double pressure, const HardBodies& hard, const MacroSpec& spec, bool last) {
  const Vec3 size = hard.size();
  return pressing_options(spec, last, pressure * size[0] * size[1], hard.system.particles.grains,
                          mean_radius(hard.system));
}

[[noreturn]] void not_jammed(const MacroSpec& spec, HardBodies& hard, const RelaxationResult& rest) {
  throw UnusableResult(fmt::format(
      "{}: relaxation {} after {} passes; reached: walls at {:.3g} E, bodies fill {:.4f} of the box, largest net force "
      "(but for one body in 2000) {:.3g} of the mean contact force",
      not_jammed_text(spec), to_string(rest.end), rest.passes, hard.pressure() / spec.youngs_modulus, hard.fraction(),
      rest.residual));
}

/// How far pressing has come, 0 to 1. The first pressure closes the gaps and brings all roughly to rest, which takes
/// about two fifths of all passes; half go into the last pressure, whose residual falls like a power of them.
class PressingProgress {
 public:
  PressingProgress(const HardBodies& hard, double first) : first_(std::max(first, 1.0)), begin_(volume(hard)) {
    to_close_ = std::log(kPacked / std::min(hard.fraction(), 0.99 * kPacked));
  }

  [[nodiscard]] double at(const HardBodies& hard, double over, double residual, double tolerance) const {
    if (over <= 1.0) {
      const double before = first_ > 1.0 ? kLast : 0.0;
      return before + (1.0 - before) * reached(std::log(residual) / std::log(tolerance));
    }
    if (over < first_) return kFirst + (kLast - kFirst) * (1.0 - std::log(over) / std::log(first_));
    const double closed = reached(std::log(begin_ / volume(hard)) / to_close_);
    return kFirst * closed * (0.2 + 0.8 * reached(std::log(residual) / std::log(tolerance)));
  }

 private:
  static constexpr double kPacked = 0.55;
  static constexpr double kFirst = 0.4;
  static constexpr double kLast = 0.5;

  static double volume(const HardBodies& hard) {
    const Vec3 size = hard.size();
    return size[0] * size[1] * size[2];
  }
  static double reached(double way) { return way > 0.0 ? std::min(way, 1.0) : 0.0; }

  double first_;
  double begin_;
  double to_close_ = 0.0;
};

/// Relaxes bodies and walls together under a pressure that falls to the one asked for.
void press(HardBodies& hard, const MacroSpec& spec, double first, const PreparationWatch& watch) {
  const double asked = spec.start_pressure * spec.youngs_modulus;
  const PressingProgress progress(hard, first);
  for (double over = std::max(first, 1.0);; over = std::max(1.0, over * kPressureFall)) {
    const bool last = over <= 1.0;
    const double pressure = over * asked;
    BoxControl control{{true, true, true}, {{pressure, pressure, pressure}}, true};
    const DampedOptions options = options_under(pressure, hard, spec, last);
    control.tolerance = pressing_stress_tolerance(spec, last);
    PressedBox walls(hard.box, control, [&](const RelaxationResult& so_far) {
      if (watch) watch(progress.at(hard, over, so_far.residual, options.tolerance));
    });
    const RelaxationResult rest = DampedRelaxation<3>(options).relax(hard.system, walls);
    if (last && rest.end != RelaxationEnd::converged) not_jammed(spec, hard, rest);
    if (last) return;
  }
}

/// Velocities of a box that shrinks at this rate [1/s]: of its walls or the cell, and of all bodies when it begins.
void set_velocities(HardBodies& hard, double rate, bool bodies) {
  auto& p = hard.system.particles;
  const Vec3 centre = box_centre(hard.system, hard.box);
  if (hard.box.periodic)
    for (int k = 0; k < 3; ++k) hard.system.cell.velocity_gradient[k][k] = -rate;
  for (std::size_t u = bodies ? 0 : at(p.first_plane()); u < at(p.size()); ++u)
    p.velocity[u] = (centre - p.sphere[u].x) * rate;
}

/// A stable step for bodies that touch under the pressure, and that meet as fast as walls move at first.
double step_at(const HardBodies& hard, double pressure, double rate, const MacroSpec& spec) {
  const double speed = rate * hard.size()[0];
  const double modulus = lowest_modulus(spec);
  const double pressed = 4.0 * std::pow(pressure / modulus, 2.0 / 3.0);
  const double met = 2.0 * std::pow(highest_density(spec) * speed * speed / modulus, 0.4);
  const double damped = 1.0 + tsuji_alpha(spec.protocol.restitution);
  return 0.2 / damped * step_limit(hard.system, std::max(pressed, met)).natural_time;
}

/// Shrinks the box at the rate of the inertial number until its walls bear the pressure, in the mean over a little
/// time.
void shrink(MacroPacking& packing, const MacroSpec& spec, const PreparationWatch& watch) {
  constexpr int kWindow = 50;  ///< steps
  HardBodies hard(spec, packing, spec.protocol.friction, spec.protocol.restitution);
  const double pressure = spec.start_pressure * spec.youngs_modulus;
  const double diameter = 2.0 * mean_radius(hard.system);
  const double rate = spec.protocol.inertial_number / (diameter * std::sqrt(spec.density / pressure));
  const double start = hard.fraction();
  set_velocities(hard, rate, true);
  VelocityVerlet<3> motion(step_at(hard, pressure, rate, spec));
  motion.initialise(hard.system);
  for (double mean = 0.0; mean < pressure;) {
    stop_if_interrupted("compacting");
    set_velocities(hard, rate, false);
    mean = 0.0;
    for (int k = 0; k < kWindow; ++k) {
      motion.step(hard.system);
      mean += hard.pressure() / kWindow;
    }
    const double now = hard.fraction();
    if (!(now < 1.0))
      throw UnusableResult(fmt::format("{}: bodies fill {:.4f} of the box, whose walls bear {:.3g} E",
                                       not_jammed_text(spec), now, mean / spec.youngs_modulus));
    if (watch) watch(std::min(0.8, 0.8 * std::log(now / start) / std::log(0.62 / std::min(start, 0.6))));
  }
  hard.take_over(packing);
}

/// Fines at random places between the coarse bodies, their radii times the share that is returned, which is as small
/// as it takes.
double place_fines(const std::vector<MacroBody>& coarse, std::vector<MacroBody>& fines, const Vec3& low, double edge,
                   bool periodic, RandomStream& random) {
  constexpr int kTrials = 20000;
  std::vector<double> radii;
  for (const MacroBody& b : coarse) radii.push_back(b.r);
  for (const MacroBody& b : fines) radii.push_back(b.r);
  for (double share = 0.5;; share *= 0.7) {
    PlacedSpheres placed(edge, radii, periodic);
    for (const MacroBody& b : coarse) placed.add(b.x - low, b.r);
    const bool all = std::all_of(fines.begin(), fines.end(), [&](MacroBody& b) {
      const double r = share * b.r;
      for (int trial = 0; trial < kTrials; ++trial) {
        b.x = placed.place_of(r, random);
        if (placed.collides(b.x, r)) continue;
        placed.add(b.x, r);
        b.x = b.x + low;
        return true;
      }
      return false;
    });
    if (all) return share;
  }
}

void scale_fines(HardBodies& hard, const MacroPacking& packing, std::size_t coarse, double share) {
  for (std::size_t u = coarse; u < packing.bodies.size(); ++u)
    hard.system.particles.sphere[u].r = share * packing.bodies[u].r;
}

/// The coarse bodies and the walls stand; the fines grow to their radii, or to the share of them at which they press as
/// a relaxation begins. Returns that share.
double grow_fines(MacroPacking& packing, const MacroSpec& spec, std::size_t coarse, double share,
                  const PreparationWatch& watch) {
  constexpr double kGrowth = 1.04;
  constexpr std::int64_t kPasses = 400;
  HardBodies hard(spec, packing);
  for (std::size_t u = 0; u < coarse; ++u) hard.system.particles.inverse_mass[u] = 0.0;
  const double most = spec.protocol.first_pressure * spec.start_pressure * spec.youngs_modulus;
  DampedOptions options = options_under(most, hard, spec, false);
  options.max_passes = kPasses;
  const double first = share;
  for (;;) {
    const double next = std::min(1.0, share * kGrowth);
    scale_fines(hard, packing, coarse, next);
    rebuild_neighbours(hard.system);
    DampedRelaxation<3>(options).relax(hard.system);
    share = next;
    if (watch) watch(0.3 * (1.0 - std::log(share) / std::log(first)));
    if (share >= 1.0 || contact_stress(hard.system, hard.box)[0] > most) break;
  }
  hard.take_over(packing);
  return share;
}

}  // namespace

void bring_into_touch(const MacroSpec& spec, MacroPacking& packing, const PreparationWatch& watch) {
  const bool moves = spec.protocol.inertial_number > 0.0;
  if (moves) shrink(packing, spec, watch);
  HardBodies hard(spec, packing, spec.protocol.friction);
  press(hard, spec, spec.protocol.first_pressure, [&](double share) {
    if (watch) watch(moves ? 0.8 + 0.2 * share : share);
  });
  hard.take_over(packing);
}

MacroPacking pack_densely(const MacroSpec& spec, std::vector<MacroBody> bodies, std::uint64_t seed,
                          std::uint64_t sample, const PreparationWatch& watch) {
  double all = 0.0;
  for (const MacroBody& b : bodies) all += cube(b.r);
  std::size_t coarse = 0;
  for (double sum = 0.0; coarse < bodies.size() && sum < spec.protocol.coarse_share * all; ++coarse)
    sum += cube(bodies[coarse].r);
  std::vector<MacroBody> fines(bodies.begin() + static_cast<std::ptrdiff_t>(coarse), bodies.end());
  bodies.resize(coarse);
  MacroPacking packing = place_loosely(std::move(bodies), seed, sample, spec.protocol.start_fraction, spec.boundary);
  const auto from = [&](double begin, double length) {
    return [&watch, begin, length](double share) {
      if (watch) watch(begin + length * share);
    };
  };
  bring_into_touch(spec, packing, from(0.0, 0.2));
  if (fines.empty()) return packing;
  RandomStream random(seed, kMacroFines, sample);
  const double share =
      place_fines(packing.bodies, fines, packing.low, packing.size()[0], spec.boundary == Boundary::periodic, random);
  packing.bodies.insert(packing.bodies.end(), fines.begin(), fines.end());
  const double grown = grow_fines(packing, spec, coarse, share, from(0.2, 0.3));
  // What did not find room has it in a box that is as much wider.
  packing.low = packing.low * (1.0 / grown);
  packing.high = packing.high * (1.0 / grown);
  for (MacroBody& b : packing.bodies) b.x = b.x * (1.0 / grown);
  bring_into_touch(spec, packing, from(0.5, 0.5));
  return packing;
}

}  // namespace softgrain
