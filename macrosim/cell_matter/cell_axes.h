// The lengths of a packing of cells that are held by stress. Only cell_packing and cell_rest include it.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/dynamics/fire.h"
#include "macrosim/cell_matter/cell_packing.h"

namespace softgrain {

/// Lengths of axes that are held by stress, as logarithmic strains beside the places of the sites. What pushes one is
/// (P - sigma) V + sum F (x - c): the work of the asked stress less that of cells and sites that go along.
class CellPacking::Axes {
 public:
  Axes(const CellPacking& packing, const BoxControl& control) : control_(control) { weigh(packing); }

  /// Half a row of the stiffness matrix, as of sites: what all cells resist a change of length with, faces their
  /// springs, and again as much for the sites that it pushes.
  void weigh(const CellPacking& p) {
    double sum = 0.0;
    for (std::size_t i = 0; i < p.cells_.volume.size(); ++i)
      sum += p.forces_.response[i].stiffness * p.cells_.volume[i] * p.cells_.volume[i];
    for (const FaceSpring& spring : p.forces_.trial.springs)
      if (p.law_.friction.coefficient > 0.0) sum += spring.stiffness * norm2(spring.separation);
    double pressed = 0.0;
    for (int k = 0; k < 3; ++k) pressed += std::abs(control_.stress[k]) * p.room_.volume();
    mass_ = std::max(2.0 * sum, std::max(pressed, control_.least_stress * p.room_.volume()));
  }

  void feel(const CellPacking& p, double& power, double& speed2, double& pull2) {
    feel(p);
    for (int k = 0; k < 3; ++k) {
      power += velocity_[k] * force_[k];
      speed2 += velocity_[k] * velocity_[k] * mass_;
      pull2 += force_[k] * force_[k] / mass_;
    }
  }

  /// Strains that would bring the stress about, were the sites to go along and no axis to feel another.
  [[nodiscard]] Vec3 answer(const CellPacking& p) {
    feel(p);
    return force_ * (2.0 / mass_);
  }

  void steer(const Fire::Steering& steering, double step) {
    velocity_ = velocity_ * steering.keep + force_ * ((steering.pull + step) / mass_);
  }
  void stop() { velocity_ = {}; }

  /// Factors of the lengths in one pass.
  [[nodiscard]] Vec3 factors(double step) const {
    Vec3 out;
    const double most = control_.largest_strain;
    for (int k = 0; k < 3; ++k) out[k] = 1.0 - std::clamp(velocity_[k] * step, -most, most);
    return out;
  }
  [[nodiscard]] double largest_strain() const { return control_.largest_strain; }
  void took(const Vec3& factors) {
    for (int k = 0; k < 3; ++k) strained_[k] -= std::log(factors[k]);
  }
  /// Largest logarithmic strain of an axis so far.
  [[nodiscard]] double strained() const {
    return std::max({std::abs(strained_[0]), std::abs(strained_[1]), std::abs(strained_[2])});
  }
  [[nodiscard]] bool out_of_reach() const { return strained() > control_.farthest; }

  /// Largest error of the stress over its tolerance.
  [[nodiscard]] double residual(const CellPacking& p) const {
    const Matrix<3> stress = p.stress();
    Vec3 off;
    double largest = control_.least_stress;
    for (int k = 0; k < 3; ++k) {
      off[k] = stress[k][k] - control_.stress[k];
      if (control_.by_stress[static_cast<std::size_t>(k)]) largest = std::max(largest, std::abs(control_.stress[k]));
    }
    hold(off);
    return std::max({std::abs(off[0]), std::abs(off[1]), std::abs(off[2])}) / (control_.tolerance * largest);
  }

 private:
  void feel(const CellPacking& p) {
    const Matrix<3> stress = p.stress();
    const double volume = p.room_.volume();
    for (int k = 0; k < 3; ++k) force_[k] = (control_.stress[k] - stress[k][k]) * volume;
    if (!p.room_.periodic())
      for (std::size_t i = 0; i < p.sites_.size(); ++i)
        for (int k = 0; k < 3; ++k) force_[k] -= p.forces_.force[i][k] * (p.sites_[i].x[k] - p.room_.centre()[k]);
    hold(force_);
    // A free side that nothing pushes stays where it is: no stress would bring it back.
    for (int k = 0; k < 3; ++k)
      if (control_.free(k) && force_[k] >= 0.0) force_[k] = velocity_[k] = 0.0;
  }

  /// Axes alike take the mean; those that go by strain have none.
  void hold(Vec3& a) const {
    const double mean = (a[0] + a[1] + a[2]) / 3.0;
    for (int k = 0; k < 3; ++k)
      a[k] = !control_.by_stress[static_cast<std::size_t>(k)] ? 0.0 : control_.isotropic ? mean : a[k];
  }

  BoxControl control_;
  double mass_ = 0.0;
  Vec3 force_{};
  Vec3 velocity_{};
  Vec3 strained_{};
};

}  // namespace softgrain
