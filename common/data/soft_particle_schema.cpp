#include "common/data/soft_particle_schema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/core/limits.h"
#include "common/io/scene.h"

namespace softgrain {

namespace {

const auto& numbers() {
  using S = SoftParticleSpec;
  const Range any = Range::any();
  const Range positive = Range::positive();
  const Range not_negative = Range::not_negative();
  const Range above_one = Range::above(1.0);
  const Range share = Range::closed(0.0, 1.0);
  static const std::array<SoftParticleNumber, 10> all{
      {{"shell_radius", "shell_radius", &S::shell_radius, Unit::length, positive, positive, "Rs", "Rs [m]", "Rs [m]",
        "Rs, radius of the shell (the sphere with the grains)", true},
       {"youngs_modulus", "E", &S::youngs_modulus, Unit::pressure, positive, positive, "E", "E [Pa]",
        "E of the grains [Pa]", "Young's modulus of the grains", true},
       {"poisson_ratio", "nu", &S::poisson_ratio, Unit::none, kPoissonRange, kPoissonRange, "nu", "nu",
        "nu of the grains", "Poisson's ratio of the grains"},
       {"friction", "mu", &S::friction, Unit::none, not_negative, not_negative, "mu", "mu", "mu of the grains",
        "friction between grains"},
       {"density", "density", &S::density, Unit::density, positive, positive, "density", "[kg/m^3]", "",
        "density of the grains"},
       {"restitution", "restitution", &S::restitution, Unit::none, share, share, "restitution", "", "",
        "coefficient of restitution of grains; sets the damping of the published relaxation"},
       {"exponent", "exponent", &S::exponent, Unit::none, any, above_one, "exponent", "b of P(r) ~ r^-b",
        "exponent of the radii", "b of P(r) ~ r^-b, the number of grains of radius r"},
       {"polydispersity", "polydispersity", &S::polydispersity, Unit::none, Range{1.0, kInfinity, false, false},
        above_one, "polydispersity", "rmax/rmin", "polydispersity", "largest over smallest grain radius"},
       {"rmax_over_shell", "rmax_over_shell", &S::rmax_over_shell, Unit::none, Range{0.0, 1.0, true, false},
        Range{0.0, 1.0, true, true}, "rmax_over_shell", "rmax/Rs", "largest grain over Rs",
        "radius of the largest grain over Rs"},
       {"beta", "beta", &S::beta, Unit::none, positive, above_one, "beta",
        "volume of drawn grains over volume of the shell", "packing, beta",
        "volume of the grains that are drawn, over the volume of the shell"}}};
  return all;
}

}  // namespace

std::span<const SoftParticleNumber> soft_particle_numbers() { return numbers(); }

const SoftParticleNumber& soft_particle_number(double SoftParticleSpec::*value) {
  const auto found = std::ranges::find(numbers(), value, &SoftParticleNumber::value);
  if (found == numbers().end()) throw std::logic_error("a number of a soft particle that is not described");
  return *found;
}

Limits limits_of(const Range& range) {
  constexpr double kMost = std::numeric_limits<double>::max();
  // Above zero: no number so small that it has lost digits.
  const double next = range.low == 0.0 ? std::numeric_limits<double>::min() : std::nextafter(range.low, kInfinity);
  return {std::max(-kMost, range.low_open ? next : range.low),
          std::min(kMost, range.high_open ? std::nextafter(range.high, -kInfinity) : range.high)};
}

}  // namespace softgrain
