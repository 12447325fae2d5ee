#include "common/contact/multi_contact_prediction.h"

namespace softgrain {

namespace {

/// A solid sphere of so many radii presses like a plane.
constexpr double kPlaneLike = 100.0;

LostVolume<double> lost_to(const MultiContactModel& model, const MultiContactPartner& p, double overlap) {
  const PairConstants k = neighbour_constants(model, p);
  return lost_volume(neighbour_lens(p, overlap), k.a, k.b);
}

double volume_of(const MultiContactModel& model, const MultiContactSum<3>& sum) {
  return model.multi_contact == LawForm::isotropic ? sum.volume : model.form.equivalent_volume(sum);
}

/// Sum over the contacts of the centre (`on` < 0), or over the planes around soft neighbour `on` of radius `radius` Rs.
MultiContactSum<3> sum_of(const MultiContactModel& model, const std::vector<MultiContactPartner>& partners,
                          const std::vector<double>& overlap, std::int32_t on = -1, double radius = 1.0) {
  MultiContactSum<3> sum;
  for (std::size_t k = 0; k < partners.size(); ++k)
    if (partners[k].on == on) sum.add(lost_to(model, partners[k], overlap[k] / radius).nu, partners[k].direction);
  return sum;
}

/// Force over E R^2 of one contact of a body whose sum is closed.
double felt_force(const MultiContactModel& model, const MultiContactSum<3>& sum, const LostVolume<double>& nu,
                  const Vec3& direction) {
  return nu.slope * sum.gain *
         (model.multi_contact == LawForm::isotropic ? sum.volume : model.form.felt(sum, nu.nu, direction));
}

/// Force over E R^2 of the only contact of a body.
double alone(const MultiContactModel& model, const LostVolume<double>& nu) {
  return nu.nu > 0.0 ? nu.slope * model.form.pressure.at(nu.nu).p : 0.0;
}

/// What soft neighbour k adds: it sees the particle in the middle as a soft one of radius 1/ratio.
double other_side(const MultiContactModel& model, const std::vector<MultiContactPartner>& partners,
                  const std::vector<double>& overlap, std::size_t k) {
  const MultiContactPartner& p = partners[k];
  if (p.kind != PartnerKind::soft) return 0.0;
  const MultiContactPartner back = seen_from_neighbour(p);
  const LostVolume nu = lost_to(model, back, overlap[k] / p.ratio);
  if (!(nu.nu > 0.0)) return 0.0;
  MultiContactSum<3> sum = sum_of(model, partners, overlap, static_cast<std::int32_t>(k), p.ratio);
  const double area = p.ratio * p.ratio;
  if (model.multi_contact == LawForm::pair || sum.volume == 0.0) return area * alone(model, nu);
  sum.add(nu.nu, back.direction);
  sum.close(model.form.pressure, volume_of(model, sum));
  return area * felt_force(model, sum, nu, back.direction);
}

}  // namespace

PairConstants neighbour_constants(const MultiContactModel& model, const MultiContactPartner& p) {
  if (p.kind == PartnerKind::plane) return p.smooth ? model.smooth : model.solid.at(0.0);
  if (p.kind == PartnerKind::solid) return model.solid.at(p.ratio);
  return model.soft.at(p.ratio);
}

Lens<double> neighbour_lens(const MultiContactPartner& p, double overlap) {
  return lens(std::max(overlap, 0.0), p.kind == PartnerKind::plane ? 0.0 : 1.0 / p.ratio);
}

MultiContactPartner seen_from_neighbour(const MultiContactPartner& p) {
  return {PartnerKind::soft, 1.0 / p.ratio, -p.direction};
}

std::vector<double> multi_contact_forces(const MultiContactModel& model,
                                         const std::vector<MultiContactPartner>& partners,
                                         const std::vector<double>& overlap) {
  MultiContactSum<3> sum = sum_of(model, partners, overlap);
  if (model.multi_contact != LawForm::pair) sum.close(model.form.pressure, volume_of(model, sum));
  std::vector<double> force;
  for (std::size_t k = 0; k < MultiContactConfiguration::touching_of(partners); ++k) {
    const LostVolume nu = lost_to(model, partners[k], overlap[k]);
    const double own =
        model.multi_contact == LawForm::pair ? alone(model, nu) : felt_force(model, sum, nu, partners[k].direction);
    force.push_back(own + other_side(model, partners, overlap, k));
  }
  return force;
}

double multi_contact_volume(const MultiContactModel& model, const std::vector<MultiContactPartner>& partners,
                            const std::vector<double>& overlap) {
  return volume_of(model, sum_of(model, partners, overlap));
}

void set_partners(MultiContactModel& model, PartnerKind kind, const std::vector<double>& ratios,
                  const std::vector<double>& log_weights, double exponent) {
  if (kind == PartnerKind::plane) {
    model.smooth = {std::exp(log_weights.front()), exponent};
    return;
  }
  LostVolumeTable& table = kind == PartnerKind::solid ? model.solid : model.soft;
  std::vector<double> x;
  std::vector<double> y;
  if (kind == PartnerKind::soft) {  // the same from either side: mirrored at ratio 1
    for (std::size_t k = ratios.size(); k-- > 0;) {
      if (!(ratios[k] > 1.0)) continue;
      x.push_back(-std::log(ratios[k]));
      y.push_back(log_weights[k]);
    }
  }
  for (std::size_t k = 0; k < ratios.size(); ++k) {
    x.push_back(std::log(ratios[k]));
    y.push_back(log_weights[k]);
  }
  if (kind == PartnerKind::soft) {
    table.common_exponent = exponent;
  } else {  // very large spheres are planes
    std::vector<double> m(x.size(), exponent);
    x.push_back(std::log(std::max(kPlaneLike, 2.0 * ratios.back())));
    y.push_back(0.0);
    m.push_back(1.0);
    table.exponent = MonotoneCurve(x, m);
  }
  table.log_weight = MonotoneCurve(x, y);
}

}  // namespace softgrain
