// Cohesive powders in two dimensions: what a sample is made of and how it starts [CP 3.1, 3.3].
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/contact/law_set.h"
#include "common/packing/grading.h"
#include "common/system.h"

namespace softgrain {

/// Units: a (largest diameter), mass of the largest disk, F0 (adhesion; without it P a), T0 = sqrt(m a/F0).
struct PowderSpec {
  std::int64_t disks = 1400;
  double diameter_min = 0.5;     ///< diameters uniform in [diameter_min, 1]
  double solid_fraction = 0.36;  ///< Phi_I of the start
  double stiffness = 1e5;        ///< kappa = a K_N/F0; without cohesion K_N/P
  double stiffness_ratio = 1.0;  ///< K_T/K_N
  double friction = 0.5;         ///< mu
  double damping = 0.8;          ///< zeta
  bool cohesive = true;
  double range = 1e-3;              ///< D0 over a
  bool rolling = false;             ///< rolling resistance
  double rolling_stiffness = 1e-4;  ///< K_r/(a^2 K_N)
  double rolling_friction = 1e-2;   ///< mu_r/(mu a)
  double pressure = 0.01;           ///< P* = P a/F0; without cohesion P itself is 1
  double start_speed = 0.0;         ///< V0, root mean square of each velocity component at the start, over
                                    ///< V* = sqrt(F0 D0/m); 0: at rest
  std::optional<Grading> sizes;  ///< size distribution of the disks, by area; in any unit, its largest size counts as 1

  /// F1 = max(F0, P a) of a pressure imposed, the scale of forces in equilibrium criteria.
  [[nodiscard]] double force_scale(double imposed) const { return cohesive ? std::max(1.0, imposed) : 1.0; }
  /// Imposed stress.
  [[nodiscard]] double stress() const { return cohesive ? pressure : 1.0; }
  friend bool operator==(const PowderSpec&, const PowderSpec&) = default;
};

/// The law of all pairs; stiffness in the units of the sample.
AnyLaw powder_law(const PowderSpec& spec);

/// Diameters of a sample, largest first.
std::vector<double> drawn_diameters(const PowderSpec& spec, std::uint64_t seed, std::uint64_t sample);

/// Disks at random places of a square periodic cell, largest first, none within reach of another; at rest, or with
/// Maxwell velocities without net momentum and without spin: each component has the root mean square V0 over the disks,
/// |v| that of sqrt 2 V0 [CP 3.3]. Throws InputError when they find no
/// place (Phi_I too high).
System<2> make_powder(const PowderSpec& spec, std::uint64_t seed, std::uint64_t sample);

/// Area of the disks over that of the cell.
double powder_fraction(const System<2>& system);

}  // namespace softgrain
