// A box or periodic cell that is held by stress: it comes to rest together with the bodies.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "common/core/cell.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/damped_relaxation.h"
#include "macrosim/box.h"

namespace softgrain {

/// Coordinates: logarithmic strains e_k of the axes, x_k -> c_k + (x_k - c_k)(1 - de_k) for walls and bodies (grains in
/// shells move with their shell); a periodic cell likewise about the origin. Generalised force P_k V - W_k, W_k =
/// sum F_k (x_k - c_k) over all bodies, walls among them, or the virial of the contacts in a periodic cell; mass
/// 4/3 sum of the contact stiffness of a body times its radius squared, twice what the contacts of an axis resist with.
/// A body that nothing pushes stops at once: it would hit its neighbours again and again while they relax.
class PressedBox : public RelaxingFrame<3> {
 public:
  /// `watch` is told how far the relaxation is, now and then.
  PressedBox(const Box& box, const BoxControl& control, std::function<void(const RelaxationResult&)> watch = {})
      : box_(box), control_(control), watch_(std::move(watch)) {}

  void scale_masses(const System3& system, const BodyStiffness& stiffness, const PseudoMasses& masses) override;
  Sums feel(System3& system) override;
  void steer(double keep, double pull) override;
  void carry(System3& system, double step) override;
  void release(System3& system) override;
  [[nodiscard]] double residual(System3& system) override;
  [[nodiscard]] bool out_of_reach() const override { return largest_of(strained_) > control_.farthest; }
  void see(const RelaxationResult& so_far) override {
    if (watch_) watch_(so_far);
  }

  /// What it needs to go on, beside the system.
  struct Motion {
    Vec3 velocity{};
    Vec3 strained{};
    Vec3 resisted{};
    std::int64_t resisted_at = -1;
  };
  [[nodiscard]] Motion motion() const { return {velocity_, strained_, resisted_, resisted_at_}; }
  void go_on_with(const Motion& motion) {
    velocity_ = motion.velocity;
    strained_ = motion.strained;
    resisted_ = motion.resisted;
    resisted_at_ = motion.resisted_at;
  }

 private:
  void make_alike(Vec3& a) const;
  static double largest_of(const Vec3& a) { return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])}); }
  /// W_k of the last pass [N m]; worked out once for each.
  [[nodiscard]] const Vec3& resisted(System3& system);

  Box box_;
  BoxControl control_;
  std::function<void(const RelaxationResult&)> watch_;
  double inverse_mass_ = 0.0;
  Vec3 force_{};     ///< force per logarithmic strain [N m]
  Vec3 velocity_{};  ///< rates of the strains
  Vec3 strained_{};  ///< strains since the beginning
  ContactVirial<3> virial_;
  Vec3 resisted_{};
  std::int64_t resisted_at_ = -1;  ///< loop passes when it was worked out
  std::vector<Vec3> carried_;      ///< velocities of the bodies with the box
  std::vector<Vec3> placed_;       ///< places to which the bodies were carried, in a periodic cell
};

}  // namespace softgrain
