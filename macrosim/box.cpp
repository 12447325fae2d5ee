#include "macrosim/box.h"

#include "common/dynamics/force_pass.h"

namespace softgrain {

Box add_box(System3& system, const Vec3& low, const Vec3& high, std::int32_t material) {
  Box box;
  const Vec3 middle = (low + high) * 0.5;
  for (int k = 0; k < 3; ++k) {
    for (int side = 0; side < 2; ++side) {
      NewBody<3> plane;
      plane.material = material;
      plane.x = middle;
      plane.x[k] = side == 0 ? low[k] : high[k];
      Vec3 normal{};
      normal[k] = side == 0 ? 1.0 : -1.0;
      box.plane[static_cast<std::size_t>(2 * k + side)] = add_plane(system.particles, plane, normal);
    }
  }
  return box;
}

Box add_periodic_cell(System3& system, const Vec3& size) {
  system.cell = box_cell<3>(size, {true, true, true});
  return {{}, true};
}

namespace {

double plane_coordinate(const System3& s, const Box& box, int axis, int side) {
  return s.particles.sphere[static_cast<std::size_t>(box.plane[static_cast<std::size_t>(2 * axis + side)])].x[axis];
}

}  // namespace

Vec3 box_low(const System3& s, const Box& box) {
  if (box.periodic) return {};
  return {{plane_coordinate(s, box, 0, 0), plane_coordinate(s, box, 1, 0), plane_coordinate(s, box, 2, 0)}};
}

Vec3 box_high(const System3& s, const Box& box) {
  if (box.periodic) return {{s.cell.edges[0][0], s.cell.edges[1][1], s.cell.edges[2][2]}};
  return {{plane_coordinate(s, box, 0, 1), plane_coordinate(s, box, 1, 1), plane_coordinate(s, box, 2, 1)}};
}

Vec3 box_centre(const System3& s, const Box& box) {
  return box.periodic ? Vec3{} : (box_low(s, box) + box_high(s, box)) * 0.5;
}

void strain_box(System3& s, const Box& box, const Vec3& strain) {
  const Vec3 centre = box_centre(s, box);
  std::vector<Vec3> moves(static_cast<std::size_t>(s.particles.size()));
  for (std::size_t u = 0; u < moves.size(); ++u) {
    const Vec3 place = carried_place(s, u);
    for (int k = 0; k < 3; ++k) moves[u][k] = -strain[k] * (place[k] - centre[k]);
  }
  if (box.periodic)
    displace(s, moves, -strain);
  else
    displace(s, moves);
}

Vec3 box_stress(const System3& s, const Box& box) {
  if (box.periodic) return contact_stress(s, box);
  const Vec3 size = box_high(s, box) - box_low(s, box);
  const double volume = size[0] * size[1] * size[2];
  Vec3 out;
  for (int k = 0; k < 3; ++k) {
    const double low = s.particles.force[static_cast<std::size_t>(box.plane[static_cast<std::size_t>(2 * k)])][k];
    const double high = s.particles.force[static_cast<std::size_t>(box.plane[static_cast<std::size_t>(2 * k + 1)])][k];
    out[k] = 0.5 * (high - low) * size[k] / volume;
  }
  return out;
}

Vec3 contact_stress(const System3& s, const Box& box) {
  const Vec3 size = box_high(s, box) - box_low(s, box);
  Vec3 sum{};
  for (const ContactRecord<3>& c : contact_records(s)) {
    const Vec3 force = c.normal * c.normal_force + c.tangential_force;
    const Vec3 branch = c.j >= s.particles.first_plane() ? c.normal * dot(c.branch, c.normal) : c.branch;
    for (int k = 0; k < 3; ++k) sum[k] += force[k] * branch[k];
  }
  return sum * (1.0 / (size[0] * size[1] * size[2]));
}

}  // namespace softgrain
