#include <array>
#include <span>

#include "common/core/error.h"
#include "common/data/columns.h"
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

/// Members that stand side by side in one data set.
constexpr std::array kWallNumbers{&PackWall::youngs_modulus, &PackWall::poisson_ratio, &PackWall::friction};
constexpr std::array kContactNumbers{&PackContact::overlap, &PackContact::normal_force, &PackContact::contact_radius,
                                     &PackContact::torsion};
constexpr const char* kContactUnits = "overlap m, normal force N, contact radius m, torsion N m";
constexpr std::size_t kContactMarks = 3;

template <class Record, std::size_t kCount>
void write_side_by_side(const h5::Group& g, const std::string& name, const char* unit,
                        const std::vector<Record>& records, const std::array<double Record::*, kCount>& members) {
  std::vector<double> numbers;
  for (const Record& r : records)
    for (const auto member : members) numbers.push_back(r.*member);
  g.write(name, std::span<const double>(numbers), {records.size(), kCount});
  g.attribute_of(name, "unit", unit);
}

template <class Record, std::size_t kCount>
void take_side_by_side(const std::vector<double>& numbers, std::vector<Record>& records,
                       const std::array<double Record::*, kCount>& members) {
  for (std::size_t k = 0; k < records.size(); ++k)
    for (std::size_t m = 0; m < kCount; ++m) records[k].*members[m] = numbers[kCount * k + m];
}

void write_walls(const h5::Group& g, const std::vector<PackWall>& walls) {
  write_records(g, walls);
  write_side_by_side(g, "wall_E_nu_mu", "Pa, 1, 1", walls, kWallNumbers);
}

void write_contacts(const h5::Group& g, const std::vector<PackContact>& contacts) {
  write_records(g, contacts);
  write_side_by_side(g, "contact_numbers", kContactUnits, contacts, kContactNumbers);
  std::vector<std::int64_t> marks;
  for (const PackContact& c : contacts) marks.insert(marks.end(), {c.i, c.j, c.sliding ? 1 : 0});
  g.write("contact_pair_sliding", std::span<const std::int64_t>(marks), {contacts.size(), kContactMarks});
}

void read_walls(const h5::Group& g, GrainPack& pack) {
  const std::vector<double> numbers = g.doubles("wall_E_nu_mu");
  pack.walls.resize(numbers.size() / kWallNumbers.size());
  read_records(g, pack.walls);
  take_side_by_side(numbers, pack.walls, kWallNumbers);
}

void read_contacts(const h5::Group& g, GrainPack& pack) {
  const std::vector<std::int64_t> marks = g.integers("contact_pair_sliding");
  pack.contacts.resize(marks.size() / kContactMarks);
  take_side_by_side(read_numbers(g, "contact_numbers", kContactUnits, {pack.contacts.size(), kContactNumbers.size()}),
                    pack.contacts, kContactNumbers);
  read_records(g, pack.contacts);
  const auto bodies = static_cast<std::int64_t>(pack.position.size() + pack.walls.size());
  for (std::size_t k = 0; k < pack.contacts.size(); ++k) {
    const std::int64_t i = marks[kContactMarks * k];
    const std::int64_t j = marks[kContactMarks * k + 1];
    if (i < 0 || i >= pack.grains() || j <= i || j >= bodies) throw IoError("a contact names a body that is not there");
    PackContact& c = pack.contacts[k];
    c.i = static_cast<std::int32_t>(i);
    c.j = static_cast<std::int32_t>(j);
    c.sliding = marks[kContactMarks * k + 2] != 0;
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
