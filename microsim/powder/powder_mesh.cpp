#include "microsim/powder/powder_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/error.h"

namespace softgrain {

namespace {

std::int64_t wrapped(std::int64_t index, std::int64_t period) { return ((index % period) + period) % period; }

/// Cells [from, to] of a row, any integers, folded into the period.
void fill_row(std::uint8_t* row, std::int64_t period, std::int64_t from, std::int64_t to) {
  if (to - from + 1 >= period) {
    std::fill(row, row + period, std::uint8_t{1});
    return;
  }
  const std::int64_t first = wrapped(from, period);
  const std::int64_t last = first + (to - from);
  std::fill(row + first, row + std::min(last + 1, period), std::uint8_t{1});
  if (last >= period) std::fill(row, row + (last + 1 - period), std::uint8_t{1});
}

void fill_disk(PowderMesh& mesh, const Sphere<2>& disk) {
  const Vec<2> d = mesh.spacing();
  const auto first = static_cast<std::int64_t>(std::ceil((disk.x[1] - disk.r) / d[1] - 0.5));
  const auto last = static_cast<std::int64_t>(std::floor((disk.x[1] + disk.r) / d[1] - 0.5));
  for (std::int64_t j = first; j <= last; ++j) {
    const double off = (static_cast<double>(j) + 0.5) * d[1] - disk.x[1];
    const double half = std::sqrt(std::max(disk.r * disk.r - off * off, 0.0));
    const auto from = static_cast<std::int64_t>(std::ceil((disk.x[0] - half) / d[0] - 0.5));
    const auto to = static_cast<std::int64_t>(std::floor((disk.x[0] + half) / d[0] - 0.5));
    if (from <= to) fill_row(mesh.solid.data() + wrapped(j, mesh.ny) * mesh.nx, mesh.nx, from, to);
  }
}

/// Steps along the longer axis, one cell each (Bresenham).
void draw_line(PowderMesh& mesh, const Vec<2>& from, const Vec<2>& to) {
  const Vec<2> d = mesh.spacing();
  std::array<double, 2> at{from[0] / d[0] - 0.5, from[1] / d[1] - 0.5};
  const std::array<double, 2> way{(to[0] - from[0]) / d[0], (to[1] - from[1]) / d[1]};
  const auto steps = std::max<std::int64_t>(1, std::llround(std::ceil(std::max(std::abs(way[0]), std::abs(way[1])))));
  for (std::int64_t s = 0; s <= steps; ++s) {
    const double t = static_cast<double>(s) / static_cast<double>(steps);
    const std::int64_t i = wrapped(std::llround(at[0] + t * way[0]), mesh.nx);
    const std::int64_t j = wrapped(std::llround(at[1] + t * way[1]), mesh.ny);
    mesh.solid[static_cast<std::size_t>(j * mesh.nx + i)] = 1;
  }
}

std::span<const Sphere<2>> grains_of(const System<2>& system) {
  return {system.particles.sphere.data(), static_cast<std::size_t>(system.particles.grains)};
}

}  // namespace

std::int64_t smooth_number(std::int64_t count) {
  for (std::int64_t n = std::max<std::int64_t>(count, 2);; ++n) {
    std::int64_t rest = n;
    for (const std::int64_t prime : {2, 3, 5, 7})
      while (rest % prime == 0) rest /= prime;
    if (rest == 1) return n;
  }
}

PowderMesh powder_mesh(std::span<const Sphere<2>> disks, const Vec<2>& lengths, double per_length) {
  if (!(lengths[0] > 0.0) || !(lengths[1] > 0.0) || !(per_length > 0.0))
    throw InputError(fmt::format("powder mesh: lengths {} x {} and {} cells per length must be above 0", lengths[0],
                                 lengths[1], per_length));
  PowderMesh mesh;
  mesh.lengths = lengths;
  mesh.nx = smooth_number(static_cast<std::int64_t>(std::ceil(lengths[0] * per_length)));
  mesh.ny = smooth_number(static_cast<std::int64_t>(std::ceil(lengths[1] * per_length)));
  mesh.solid.assign(static_cast<std::size_t>(mesh.nx * mesh.ny), 0);
  for (const Sphere<2>& disk : disks) fill_disk(mesh, disk);
  return mesh;
}

PowderMesh powder_mesh(const System<2>& system, double per_length) {
  return powder_mesh(grains_of(system), {{system.cell.edges[0][0], system.cell.edges[1][1]}}, per_length);
}

void close_contacts(PowderMesh& mesh, std::span<const Sphere<2>> disks, std::span<const ContactRecord<2>> contacts) {
  for (const ContactRecord<2>& c : contacts) {
    const Vec<2>& centre = disks[static_cast<std::size_t>(c.i)].x;
    draw_line(mesh, centre, centre - c.branch);
  }
}

}  // namespace softgrain
