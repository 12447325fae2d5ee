// LAMMPS dumps: particles (dump custom), contacts between particles and contacts with walls (dump local).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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

/// "ITEM: BOX BOUNDS ..." with tilts where the cell is sheared.
std::string box_text(const Snapshot& s) {
  std::array<Bounds, 3> b = bounds_of(s);
  std::string flags;
  for (const bool p : s.periodic) flags += p ? " pp" : " ff";
  const double xy = s.periodic[1] ? s.cell_edges[1][0] : 0.0;
  const double xz = s.periodic[2] ? s.cell_edges[2][0] : 0.0;
  const double yz = s.periodic[2] ? s.cell_edges[2][1] : 0.0;
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

}  // namespace

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
