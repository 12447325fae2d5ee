#include <span>

#include "common/core/error.h"
#include "common/data/columns.h"
#include "microsim/grain_box/record.h"

namespace softgrain {

namespace {

constexpr std::size_t kWallNumbers = 3;
constexpr std::size_t kContactNumbers = 4;
constexpr const char* kContactUnits = "overlap m, normal force N, contact radius m, torsion N m";
constexpr std::size_t kContactMarks = 3;

void write_walls(const h5::Group& g, const std::vector<PackWall>& walls) {
  write_vectors(g, "wall_point", "m", walls, [](const PackWall& w) { return w.point; });
  write_vectors(g, "wall_normal", "1", walls, [](const PackWall& w) { return w.normal; });
  std::vector<double> numbers;
  for (const PackWall& w : walls) numbers.insert(numbers.end(), {w.youngs_modulus, w.poisson_ratio, w.friction});
  g.write("wall_E_nu_mu", std::span<const double>(numbers), {walls.size(), kWallNumbers});
  g.attribute_of("wall_E_nu_mu", "unit", "Pa, 1, 1");
}

void write_contacts(const h5::Group& g, const std::vector<PackContact>& contacts) {
  write_vectors(g, "contact_normal", "1", contacts, [](const PackContact& c) { return c.normal; });
  write_vectors(g, "contact_tangential_force", "N", contacts, [](const PackContact& c) { return c.tangential_force; });
  std::vector<double> numbers;
  std::vector<std::int64_t> marks;
  for (const PackContact& c : contacts) {
    numbers.insert(numbers.end(), {c.overlap, c.normal_force, c.contact_radius, c.torsion});
    marks.insert(marks.end(), {c.i, c.j, c.sliding ? 1 : 0});
  }
  g.write("contact_numbers", std::span<const double>(numbers), {contacts.size(), kContactNumbers});
  g.attribute_of("contact_numbers", "unit", kContactUnits);
  g.write("contact_pair_sliding", std::span<const std::int64_t>(marks), {contacts.size(), kContactMarks});
}

void read_walls(const h5::Group& g, GrainPack& pack) {
  const std::vector<double> numbers = g.doubles("wall_E_nu_mu");
  pack.walls.resize(numbers.size() / kWallNumbers);
  read_vectors(g, "wall_point", "m", pack.walls, [](PackWall& w, const Vec3& a) { w.point = a; });
  read_vectors(g, "wall_normal", "1", pack.walls, [](PackWall& w, const Vec3& a) { w.normal = a; });
  for (std::size_t k = 0; k < pack.walls.size(); ++k) {
    pack.walls[k].youngs_modulus = numbers[kWallNumbers * k];
    pack.walls[k].poisson_ratio = numbers[kWallNumbers * k + 1];
    pack.walls[k].friction = numbers[kWallNumbers * k + 2];
  }
}

void read_contacts(const h5::Group& g, GrainPack& pack) {
  const std::vector<std::int64_t> marks = g.integers("contact_pair_sliding");
  const std::vector<double> numbers =
      read_numbers(g, "contact_numbers", kContactUnits, {marks.size() / kContactMarks, kContactNumbers});
  pack.contacts.resize(marks.size() / kContactMarks);
  read_vectors(g, "contact_normal", "1", pack.contacts, [](PackContact& c, const Vec3& a) { c.normal = a; });
  read_vectors(g, "contact_tangential_force", "N", pack.contacts,
               [](PackContact& c, const Vec3& a) { c.tangential_force = a; });
  const auto bodies = static_cast<std::int64_t>(pack.position.size() + pack.walls.size());
  for (std::size_t k = 0; k < pack.contacts.size(); ++k) {
    const std::int64_t i = marks[kContactMarks * k];
    const std::int64_t j = marks[kContactMarks * k + 1];
    if (i < 0 || i >= pack.grains() || j <= i || j >= bodies) throw IoError("a contact names a body that is not there");
    PackContact& c = pack.contacts[k];
    c.i = static_cast<std::int32_t>(i);
    c.j = static_cast<std::int32_t>(j);
    c.sliding = marks[kContactMarks * k + 2] != 0;
    c.overlap = numbers[kContactNumbers * k];
    c.normal_force = numbers[kContactNumbers * k + 1];
    c.contact_radius = numbers[kContactNumbers * k + 2];
    c.torsion = numbers[kContactNumbers * k + 3];
  }
}

}  // namespace

void write_pack(const h5::Group& g, const GrainPack& pack) {
  write_vectors(g, "position", "m", pack.position, [](const Vec3& a) { return a; });
  write_column(g, "radius", "m", pack.radius, [](double x) { return x; });
  write_column(g, "youngs_modulus", "Pa", pack.youngs_modulus, [](double x) { return x; });
  write_column(g, "poisson_ratio", "1", pack.poisson_ratio, [](double x) { return x; });
  g.attribute("friction", pack.friction);
  write_walls(g, pack.walls);
  write_contacts(g, pack.contacts);
}

GrainPack read_pack(const h5::Group& g) {
  GrainPack pack;
  pack.radius = g.doubles("radius");
  pack.position.resize(pack.radius.size());
  read_vectors(g, "position", "m", pack.position, [](Vec3& x, const Vec3& a) { x = a; });
  pack.youngs_modulus = read_numbers(g, "youngs_modulus", "Pa", {pack.radius.size()});
  pack.poisson_ratio = read_numbers(g, "poisson_ratio", "1", {pack.radius.size()});
  pack.friction = g.number("friction");
  read_walls(g, pack);
  read_contacts(g, pack);
  return pack;
}

}  // namespace softgrain
