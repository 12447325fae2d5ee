#include "macrosim/body_contacts.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <utility>

#include "common/core/particles.h"
#include "common/dynamics/contact_tensors.h"
#include "common/dynamics/force_pass.h"

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

using Contacts = std::vector<ContactRecord<3>>;

double solid_fraction(const MacroSystem& macro) {
  const Vec3 size = box_high(macro.system, macro.box) - box_low(macro.system, macro.box);
  double volume = 0.0;
  for (std::size_t u = 0; u < at(macro.system.particles.grains); ++u)
    volume += kSphereVolume * cube(macro.system.particles.sphere[u].r);
  return volume / (size[0] * size[1] * size[2]);
}

/// Grains with too few contacts go, until all that are left hold each other.
double rattling_share(const MacroSystem& macro, const Contacts& contacts, int needed) {
  const auto& p = macro.system.particles;
  std::vector<int> count(at(p.size()), 0);
  std::vector<std::vector<Slot>> partners(at(p.grains));
  const auto add = [&](Slot a, Slot b) {
    if (a >= p.grains) return;
    ++count[at(a)];
    if (b < p.grains) partners[at(a)].push_back(b);
  };
  for (const auto& c : contacts) {
    add(c.i, c.j);
    add(c.j, c.i);
  }
  std::vector<Slot> loose;
  std::vector<bool> gone(at(p.grains), false);
  const auto look_at = [&](Slot i) {
    if (gone[at(i)] || count[at(i)] >= needed) return;
    gone[at(i)] = true;
    loose.push_back(i);
  };
  for (Slot i = 0; i < p.grains; ++i) look_at(i);
  for (std::size_t k = 0; k < loose.size(); ++k)
    for (const Slot j : partners[at(loose[k])]) {
      --count[at(j)];
      look_at(j);
    }
  return static_cast<double>(loose.size()) / static_cast<double>(p.grains);
}

/// Shares of the sum of force times branch over all contacts, in the order of Bearers.
std::array<double, 3> shares(const MacroSystem& macro, const Contacts& contacts, double coarse) {
  const auto& p = macro.system.particles;
  std::array<double, 3> sum{};
  double all = 0.0;
  for (const auto& c : contacts) {
    const double virial = dot(c.normal * c.normal_force + c.tangential_force, c.branch);
    all += virial;
    if (c.j >= p.grains) continue;
    const int fine = (p.sphere[at(c.i)].r < coarse ? 1 : 0) + (p.sphere[at(c.j)].r < coarse ? 1 : 0);
    sum[static_cast<std::size_t>(fine)] += virial;
  }
  for (double& s : sum) s = all > 0.0 ? s / all : 0.0;
  return sum;
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

BodyFabric body_fabric(const MacroSystem& macro, const std::vector<BodyContact>& contacts) {
  std::vector<Vec3> all;
  std::vector<Vec3> strong;
  double sum = 0.0;
  for (const BodyContact& c : contacts) {
    if (c.b >= macro.bodies) continue;
    all.push_back(c.branch * (1.0 / norm(c.branch)));
    sum += c.normal_force;
  }
  const double mean = all.empty() ? 0.0 : sum / static_cast<double>(all.size());
  std::size_t k = 0;
  for (const BodyContact& c : contacts) {
    if (c.b >= macro.bodies) continue;
    if (c.normal_force > mean) strong.push_back(all[k]);
    ++k;
  }
  return {fabric_tensor(all), fabric_tensor(strong)};
}

double body_coordination(const MacroSystem& macro, const std::vector<BodyContact>& contacts) {
  double sides = 0.0;
  for (const BodyContact& c : contacts) sides += c.b < macro.bodies ? 2.0 : 1.0;
  return macro.bodies > 0 ? sides / macro.bodies : 0.0;
}

std::string share_name(Bearers bearers, double split) { return fmt::format("{} {:.4g}", to_string(bearers), split); }

void record_grains(const MacroSystem& macro, const MacroSpec& spec, MacroCurve& curve) {
  const Contacts contacts = contact_records(macro.system);
  curve.more[kSolidFraction].push_back(solid_fraction(macro));
  curve.more[kRattlers].push_back(rattling_share(macro, contacts, contacts_that_hold(spec)));
  for (const double split : spec.splits) {
    const auto share = shares(macro, contacts, split * macro.largest_radius);
    for (const Bearers b : {Bearers::coarse_coarse, Bearers::coarse_fine, Bearers::fine_fine})
      curve.more[share_name(b, split)].push_back(share[static_cast<std::size_t>(b)]);
  }
}

}  // namespace softgrain
