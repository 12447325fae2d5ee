#include "macrosim/pressed_box.h"

#include <algorithm>
#include <cmath>

#include "common/core/parallel_tasks.h"
#include "common/dynamics/parallel_pass.h"

namespace softgrain {

namespace {

Vec3 by_axis(const Vec3& a, const Vec3& b) { return {{a[0] * b[0], a[1] * b[1], a[2] * b[2]}}; }

}  // namespace

void PressedBox::make_alike(Vec3& a) const {
  if (!control_.isotropic) return;
  const double mean = (a[0] + a[1] + a[2]) / 3.0;
  a = {{mean, mean, mean}};
}

void PressedBox::scale_masses(const System3& s, const BodyStiffness& stiffness, const PseudoMasses& masses) {
  const auto& p = s.particles;
  double sum = 0.0;
  for (std::size_t u = 0; u < at(p.first_plane()); ++u) {
    const double r = p.sphere[u].r;
    if (p.inverse_mass[u] > 0.0) sum += std::max(stiffness.translation[u], masses.floor(r)) * r * r;
  }
  inverse_mass_ = 1.0 / (4.0 / 3.0 * sum);
}

const Vec3& PressedBox::resisted(System3& s) {
  if (resisted_at_ == s.cost.loop_passes) return resisted_;
  resisted_at_ = s.cost.loop_passes;
  if (box_.periodic) return resisted_ = virial_.of(s);
  const auto& p = s.particles;
  const Vec3 centre = box_centre(s, box_);
  const auto resistance = [&](std::size_t begin, std::size_t end) {
    Vec3 sum{};
    for (std::size_t u = begin; u < end; ++u) sum += by_axis(p.force[u], carried_place(s, u) - centre);
    return sum;
  };
  return resisted_ = sum_in_pieces<Vec3>(at(p.size()), resistance, piece_threads(s));
}

PressedBox::Sums PressedBox::feel(System3& s) {
  const Vec3 size = box_high(s, box_) - box_low(s, box_);
  const double volume = size[0] * size[1] * size[2];
  force_ = control_.stress * volume - resisted(s);
  make_alike(force_);
  Sums sums;
  for (int k = 0; k < 3; ++k) {
    if (!control_.by_stress[static_cast<std::size_t>(k)]) force_[k] = 0.0;
    // A free side that nothing pushes stays where it is: no stress would bring it back.
    if (control_.free(k) && force_[k] >= 0.0) force_[k] = velocity_[k] = 0.0;
    sums.power += force_[k] * velocity_[k];
    sums.speed2 += velocity_[k] * velocity_[k] / inverse_mass_;
    sums.pull2 += force_[k] * force_[k] * inverse_mass_;
  }
  return sums;
}

void PressedBox::steer(double keep, double pull) { velocity_ = velocity_ * keep + force_ * (pull * inverse_mass_); }

void PressedBox::carry(System3& s, double step) {
  auto& p = s.particles;
  const double most = control_.largest_strain / step;
  velocity_ += force_ * (step * inverse_mass_);
  for (int k = 0; k < 3; ++k) velocity_[k] = std::clamp(velocity_[k], -most, most);
  strained_ += velocity_ * step;
  const Vec3 centre = box_centre(s, box_);
  carried_.resize(at(p.size()));
  if (box_.periodic) placed_.resize(carried_.size());
  const auto carry = [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      carried_[u] = by_axis(velocity_, centre - carried_place(s, u));
      p.sphere[u].x += carried_[u] * step;
      p.velocity[u] += carried_[u];
      if (box_.periodic) placed_[u] = p.sphere[u].x;
    }
  };
  // Shells come after the grains in them: all are still where they were.
  in_pieces(at(p.grains), carry, piece_threads(s));
  carry(at(p.grains), carried_.size());
  if (!box_.periodic) return;
  Vec3 factor;
  for (int k = 0; k < 3; ++k) {
    factor[k] = 1.0 - velocity_[k] * step;
    s.cell.velocity_gradient[k][k] = -velocity_[k] / factor[k];
  }
  s.cell.stretch(factor);
}

void PressedBox::release(System3& s) {
  auto& p = s.particles;
  const auto take_off = [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      // A body that went home through a face since has the velocity of the image that it is now.
      if (box_.periodic)
        if (const Vec3 way = placed_[u] - p.sphere[u].x; way != Vec3{}) carried_[u] -= s.cell.velocity_gradient * way;
      p.velocity[u] = p.force[u] == Stored<3>{} ? Vec3{} : Vec3(p.velocity[u]) - carried_[u];
    }
  };
  in_pieces(carried_.size(), take_off, piece_threads(s));
  if (box_.periodic) s.cell.velocity_gradient = {};
}

double PressedBox::residual(System3& s) {
  const Vec3& asked = control_.stress;
  const Vec3 size = box_high(s, box_) - box_low(s, box_);
  Vec3 off = (box_.periodic ? resisted(s) * (1.0 / (size[0] * size[1] * size[2])) : box_stress(s, box_)) - asked;
  make_alike(off);
  double worst = 0.0;
  double largest = control_.least_stress;
  for (int k = 0; k < 3; ++k) {
    if (!control_.by_stress[static_cast<std::size_t>(k)]) continue;
    worst = std::max(worst, std::abs(off[k]));
    largest = std::max(largest, std::abs(asked[k]));
  }
  return worst / (control_.tolerance * largest);
}

}  // namespace softgrain
