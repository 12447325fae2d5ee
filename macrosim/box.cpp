#include "macrosim/box.h"

#include "common/dynamics/contact_tensors.h"
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

Matrix<3> contact_stress_tensor(const System3& s, const Box& box, const std::vector<ContactRecord<3>>& contacts) {
  const Vec3 size = box_high(s, box) - box_low(s, box);
  Matrix<3> stress = branch_force_sum(contacts, s.particles.first_plane());
  for (int k = 0; k < 3; ++k) stress[k] = stress[k] * (1.0 / (size[0] * size[1] * size[2]));
  return stress;
}

Vec3 contact_stress(const System3& s, const Box& box) {
  const Matrix<3> stress = contact_stress_tensor(s, box, contact_records(s));
  return {{stress[0][0], stress[1][1], stress[2][2]}};
}

void shear_cell(System3& s, double shear) {
  auto& p = s.particles;
  for (std::size_t u = 0; u < at(p.size()); ++u) p.velocity[u] = Vec3{{-shear * carried_place(s, u)[2], 0.0, 0.0}};
  for (std::size_t u = 0; u < at(p.size()); ++u) {
    p.sphere[u].x += Vec3(p.velocity[u]);
    const bool turns = u < at(p.grains) && p.shell[u] < 0;
    p.spin[u] = turns ? Vec3{{0.0, -0.5 * shear, 0.0}} : Vec3{};
  }
  s.cell.edges[0][2] -= shear * s.cell.edges[2][2];
  s.cell.velocity_gradient[0][2] = -shear;  // over the unit of time that the stroke takes
  force_pass(s, 1.0, History::advance);
  s.cell.velocity_gradient = {};
  for (std::size_t u = 0; u < at(p.size()); ++u) {
    p.velocity[u] = Vec3{};
    p.spin[u] = Vec3{};
  }
}

}  // namespace softgrain
