#include "microsim/soft_experiment.h"

#include <cmath>
#include <utility>

#include "common/core/particles.h"
#include "common/dynamics/force_pass.h"
#include "common/state/system_io.h"

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

Drive SoftExperiment::turning(double rate, bool shell_turns) const {
  const auto& p = system.particles;
  const Vec3 about_z{{0.0, 0.0, rate}};
  std::vector<Vec3> velocity(static_cast<std::size_t>(p.size()));
  std::vector<Vec3> spin(static_cast<std::size_t>(p.size()));
  for (std::size_t u = 0; u < static_cast<std::size_t>(first_grains); ++u) {
    velocity[u] = cross(about_z, p.sphere[u].x);
    spin[u] = about_z;
  }
  if (shell_turns) spin[static_cast<std::size_t>(p.grains)] = about_z;
  return driven_at(std::move(velocity), std::move(spin));
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
    s.particles[k].velocity = s.particles[k].spin = {};
  }
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    if (s.walls[k].shape == WallShape::sphere_inside) s.walls[k].body = static_cast<std::int64_t>(k);
  return s;
}

}  // namespace softgrain
