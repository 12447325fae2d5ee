// A box whose walls are held by stress: they come to rest together with the bodies.
#pragma once

#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "common/dynamics/damped_relaxation.h"
#include "macrosim/box.h"

namespace softgrain {

/// What the walls of each axis are held by.
struct WallControl {
  std::array<bool, 3> by_stress{};  ///< else they stay where they are
  Vec3 stress{};                    ///< on the walls of those axes, compression positive [Pa]
  bool alike = false;               ///< all axes strain alike, by the mean of their stresses
  double tolerance = 1e-3;          ///< of the stress, of the largest one asked for
  double largest_strain = 2e-3;     ///< per pass
};

/// Coordinates: logarithmic strains e_k of the axes, x_k -> c_k + (x_k - c_k)(1 - de_k) for walls and bodies (grains in
/// shells move with their shell). Generalised force P_k V - sum F_k (x_k - c_k) over all bodies, walls among them; mass
/// 4/3 sum of the contact stiffness of a body times its radius squared, twice what the contacts of an axis resist with.
/// A body that nothing pushes stops at once: it would hit its neighbours again and again while they come to rest.
class PressedBox : public RelaxingFrame<3> {
 public:
  /// `watch` is told how far the relaxation is, now and then.
  PressedBox(const Box& box, const WallControl& control, std::function<void(const RelaxationResult&)> watch = {})
      : box_(box), control_(control), watch_(std::move(watch)) {}

  void scale_masses(const System3& system, const BodyStiffness& stiffness, const PseudoMasses& masses) override;
  Sums feel(const System3& system) override;
  void steer(double keep, double pull) override;
  void carry(System3& system, double step) override;
  void release(System3& system) override;
  [[nodiscard]] double residual(const System3& system) const override;
  void see(const RelaxationResult& so_far) override {
    if (watch_) watch_(so_far);
  }

 private:
  void make_alike(Vec3& a) const;

  Box box_;
  WallControl control_;
  std::function<void(const RelaxationResult&)> watch_;
  double inverse_mass_ = 0.0;
  Vec3 force_{};               ///< per logarithmic strain [N m]
  Vec3 velocity_{};            ///< of the strains
  std::vector<Vec3> carried_;  ///< velocities of the bodies with it
};

}  // namespace softgrain
