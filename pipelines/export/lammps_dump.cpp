// LAMMPS: dumps of particles (dump custom), of contacts between particles and with walls (dump local); data files that
// a simulation starts from.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "common/core/particles.h"
#include "pipelines/export/export.h"

namespace softgrain {

namespace {

struct Bounds {
  double low = 0.0;
  double high = 0.0;
};

/// The cell where it is periodic, else what particles take up. Disks of two dimensions get a slice of their size.
std::array<Bounds, 3> bounds_of(const Snapshot& s) {
  std::array<Bounds, 3> out{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (s.periodic[axis]) {
      out[axis] = {0.0, s.cell_edges[axis].v[axis]};
      continue;
    }
    bool first = true;
    for (const SnapshotParticle& p : s.particles) {
      const double low = p.position.v[axis] - p.radius;
      const double high = p.position.v[axis] + p.radius;
      out[axis] = first ? Bounds{low, high} : Bounds{std::min(out[axis].low, low), std::max(out[axis].high, high)};
      first = false;
    }
  }
  return out;
}

/// xy, xz, yz: how far the cell is sheared.
std::array<double, 3> tilts_of(const Snapshot& s) {
  return {s.periodic[1] ? s.cell_edges[1][0] : 0.0, s.periodic[2] ? s.cell_edges[2][0] : 0.0,
          s.periodic[2] ? s.cell_edges[2][1] : 0.0};
}

/// "ITEM: BOX BOUNDS ..." with tilts where the cell is sheared.
std::string box_text(const Snapshot& s) {
  std::array<Bounds, 3> b = bounds_of(s);
  std::string flags;
  for (const bool p : s.periodic) flags += p ? " pp" : " ff";
  const auto [xy, xz, yz] = tilts_of(s);
  if (xy == 0.0 && xz == 0.0 && yz == 0.0)
    return fmt::format("ITEM: BOX BOUNDS{}\n{} {}\n{} {}\n{} {}\n", flags, b[0].low, b[0].high, b[1].low, b[1].high,
                       b[2].low, b[2].high);
  // LAMMPS asks for the box around the sheared cell.
  b[0].low += std::min({0.0, xy, xz, xy + xz});
  b[0].high += std::max({0.0, xy, xz, xy + xz});
  b[1].low += std::min(0.0, yz);
  b[1].high += std::max(0.0, yz);
  return fmt::format("ITEM: BOX BOUNDS xy xz yz{}\n{} {} {}\n{} {} {}\n{} {} {}\n", flags, b[0].low, b[0].high, xy,
                     b[1].low, b[1].high, xz, b[2].low, b[2].high, yz);
}

std::string head(const Snapshot& s, const char* what, std::size_t number) {
  std::string text;
  if (!std::isnan(s.time)) text = fmt::format("ITEM: TIME\n{}\n", s.time);
  return text + fmt::format("ITEM: TIMESTEP\n{}\nITEM: NUMBER OF {}\n{}\n", s.frame, what, number) + box_text(s);
}

std::string particles_dump(const Snapshot& s) {
  std::string text = head(s, "ATOMS", s.particles.size());
  text += fmt::format("ITEM: ATOMS id type mol x y z radius{}\n", s.has_velocity ? " vx vy vz" : "");
  for (const SnapshotParticle& p : s.particles) {
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {}", p.id + 1, static_cast<int>(p.role) + 1, p.body + 1,
                   p.position[0], p.position[1], p.position[2], p.radius);
    if (s.has_velocity)
      fmt::format_to(std::back_inserter(text), " {} {} {}", p.velocity[0], p.velocity[1], p.velocity[2]);
    text += '\n';
  }
  return text;
}

std::string contacts_dump(const Snapshot& s, bool with_walls) {
  const auto n = static_cast<std::int32_t>(s.particles.size());
  std::string rows;
  std::size_t number = 0;
  for (const SnapshotContact& c : s.contacts) {
    if ((c.j >= n) != with_walls) continue;
    ++number;
    const std::int64_t first = s.particles[static_cast<std::size_t>(c.i)].id + 1;
    const std::int64_t second = with_walls ? c.j - n + 1 : s.particles[static_cast<std::size_t>(c.j)].id + 1;
    fmt::format_to(std::back_inserter(rows), "{} {} {} {} {} {} {} {} {} {}\n", number, first, second, c.normal_force,
                   c.force[0], c.force[1], c.force[2], c.point[0], c.point[1], c.point[2]);
  }
  return head(s, "ENTRIES", number) +
         fmt::format("ITEM: ENTRIES index {} normal_force fx fy fz px py pz\n",
                     with_walls ? "id wall" : "batom1 batom2") +
         rows;
}

/// Role and material.
using AtomType = std::pair<ParticleRole, std::int64_t>;

/// Types from 1, solid ones first.
std::map<AtomType, std::size_t> atom_types(const Snapshot& s) {
  std::map<AtomType, std::size_t> types;
  for (const SnapshotParticle& p : s.particles) types[{p.role, p.material}] = 0;
  std::size_t number = 0;
  for (auto& [type, of] : types) of = ++number;
  return types;
}

/// LAMMPS takes the first line for a title, and what stands behind # in others for a comment.
std::string data_head(const Snapshot& s, const std::map<AtomType, std::size_t>& types) {
  const auto one_line = [](std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return text;
  };
  std::string text =
      fmt::format("{}: {}, units {}, {}, {}{}\n\n{} atoms\n{} atom types\n", one_line(s.series), one_line(s.label),
                  s.length_unit, s.force_unit, s.time_unit, has_masses(s) ? "" : "; masses not recorded, density 1",
                  s.particles.size(), types.size());
  for (const auto& [type, number] : types)
    text += fmt::format("# type {}: {}, material {}\n", number, to_string(type.first), type.second);
  text += '\n';
  const std::array<Bounds, 3> b = bounds_of(s);
  for (std::size_t axis = 0; axis < 3; ++axis)
    text += fmt::format("{0} {1} {2}lo {2}hi\n", b[axis].low, b[axis].high, "xyz"[axis]);
  const auto [xy, xz, yz] = tilts_of(s);
  if (xy != 0.0 || xz != 0.0 || yz != 0.0) text += fmt::format("{} {} {} xy xz yz\n", xy, xz, yz);
  return text;
}

std::string data_text(const Snapshot& s) {
  const std::map<AtomType, std::size_t> types = atom_types(s);
  const bool known = has_masses(s);
  std::string text = data_head(s, types) + "\nAtoms # sphere\n\n";
  for (const SnapshotParticle& p : s.particles) {
    // Of disks too the density of a sphere, so that LAMMPS comes to the same mass.
    const double density = known ? p.mass / (kSphereVolume * p.radius * p.radius * p.radius) : 1.0;
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {}\n", p.id + 1, types.at({p.role, p.material}),
                   2.0 * p.radius, density, p.position[0], p.position[1], p.position[2]);
  }
  if (!s.has_velocity) return text;
  text += "\nVelocities\n\n";
  for (const SnapshotParticle& p : s.particles)
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {}\n", p.id + 1, p.velocity[0], p.velocity[1],
                   p.velocity[2], p.spin[0], p.spin[1], p.spin[2]);
  return text;
}

}  // namespace

bool has_masses(const Snapshot& s) {
  return std::ranges::all_of(s.particles,
                             [](const SnapshotParticle& p) { return std::isfinite(p.mass) && p.mass > 0.0; });
}

std::vector<ExportFile> data_files(const Snapshot& s, std::int64_t number) {
  return {{StateContent::particles, state_file_name(s, StateContent::particles, number, "data"), data_text(s)}};
}

std::vector<ExportFile> dump_files(const Snapshot& s, std::int64_t number) {
  std::vector<ExportFile> files{
      {StateContent::particles, state_file_name(s, StateContent::particles, number, "dump"), particles_dump(s)}};
  if (!s.has_contacts) return files;
  files.push_back(
      {StateContent::contacts, state_file_name(s, StateContent::contacts, number, "dump"), contacts_dump(s, false)});
  if (!s.walls.empty())
    files.push_back({StateContent::wall_contacts, state_file_name(s, StateContent::wall_contacts, number, "dump"),
                     contacts_dump(s, true)});
  return files;
}

}  // namespace softgrain
