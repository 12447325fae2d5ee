// FIRE: damping that adapts to the motion, for relaxations on any engine [Bitzek et al. 2006, PRL 97, 170201].
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace softgrain {

/// Velocities are steered towards the forces, the step grows while the motion goes downhill, and everything stops when
/// it goes uphill. In units where a body alone on its springs has frequency 1 (mass = stiffness, see PseudoMasses).
struct Fire {
  static constexpr double kLargestStep = 1.0;  ///< 2/sqrt(2) is the limit of stability (Gershgorin), fixed stiffness
  static constexpr double kFirstStep = 0.3;
  static constexpr double kGrow = 1.1;
  static constexpr double kShrink = 0.5;
  static constexpr double kFirstMixing = 0.15;
  static constexpr double kMixingDecay = 0.99;
  static constexpr std::int64_t kPatience = 5;

  double step = kFirstStep;
  double mixing = kFirstMixing;  ///< share of the velocity that is turned into the direction of the force
  std::int64_t downhill = 0;     ///< passes since the motion last went uphill

  /// v becomes keep v + pull F/m; all motion ends when `stop`.
  struct Steering {
    bool stop = false;
    double keep = 1.0;
    double pull = 0.0;
  };

  /// power = sum F.v, speed2 = sum m v^2, pull2 = sum F^2/m over all degrees of freedom.
  Steering steer(double power, double speed2, double pull2) {
    if (power < 0.0) {
      step *= kShrink;
      mixing = kFirstMixing;
      downhill = 0;
      return {true, 0.0, 0.0};
    }
    const double turn = pull2 > 0.0 ? mixing * std::sqrt(speed2 / pull2) : 0.0;
    const Steering out{false, 1.0 - mixing, turn};
    if (++downhill > kPatience) {
      step = std::min(step * kGrow, kLargestStep);
      mixing *= kMixingDecay;
    }
    return out;
  }
};

/// Sums over the bodies that forces move.
struct StiffnessSums {
  double stiffness = 0.0;  ///< sum of the stiffness of their contacts [N/m]
  double radii = 0.0;      ///< sum of their radii [m]

  template <class Particles, class Stiffness>
  StiffnessSums(const Particles& p, const Stiffness& of) {
    for (std::size_t u = 0; u < p.inverse_mass.size(); ++u) {
      if (!(p.inverse_mass[u] > 0.0)) continue;
      stiffness += of.translation[u];
      radii += p.sphere[u].r;
    }
  }
  /// A share of the mean stiffness per size [Pa]; zero where no body moves.
  [[nodiscard]] double per_radius(double share) const { return radii > 0.0 ? share * stiffness / radii : 0.0; }
};

/// Every body weighs as much as its contacts are stiff, so that all relax at one rate whatever their size.
struct PseudoMasses {
  static constexpr std::int64_t kInterval = 10;  ///< passes between two updates of the masses

  double floor_per_radius = 0.0;  ///< least stiffness over radius [Pa]
  double pull = 0.0;              ///< largest net force where nothing touches, else 0 [N]

  /// Takes sums over the bodies that forces move: of the stiffness of their contacts [N/m] and of their radii [m]. A
  /// body without contacts gets a share of the mean stiffness per size, so that a new contact does not throw it. Where
  /// hardly anything touches, that mean says nothing, and grains that meet would be too light for their contact. So no
  /// body counts as softer than `least` times its radius. With no contact anywhere, weights alone pull
  /// (`worst_net_force`): a body then moves by its radius in a step of 1, before the limit on moves.
  PseudoMasses(double stiffness_sum, double radius_sum, double least, double worst_net_force)
      : floor_per_radius(std::max(radius_sum > 0.0 ? 0.1 * stiffness_sum / radius_sum : 0.0, least)),
        pull(stiffness_sum > 0.0 ? 0.0 : worst_net_force) {}

  [[nodiscard]] double floor(double r) const {
    return std::max({floor_per_radius * r, r > 0.0 ? pull / r : 0.0, 1e-300});
  }
  /// `stiffness`: sum over the contacts of normal and tangential stiffness [N/m].
  [[nodiscard]] double inverse_mass(double stiffness, double r) const { return 1.0 / std::max(stiffness, floor(r)); }
  /// `stiffness`: sum over the contacts of tangential stiffness times the arm squared [N m].
  [[nodiscard]] double inverse_inertia(double stiffness, double r) const {
    return 1.0 / std::max(stiffness, 0.4 * floor(r) * r * r);
  }
};

/// How far a body may go in one pass, in its radius.
struct MoveLimit {
  static constexpr std::int64_t kLeadDoubles = 2000;  ///< passes

  double most = 0.05;
  /// Limit over the root mean square move of all: the few that fly would use up the margins of the neighbour list. It
  /// doubles every kLeadDoubles passes, so that no body waits for ever.
  double lead = std::numeric_limits<double>::infinity();

  /// `typical`: root mean square move of the last pass, in radii.
  [[nodiscard]] double at(double typical, std::int64_t pass) const {
    const double led = lead * std::exp2(static_cast<double>(pass / kLeadDoubles)) * typical;
    return typical > 0.0 ? std::min(most, led) : most;
  }
};

}  // namespace softgrain
