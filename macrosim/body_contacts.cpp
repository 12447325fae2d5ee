#include "macrosim/body_contacts.h"

#include <map>
#include <utility>

namespace softgrain {

namespace {

/// Centres of all bodies: of the shell where there is one, else of the mass.
std::vector<Vec3> body_centres(const MacroSystem& macro) {
  const auto& p = macro.system.particles;
  std::vector<Vec3> centre(static_cast<std::size_t>(macro.bodies));
  std::vector<double> mass(centre.size(), 0.0);
  std::vector<std::size_t> first(centre.size(), 0);
  const Cell<3>& cell = macro.system.cell;
  for (std::size_t u = 0; u < static_cast<std::size_t>(p.grains); ++u) {
    const auto n = static_cast<std::size_t>(macro.body[u]);
    const double m = 1.0 / p.inverse_mass[u];
    if (mass[n] == 0.0) first[n] = u;
    // Grains of a body that lies across a face of a periodic cell: those images that are near its first one.
    const Vec3& near = p.sphere[first[n]].x;
    centre[n] += (p.sphere[u].x + cell.image_shift(cell.image_near(near, p.sphere[u].x))) * m;
    mass[n] += m;
  }
  for (std::size_t n = 0; n < centre.size(); ++n)
    if (mass[n] > 0.0) centre[n] *= 1.0 / mass[n];
  for (Slot k = p.grains; k < p.first_plane(); ++k) {
    const auto u = static_cast<std::size_t>(k);
    centre[static_cast<std::size_t>(macro.body[u])] = p.sphere[u].x;
  }
  return centre;
}

/// Vector to `x` from the nearest image of `other`.
Vec3 between(const MacroSystem& macro, const Vec3& x, const Vec3& other) {
  const Cell<3>& cell = macro.system.cell;
  return x - other - cell.image_shift(cell.image_near(x, other));
}

Vec3 wall_branch(const MacroSystem& macro, const Vec3& centre, std::int32_t wall) {
  const auto& p = macro.system.particles;
  const Slot plane = macro.box.plane[static_cast<std::size_t>(wall)];
  const Vec3& normal = p.normal_of(plane);
  return normal * dot(centre - p.sphere[static_cast<std::size_t>(plane)].x, normal);
}

double anisotropy(const std::vector<Vec3>& directions) {
  double sum = 0.0;
  for (const Vec3& n : directions) sum += n[2] * n[2] - n[0] * n[0];
  return directions.empty() ? 0.0 : sum / static_cast<double>(directions.size());
}

}  // namespace

std::vector<BodyContact> body_contacts(const MacroSystem& macro, const std::vector<ContactRecord<3>>& contacts) {
  std::map<std::pair<std::int32_t, std::int32_t>, Vec3> forces;  // on the body of smaller number
  for (const ContactRecord<3>& c : contacts) {
    const std::int32_t a = macro.body[static_cast<std::size_t>(c.i)];
    const std::int32_t b = macro.body[static_cast<std::size_t>(c.j)];
    if (a == b) continue;
    const Vec3 on_i = c.normal * c.normal_force + c.tangential_force;
    forces[{std::min(a, b), std::max(a, b)}] += a < b ? on_i : -on_i;
  }
  const std::vector<Vec3> centre = body_centres(macro);
  std::vector<BodyContact> out;
  for (const auto& [pair, force] : forces) {
    BodyContact c{pair.first, pair.second, force, {}, 0.0};
    const Vec3& x = centre[static_cast<std::size_t>(c.a)];
    c.branch = c.b < macro.bodies ? between(macro, x, centre[static_cast<std::size_t>(c.b)])
                                  : wall_branch(macro, x, c.b - macro.bodies);
    c.normal_force = dot(force, c.branch) / norm(c.branch);
    out.push_back(c);
  }
  return out;
}

double fabric_anisotropy(const MacroSystem& macro, const std::vector<BodyContact>& contacts) {
  std::vector<Vec3> directions;
  for (const BodyContact& c : contacts)
    if (c.b < macro.bodies) directions.push_back(c.branch * (1.0 / norm(c.branch)));
  return anisotropy(directions);
}

double fabric_anisotropy(const MacroSystem& macro, const std::vector<ContactRecord<3>>& contacts) {
  std::vector<Vec3> directions;
  for (const ContactRecord<3>& c : contacts)
    if (c.i < macro.system.particles.grains && c.j < macro.system.particles.grains) directions.push_back(c.normal);
  return anisotropy(directions);
}

double body_coordination(const MacroSystem& macro, const std::vector<BodyContact>& contacts) {
  double sides = 0.0;
  for (const BodyContact& c : contacts) sides += c.b < macro.bodies ? 2.0 : 1.0;
  return macro.bodies > 0 ? sides / macro.bodies : 0.0;
}

}  // namespace softgrain
