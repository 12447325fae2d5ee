#include "microsim/soft_experiment.h"

#include <cmath>
#include <numbers>

#include "common/core/solid_sphere.h"
#include "common/dynamics/displace.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/slow_dynamics.h"
#include "common/dynamics/system_snapshot.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {

namespace {

LawSet grain_laws(const SoftParticleSpec& spec, const Material& grain, bool damped) {
  LawSet laws(1);
  const double restitution = damped ? spec.restitution : 1.0;
  laws.set(0, 0, hertz_law(HertzCoefficients::of(grain, grain, spec.friction, restitution), false));
  return laws;
}

System3 empty_system(const SoftParticleSpec& spec, bool damped_contacts) {
  System3 s;
  s.materials = {{"grain", spec.density, spec.youngs_modulus, spec.poisson_ratio, false}};
  s.laws = grain_laws(spec, s.materials[0], damped_contacts);
  return s;
}

void add_grains(System3& s, const SoftParticleSpec& spec, const ShellPacking& packing, const Vec3& centre, Slot shell) {
  for (std::size_t k = 0; k < packing.radius.size(); ++k) {
    NewBody<3> grain = solid_sphere(centre + packing.position[k] * spec.shell_radius,
                                    packing.radius[k] * spec.shell_radius, spec.density, 0);
    grain.shell = shell;
    add_grain(s.particles, grain);
  }
}

void add_fixed_shell(System3& s, const SoftParticleSpec& spec, const Vec3& centre) {
  NewBody<3> shell;
  shell.x = centre;
  shell.r = spec.shell_radius;
  add_shell(s.particles, shell);
}

/// The instantaneous motion of a rigid rotation of body 1, for the springs between what turns and what does not.
void set_rotation_rate(SoftExperiment& e, double rate, bool shell_turns) {
  auto& p = e.system.particles;
  const Vec3 spin{{0.0, 0.0, rate}};
  for (Slot i = 0; i < e.first_grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    p.spin[u] = spin;
    p.velocity[u] = cross(spin, p.sphere[u].x);
  }
  if (shell_turns) p.spin[static_cast<std::size_t>(p.grains)] = spin;
}

bool turns_with_first(const SoftExperiment& e, Slot slot, bool shell_turns) {
  return slot < e.first_grains || (shell_turns && slot == e.system.particles.grains);
}

/// Springs inside the turning part turn with it; the loop then adds the sliding of all others.
void rotate_inner_springs(SoftExperiment& e, double angle, bool shell_turns) {
  auto& list = e.system.contacts;
  if (!list.has_spring) return;
  const Vec3 axis{{0.0, 0.0, 1.0}};
  for (std::size_t c = 0; c < list.i.size(); ++c)
    if (turns_with_first(e, list.i[c], shell_turns) && turns_with_first(e, list.j[c], shell_turns))
      list.spring[c] = rotate(list.spring[c], axis, angle);
}

/// One small step of the rotation. Its duration is long against any collision, so that dashpots do not matter, and
/// follows the natural time of the experiment, so that the dimensionless law is exactly the same for any E and Rs.
void rotation_step(SoftExperiment& e, double angle, bool shell_turns) {
  const double duration = 1024.0 * natural_time(e.spec);
  auto& p = e.system.particles;
  const Vec3 axis{{0.0, 0.0, 1.0}};
  update_neighbours(e.system);
  rotate_inner_springs(e, angle, shell_turns);
  for (Slot i = 0; i < e.first_grains; ++i) {
    auto& sphere = p.sphere[static_cast<std::size_t>(i)];
    sphere.x = rotate(sphere.x, axis, angle);
  }
  set_rotation_rate(e, angle / duration, shell_turns);
  force_pass(e.system, duration);
  e.system.contacts.commit();
}

}  // namespace

double natural_time(const SoftParticleSpec& spec) {
  return spec.shell_radius * std::sqrt(spec.density / spec.youngs_modulus);
}

void SoftExperiment::set_damping(bool damped) { take_laws(system, grain_laws(spec, system.materials[0], damped)); }

Vec3 SoftExperiment::force_on_second() const {
  Vec3 sum{};
  for (const ContactRecord<3>& c : contact_records(system)) {
    const bool j_is_second =
        c.j >= first_grains && (c.j < system.particles.grains || c.j >= system.particles.first_plane());
    if (c.i < first_grains && j_is_second) sum -= c.normal * c.normal_force + c.tangential_force;
  }
  return sum;
}

std::vector<Vec3> SoftExperiment::second_moves(double distance) const {
  const auto& p = system.particles;
  std::vector<Vec3> moves(static_cast<std::size_t>(p.size()));
  for (Slot i = first_grains; i < p.size(); ++i)
    if (i != p.grains) moves[static_cast<std::size_t>(i)][0] = -distance;
  return moves;
}

void SoftExperiment::push(double distance) {
  displace(system, second_moves(distance));
  normal_overlap += distance;
}

void SoftExperiment::rotate_first(double degrees, double step_degrees, bool shell_turns) {
  if (degrees == 0.0) return;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(degrees) / step_degrees)));
  const double angle = degrees * std::numbers::pi / 180.0 / steps;
  for (int k = 0; k < steps; ++k) rotation_step(*this, angle, shell_turns);
  set_rotation_rate(*this, 0.0, true);
}

SoftExperiment make_soft_solid(const SoftParticleSpec& spec, const ShellPacking& packing, bool damped_contacts) {
  SoftExperiment e{PairKind::soft_solid, spec, empty_system(spec, damped_contacts), 0, 0.0};
  const auto n = static_cast<Slot>(packing.radius.size());
  add_grains(e.system, spec, packing, {}, n);
  e.first_grains = n;
  add_fixed_shell(e.system, spec, {});
  NewBody<3> plane;
  plane.x = {{spec.shell_radius, 0.0, 0.0}};
  add_plane(e.system.particles, plane, Vec3{{-1.0, 0.0, 0.0}});
  return e;
}

SoftExperiment make_soft_soft(const SoftParticleSpec& spec, const ShellPacking& first, const ShellPacking& second,
                              bool damped_contacts) {
  SoftExperiment e{PairKind::soft_soft, spec, empty_system(spec, damped_contacts), 0, 0.0};
  const auto n1 = static_cast<Slot>(first.radius.size());
  const auto n2 = static_cast<Slot>(second.radius.size());
  const Vec3 other{{2.0 * spec.shell_radius, 0.0, 0.0}};
  add_grains(e.system, spec, first, {}, n1 + n2);
  add_grains(e.system, spec, second, other, n1 + n2 + 1);
  e.first_grains = n1;
  add_fixed_shell(e.system, spec, {});
  add_fixed_shell(e.system, spec, other);
  return e;
}

Snapshot soft_snapshot(const SoftExperiment& e) {
  Snapshot s = snapshot_of(e.system);
  s.kind = SnapshotKind::soft_particle;
  s.has_velocity = false;  // left over from relaxing
  s.overlap = e.normal_overlap / e.spec.shell_radius;
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    s.particles[k].role = ParticleRole::inner;
    s.particles[k].body = k < static_cast<std::size_t>(e.first_grains) ? 0 : 1;
    s.particles[k].velocity = {};
  }
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    if (s.walls[k].shape == WallShape::sphere_inside) s.walls[k].body = static_cast<std::int64_t>(k);
  return s;
}

}  // namespace softgrain
