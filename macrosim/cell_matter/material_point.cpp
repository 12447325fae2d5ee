#include "macrosim/cell_matter/material_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/core/error.h"

namespace softgrain {

namespace {

constexpr std::size_t kAngles = 4;

struct Direction {
  Vec3 normal;
  double weight;
};

/// Gauss's rule of five points for cos(theta) in (0, 1), and angles in the middle of quarters of a quadrant.
const std::vector<Direction>& directions() {
  static const std::vector<Direction> made = [] {
    constexpr std::array<double, 5> kCosine{0.04691007703066800, 0.2307653449471585, 0.5, 0.7692346550528415,
                                            0.9530899229693320};
    constexpr std::array<double, 5> kWeight{0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                            0.2393143352496832, 0.1184634425280945};
    std::vector<Direction> out;
    for (std::size_t i = 0; i < kCosine.size(); ++i)
      for (std::size_t j = 0; j < kAngles; ++j) {
        const double sine = std::sqrt(1.0 - kCosine[i] * kCosine[i]);
        const double angle = (static_cast<double>(j) + 0.5) / kAngles * 0.5 * std::numbers::pi;
        out.push_back({{{sine * std::cos(angle), sine * std::sin(angle), kCosine[i]}}, kWeight[i] / kAngles});
      }
    return out;
  }();
  return made;
}

double pores_of(double solid, double onset) { return solid * (1.0 - onset) / onset; }

}  // namespace

MaterialPoint::MaterialPoint(const CellLaw& law, double solid_fraction, double onset, double critical)
    : law_(law), faces_(directions().size()) {
  if (!law.memory) throw InputError("material point: the law has no shear memory");
  for (const double f : {solid_fraction, onset, critical})
    if (!(f > 0.0 && f < 1.0)) throw InputError(fmt::format("material point: solid fraction {}", f));
  content_ = {solid_fraction, pores_of(solid_fraction, onset), pores_of(solid_fraction, critical)};
  require_valid(law_, {content_}, 1);
  next_pores_ = content_.pores;
  response_ = respond(law_.equation, law_.guard, content_, 1.0, law_.memory->least_state);
  stiffness_ = law_.friction.stiffness * response_.stiffness;
  strength_ = law_.memory->strength(law_.friction.coefficient, content_, 1.0);
}

void MaterialPoint::strain(const Vec3& logarithmic) {
  const double largest = std::max({std::abs(logarithmic[0]), std::abs(logarithmic[1]), std::abs(logarithmic[2])});
  const int parts = memory_parts(largest);
  for (int k = 0; k < parts; ++k) part(logarithmic * (1.0 / parts));
}

void MaterialPoint::part(const Vec3& strain) {
  const ShearMemory& memory = *law_.memory;
  const double mu_f = law_.friction.coefficient;
  // The content of a volume of 1 after the change of volume.
  const double denser = std::exp(strain[0] + strain[1] + strain[2]);
  const double pores = next_pores_ / content_.solid;
  const double critical = content_.critical / content_.solid;
  content_.solid *= denser;
  content_.pores = pores * content_.solid;
  content_.critical = critical * content_.solid;
  response_ = respond(law_.equation, law_.guard, content_, 1.0, law_.memory->least_state);
  const double stiffness_before = stiffness_;
  stiffness_ = law_.friction.stiffness * response_.stiffness;
  double slip = 0.0;
  double used = 0.0;
  double energy = 0.0;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto& [normal, weight] = directions()[f];
    const Vec3 motion{{-strain[0] * normal[0], -strain[1] * normal[1], -strain[2] * normal[2]}};
    const PulledSprings pulled =
        pull(faces_[f].force, stiffness_before, stiffness_, motion, normal, strength_ * response_.pressure);
    const FaceSlip one = slip_of(faces_[f].sum, stiffness_before, pulled.sum, stiffness_, motion, normal);
    slip += 2.0 * weight * one.slip;
    if (response_.pressure > 0.0) used += 3.0 * weight * one.work / response_.pressure;
    energy += 3.0 * weight * pulled.energy;
    faces_[f] = {pulled.force, pulled.sum};
  }
  spring_pressure_ = response_.stiffness > 0.0 ? -energy * (1.0 + response_.hardening / response_.stiffness) : 0.0;
  next_pores_ = memory.pores_after(mu_f, content_, 1.0, slip, used);
  CellContent next = content_;
  next.pores = next_pores_;
  strength_ = memory.strength(mu_f, next, 1.0);
}

Vec3 MaterialPoint::stress() const {
  const double p = response_.pressure + spring_pressure_;
  Vec3 out{{p, p, p}};
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto& [normal, weight] = directions()[f];
    for (int k = 0; k < 3; ++k) out[k] += 3.0 * weight * faces_[f].sum[k] * normal[k];
  }
  return out;
}

bool MaterialPoint::strain_at(double axial, double lateral) {
  const int parts = memory_parts(std::abs(axial));
  bool reached = true;
  for (int k = 0; k < parts; ++k) {
    const MaterialPoint before = *this;
    const double dz = axial / parts;
    const auto excess = [&](double side) {
      *this = before;
      part({{side, side, dz}});
      const Vec3 s = stress();
      return 0.5 * (s[0] + s[1]) - lateral;
    };
    // Lateral stress rises with lateral compression: regula falsi with halved weights (Illinois).
    double low = -2.0 * std::abs(dz);
    double high = 2.0 * std::abs(dz);
    double at_low = excess(low);
    double at_high = excess(high);
    if (at_low > 0.0 || at_high < 0.0) {
      (void)excess(at_low > 0.0 ? low : high);
      reached = false;
      continue;
    }
    for (int n = 0, side = 0; n < 60; ++n) {
      const double middle =
          at_high > at_low ? (low * at_high - high * at_low) / (at_high - at_low) : 0.5 * (low + high);
      const double at = excess(middle);
      if (std::abs(at) <= 1e-6 * lateral || high - low < 1e-13) break;
      if (at > 0.0) {
        high = middle;
        at_high = at;
        if (side == 1) at_low *= 0.5;
        side = 1;
      } else {
        low = middle;
        at_low = at;
        if (side == -1) at_high *= 0.5;
        side = -1;
      }
    }
  }
  return reached;
}

}  // namespace softgrain
