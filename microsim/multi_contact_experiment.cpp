#include "microsim/multi_contact_experiment.h"

#include <algorithm>
#include <cmath>

#include "common/data/multi_contact_measurements.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/residual.h"
#include "common/dynamics/slow_dynamics.h"
#include "microsim/protocol.h"

namespace softgrain {

namespace {

/// Index of the neighbour that each body belongs to; -1 for the centre.
std::vector<std::int32_t> owners(const MultiContactExperiment& e) {
  std::vector<std::int32_t> owner(static_cast<std::size_t>(e.system.particles.size()), -1);
  for (std::size_t k = 0; k < e.neighbours.size(); ++k) {
    const MultiContactExperiment::Neighbour& n = e.neighbours[k];
    for (Slot i = n.begin; i < n.end; ++i) owner[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(k);
    owner[static_cast<std::size_t>(n.body)] = static_cast<std::int32_t>(k);
  }
  return owner;
}

/// Force on each neighbour from the content that it touches [N], and its moment about the contact point [N m].
struct Load {
  Vec3 force{};
  Vec3 moment{};
};

/// Radius of the soft particle that neighbour k touches, over Rs.
double touched_radius(const MultiContactExperiment& e, std::size_t k) {
  const std::int32_t on = e.configuration.partners[k].on;
  return on < 0 ? 1.0 : e.configuration.partners[at(on)].ratio;
}

std::vector<Load> neighbour_loads(const MultiContactExperiment& e, const std::vector<ContactRecord<3>>& records) {
  const std::vector<std::int32_t> owner = owners(e);
  std::vector<Vec3> touch;
  for (std::size_t k = 0; k < e.neighbours.size(); ++k)
    touch.push_back(e.system.particles.sphere[at(e.touched_shell(k))].x +
                    e.direction(k) * ((touched_radius(e, k) - 0.5 * e.overlap[k]) * e.spec.shell_radius));
  std::vector<Load> loads(e.neighbours.size());
  for (const ContactRecord<3>& c : records) {
    const std::int32_t k = owner[static_cast<std::size_t>(c.j)];
    const std::int32_t inside = owner[static_cast<std::size_t>(c.i)];  // of content: first of the two, see slots
    const bool content = inside < 0 ? c.i < e.centre_bodies : c.i < e.neighbours[at(inside)].end;
    if (!content || k < 0 || e.configuration.partners[at(k)].on != inside) continue;
    const Vec3 force = c.normal * c.normal_force + c.tangential_force;
    loads[at(k)].force -= force;
    loads[at(k)].moment -= cross(c.point - touch[at(k)], force);
  }
  return loads;
}

/// h/Rs of neighbour k, towards the shell where it is now.
double present_overlap(const MultiContactExperiment& e, std::size_t k) {
  const auto& p = e.system.particles;
  const Vec3 apart = p.sphere[at(e.neighbours[k].body)].x - p.sphere[at(e.touched_shell(k))].x;
  const MultiContactPartner& partner = e.configuration.partners[k];
  const double distance = partner.kind == PartnerKind::plane ? dot(apart, e.direction(k)) : norm(apart);
  return touched_radius(e, k) + partner.ratio - distance / e.spec.shell_radius;
}

/// The first neighbour, a plane, to its direction and its foot there.
void turn_plane(MultiContactExperiment& e) {
  const Slot slot = e.neighbours[0].body;
  auto& p = e.system.particles;
  const Vec3 n = e.direction(0);
  p.plane_normal[at(slot - p.first_plane())] = -n;
  p.sphere[at(slot)].x =
      p.sphere[at(e.centre_shell)].x + neighbour_place(e.spec, e.configuration.partners[0], n, e.overlap[0]);
  e.system.neighbours.reference.clear();  // a list knows how far planes go, not that they turn
}

}  // namespace

Vec3 neighbour_place(const SoftParticleSpec& spec, const MultiContactPartner& p, const Vec3& direction,
                     double overlap) {
  return direction * ((1.0 + p.ratio - overlap) * spec.shell_radius);
}

Vec3 MultiContactExperiment::direction(std::size_t k) const {
  const MultiContactPartner& p = configuration.partners[k];
  if (k > 0 || (slide == 0.0 && roll == 0.0)) return p.direction;
  const double round = p.kind == PartnerKind::plane ? 0.0 : slide / (1.0 + p.ratio - overlap[0]);
  const double angle = round + roll / (1.0 - 0.5 * overlap[0]);
  if (angle == 0.0) return p.direction;
  return p.direction * std::cos(angle) + slide_direction(p.direction) * std::sin(angle);
}

Slot MultiContactExperiment::touched_shell(std::size_t k) const {
  const std::int32_t on = configuration.partners[k].on;
  return on < 0 ? centre_shell : neighbours[at(on)].body;
}

void MultiContactExperiment::set_damping(bool on) { take_laws(system, on ? damped : undamped); }

std::vector<Vec3> MultiContactExperiment::prescribe(const MultiContactTarget& to) {
  std::vector<Vec3> moves(static_cast<std::size_t>(system.particles.size()));
  const MultiContactTarget from = now();
  std::vector<Vec3> before(neighbours.size());
  std::vector<Vec3> moved(neighbours.size());
  for (std::size_t k = 0; k < neighbours.size(); ++k) before[k] = direction(k);
  overlap = to.overlap;
  slide = to.slide;
  roll = to.roll;
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const MultiContactPartner& p = configuration.partners[k];
    const bool plane = p.kind == PartnerKind::plane;
    Vec3 move = before[k] * ((from.overlap[k] - overlap[k]) * spec.shell_radius);
    if (k == 0 && plane) {
      move = move + slide_direction(p.direction) * ((slide - from.slide) * spec.shell_radius);
      if (roll != from.roll) turn_plane(*this);
    } else if (k == 0 && (slide != from.slide || roll != from.roll)) {
      move = neighbour_place(spec, p, direction(0), overlap[0]) - neighbour_place(spec, p, before[0], from.overlap[0]);
    }
    if (p.on >= 0) move += moved[at(p.on)];
    moved[k] = move;
    if (configuration.pressed(k)) continue;
    for (Slot i = neighbours[k].begin; i < neighbours[k].end; ++i) moves[static_cast<std::size_t>(i)] = move;
    moves[static_cast<std::size_t>(neighbours[k].body)] = move;
  }
  return moves;
}

void MultiContactExperiment::move_to(const MultiContactTarget& to) { displace(system, prescribe(to)); }

MultiContactPoint MultiContactExperiment::observe() const {
  MultiContactPoint point;
  const double unit = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const std::vector<Load> loads = neighbour_loads(*this, contact_records(system));
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const Vec3 n = direction(k);
    const double normal = dot(loads[k].force, n);
    point.overlap.push_back(present_overlap(*this, k));
    point.normal.push_back(normal / unit);
    point.tangential.push_back((loads[k].force - n * normal) * (1.0 / unit));
    point.moment.push_back(loads[k].moment * (1.0 / (unit * spec.shell_radius)));
  }
  const Residual rest = softgrain::residual(system);
  point.residual = rest.relative(force_floor(spec));
  point.max_overlap = rest.max_overlap;
  point.slide = slide;
  point.roll = roll;
  point.centre = system.particles.sphere[static_cast<std::size_t>(centre_shell)].x * (1.0 / spec.shell_radius);
  return point;
}

}  // namespace softgrain
