#include "microsim/crowd_experiment.h"

#include <algorithm>
#include <cmath>

#include "common/data/slide_direction.h"
#include "common/dynamics/displace.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/residual.h"
#include "microsim/protocol.h"

namespace softgrain {

namespace {

/// Which neighbour a body belongs to; -1 for the centre.
std::vector<std::int32_t> owners(const CrowdExperiment& e) {
  std::vector<std::int32_t> owner(static_cast<std::size_t>(e.system.particles.size()), -1);
  for (std::size_t k = 0; k < e.neighbours.size(); ++k) {
    const CrowdExperiment::Neighbour& n = e.neighbours[k];
    for (Slot i = n.begin; i < n.end; ++i) owner[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(k);
    owner[static_cast<std::size_t>(n.body)] = static_cast<std::int32_t>(k);
  }
  return owner;
}

/// Force on each neighbour from the content of the centre [N].
std::vector<Vec3> neighbour_forces(const CrowdExperiment& e, const std::vector<ContactRecord<3>>& records) {
  const std::vector<std::int32_t> owner = owners(e);
  std::vector<Vec3> forces(e.neighbours.size());
  for (const ContactRecord<3>& c : records) {
    if (c.i >= e.centre_bodies) continue;
    const std::int32_t k = owner[static_cast<std::size_t>(c.j)];
    if (k >= 0) forces[static_cast<std::size_t>(k)] -= c.normal * c.normal_force + c.tangential_force;
  }
  return forces;
}

/// h/Rs of neighbour k, towards the shell where it is now.
double present_overlap(const CrowdExperiment& e, std::size_t k) {
  const auto& p = e.system.particles;
  const Vec3 apart =
      p.sphere[static_cast<std::size_t>(e.neighbours[k].body)].x - p.sphere[static_cast<std::size_t>(e.centre_shell)].x;
  const CrowdPartner& partner = e.configuration.partners[k];
  const double distance = partner.kind == PartnerKind::plane ? dot(apart, partner.direction) : norm(apart);
  return 1.0 + partner.ratio - distance / e.spec.shell_radius;
}

}  // namespace

Vec3 neighbour_place(const SoftParticleSpec& spec, const CrowdPartner& p, const Vec3& direction, double overlap) {
  return direction * ((1.0 + p.ratio - overlap) * spec.shell_radius);
}

Vec3 CrowdExperiment::direction(std::size_t k) const {
  const CrowdPartner& p = configuration.partners[k];
  if (k > 0 || slide == 0.0 || p.kind == PartnerKind::plane) return p.direction;
  const double angle = slide / (1.0 + p.ratio - overlap[0]);
  return p.direction * std::cos(angle) + slide_direction(p.direction) * std::sin(angle);
}

void CrowdExperiment::move_to(const std::vector<double>& overlaps, double slide_to) {
  std::vector<Vec3> moves(static_cast<std::size_t>(system.particles.size()));
  std::vector<Vec3> before(neighbours.size());
  for (std::size_t k = 0; k < neighbours.size(); ++k) before[k] = direction(k);
  const std::vector<double> overlaps_before = overlap;
  const double slide_before = slide;
  overlap = overlaps;
  slide = slide_to;
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const CrowdPartner& p = configuration.partners[k];
    Vec3 move = before[k] * ((overlaps_before[k] - overlap[k]) * spec.shell_radius);
    if (k == 0 && slide != slide_before)
      move = p.kind == PartnerKind::plane
                 ? move + slide_direction(p.direction) * ((slide - slide_before) * spec.shell_radius)
                 : neighbour_place(spec, p, direction(0), overlap[0]) -
                       neighbour_place(spec, p, before[0], overlaps_before[0]);
    for (Slot i = neighbours[k].begin; i < neighbours[k].end; ++i) moves[static_cast<std::size_t>(i)] = move;
    moves[static_cast<std::size_t>(neighbours[k].body)] = move;
  }
  displace(system, moves);
}

CrowdPoint CrowdExperiment::observe() const {
  CrowdPoint point;
  const double unit = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const std::vector<Vec3> forces = neighbour_forces(*this, contact_records(system));
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const Vec3 n = direction(k);
    const double normal = dot(forces[k], n);
    point.overlap.push_back(present_overlap(*this, k));
    point.normal.push_back(normal / unit);
    point.tangential.push_back((forces[k] - n * normal) * (1.0 / unit));
  }
  const Residual rest = softgrain::residual(system);
  point.residual = rest.relative(force_floor(spec));
  point.max_overlap = rest.max_overlap;
  point.slide = slide;
  point.centre = system.particles.sphere[static_cast<std::size_t>(centre_shell)].x * (1.0 / spec.shell_radius);
  return point;
}

}  // namespace softgrain
