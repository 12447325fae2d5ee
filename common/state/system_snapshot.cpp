#include "common/state/system_io.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/vec.h"
#include "common/dynamics/force_pass.h"
#include "common/neighbours/spatial_order.h"

namespace softgrain {

namespace {

/// The steps along periodic edges that `gap` is made of, as a vector of exactly these edges.
template <int D>
Vec<D> lattice_vector(const Cell<D>& cell, const Vec<D>& gap) {
  if (!cell.any_periodic()) return {};
  Vec<D> steps = cell.fractional(gap);
  for (int k = 0; k < D; ++k) steps[k] = cell.periodic[static_cast<std::size_t>(k)] ? std::round(steps[k]) : 0.0;
  return cell.edges * steps;
}

template <int D>
SnapshotContact as_contact(const System<D>& s, const ContactRecord<D>& c) {
  const auto& p = s.particles;
  const Vec<D>& x = p.sphere[static_cast<std::size_t>(c.i)].x;
  SnapshotContact out;
  out.i = c.i < p.grains && !p.id.empty() ? p.id[static_cast<std::size_t>(c.i)] : c.i;
  out.j = c.j < p.grains && !p.id.empty() ? p.id[static_cast<std::size_t>(c.j)] : c.j;
  out.from = in_space<D>(x);
  out.point = in_space<D>(c.point);
  out.to = out.point;
  out.force = in_space<D>(c.normal * c.normal_force + c.tangential_force);
  out.normal_force = c.normal_force;
  if (c.j >= p.grains) return out;
  const Vec<D>& partner = p.sphere[static_cast<std::size_t>(c.j)].x;
  const Vec<D> shift = lattice_vector<D>(s.cell, x - c.branch - partner);
  out.shift = in_space<D>(shift);
  out.to = in_space<D>(partner + shift);
  if (out.i < out.j) return out;
  // Grains that were put in another order: the one of smaller number comes first.
  std::swap(out.i, out.j);
  out.force = -out.force;
  out.from = out.to - out.shift;
  out.to = in_space<D>(x) - out.shift;
  out.point -= out.shift;
  out.shift = -out.shift;
  return out;
}

template <int D>
void add_walls(const Particles<D>& p, std::vector<SnapshotWall>& walls) {
  for (Slot slot = p.grains; slot < p.size(); ++slot) {
    const Sphere<D>& sphere = p.sphere[static_cast<std::size_t>(slot)];
    SnapshotWall wall;
    wall.point = in_space<D>(sphere.x);
    wall.shape = slot < p.first_plane() ? WallShape::sphere_inside : WallShape::plane;
    wall.radius = sphere.r;
    if (wall.shape == WallShape::plane) wall.normal = in_space<D>(p.normal_of(slot));
    walls.push_back(wall);
  }
}

Vec3 spin_in_space(const Vec3& spin) { return spin; }
Vec3 spin_in_space(const Vec<1>& spin) { return {{0.0, 0.0, spin[0]}}; }

}  // namespace

template <int D>
std::vector<SnapshotContact> snapshot_contacts(const System<D>& system) {
  std::vector<SnapshotContact> contacts;
  for (const ContactRecord<D>& c : contact_records(system)) contacts.push_back(as_contact(system, c));
  std::stable_sort(contacts.begin(), contacts.end(), [](const SnapshotContact& a, const SnapshotContact& b) {
    return std::pair(a.i, a.j) < std::pair(b.i, b.j);
  });
  return contacts;
}

template <int D>
Snapshot snapshot_of(const System<D>& system, bool contacts) {
  const Particles<D>& p = system.particles;
  Snapshot out;
  out.dimension = D;
  out.has_velocity = true;
  for (const Slot slot : slots_by_id(p)) {
    const auto u = static_cast<std::size_t>(slot);
    SnapshotParticle one;
    one.position = in_space<D>(p.sphere[u].x);
    one.radius = p.sphere[u].r;
    one.velocity = in_space<D>(Vec<D>(p.velocity[u]));
    one.spin = spin_in_space(p.spin[u]);
    if (p.inverse_mass[u] > 0.0) one.mass = 1.0 / p.inverse_mass[u];
    one.id = one.body = static_cast<std::int64_t>(out.particles.size());
    one.material = p.material[u];
    out.particles.push_back(one);
  }
  add_walls(p, out.walls);
  for (int k = 0; k < D; ++k) {
    const auto u = static_cast<std::size_t>(k);
    out.periodic[u] = system.cell.periodic[u];
    for (int row = 0; row < D; ++row) out.cell_edges[u][row] = system.cell.edges[row][k];
  }
  out.has_contacts = contacts;
  if (contacts) out.contacts = snapshot_contacts(system);
  return out;
}

template std::vector<SnapshotContact> snapshot_contacts<2>(const System<2>&);
template std::vector<SnapshotContact> snapshot_contacts<3>(const System<3>&);
template Snapshot snapshot_of<2>(const System<2>&, bool);
template Snapshot snapshot_of<3>(const System<3>&, bool);

}  // namespace softgrain
