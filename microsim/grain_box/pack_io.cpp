#include "common/core/error.h"
#include "common/data/columns.h"
#include "common/data/rows.h"
#include "microsim/grain_box/record.h"

namespace softgrain {

void fields(auto&& visit, Of<PackWall> auto& w) {
  visit("wall_point", w.point, "m", kAsRows);
  visit("wall_normal", w.normal, "1", kAsRows);
}

void fields(auto&& visit, Of<PackContact> auto& c) {
  visit("contact_normal", c.normal, "1", kAsRows);
  visit("contact_tangential_force", c.tangential_force, "N", kAsRows);
}

namespace {

// What stands in a row of each data set.

constexpr auto kWallNumbers = [](auto&& visit, auto& w) {
  visit(w.youngs_modulus);
  visit(w.poisson_ratio);
  visit(w.friction);
};
constexpr auto kContactNumbers = [](auto&& visit, auto& c) {
  visit(c.overlap);
  visit(c.normal_force);
  visit(c.contact_radius);
  visit(c.torsion);
};
constexpr const char* kContactUnits = "overlap m, normal force N, contact radius m, torsion N m";
constexpr auto kContactPair = [](auto&& visit, auto& c) {
  visit(c.i);
  visit(c.j);
  visit(c.sliding);
};

/// Numbers of each grain, after their places.
void grain_numbers(auto&& visit, auto& pack) {
  visit("radius", "m", pack.radius);
  visit("youngs_modulus", "Pa", pack.youngs_modulus);
  visit("poisson_ratio", "1", pack.poisson_ratio);
}

void write_walls(const h5::Group& g, const std::vector<PackWall>& walls) {
  write_records(g, walls);
  write_rows(g, "wall_E_nu_mu", walls, kWallNumbers);
  g.attribute_of("wall_E_nu_mu", "unit", "Pa, 1, 1");
}

void write_contacts(const h5::Group& g, const std::vector<PackContact>& contacts) {
  write_records(g, contacts);
  write_rows(g, "contact_numbers", contacts, kContactNumbers);
  g.attribute_of("contact_numbers", "unit", kContactUnits);
  write_rows(g, "contact_pair_sliding", contacts, kContactPair);
}

void read_walls(const h5::Group& g, GrainPack& pack) {
  pack.walls = records_in_rows<PackWall>(g, "wall_E_nu_mu", kWallNumbers);
  read_records(g, pack.walls);
}

void read_contacts(const h5::Group& g, GrainPack& pack) {
  pack.contacts = records_in_rows<PackContact>(g, "contact_pair_sliding", kContactPair);
  const std::size_t width = rows::form_of(PackContact{}, kContactNumbers).width;
  take_rows(read_numbers(g, "contact_numbers", kContactUnits, {pack.contacts.size(), width}), pack.contacts,
            kContactNumbers, "contact_numbers");
  read_records(g, pack.contacts);
  const auto bodies = static_cast<std::int64_t>(pack.position.size() + pack.walls.size());
  for (const PackContact& c : pack.contacts)
    if (c.i < 0 || c.i >= pack.grains() || c.j <= c.i || c.j >= bodies)
      throw IoError("a contact names a body that is not there");
}

}  // namespace

void write_pack(const h5::Group& g, const GrainPack& pack) {
  write_vectors(g, "position", "m", pack.position, [](const Vec3& a) { return a; });
  grain_numbers(
      [&](const char* name, const char* unit, const std::vector<double>& numbers) {
        write_column(g, name, unit, numbers, [](double x) { return x; });
      },
      pack);
  g.attribute("friction", pack.friction);
  write_walls(g, pack.walls);
  write_contacts(g, pack.contacts);
}

GrainPack read_pack(const h5::Group& g) {
  GrainPack pack;
  pack.position.resize(g.doubles("radius").size());
  read_vectors(g, "position", "m", pack.position, [](Vec3& x, const Vec3& a) { x = a; });
  grain_numbers([&](const char* name, const char* unit,
                    std::vector<double>& numbers) { numbers = read_numbers(g, name, unit, {pack.position.size()}); },
                pack);
  pack.friction = g.number("friction");
  read_walls(g, pack);
  read_contacts(g, pack);
  return pack;
}

}  // namespace softgrain
