// The density field of disks in a periodic rectangle: 1 in a disk, 0 in the void, on a fine mesh [CP 3.5].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/dynamics/force_pass.h"
#include "common/system.h"

namespace softgrain {

/// chi at the centres of nx x ny equal cells, row after row along x.
struct PowderMesh {
  std::int64_t nx = 0;
  std::int64_t ny = 0;
  Vec<2> lengths{};                 ///< lengths of the period [a]
  std::vector<std::uint8_t> solid;  ///< ny rows of nx

  [[nodiscard]] Vec<2> spacing() const {
    return {{lengths[0] / static_cast<double>(nx), lengths[1] / static_cast<double>(ny)}};
  }
};

/// Smallest number at or above `count` (at least 2) without prime factors beyond 7: lengths that an FFT is fast on.
std::int64_t smooth_number(std::int64_t count);

/// A cell is solid when its centre lies in a disk. At least `per_length` cells per unit of length (a few percent more:
/// smooth_number); `lengths`: of the period. Throws InputError for lengths or a fineness that are not positive.
PowderMesh powder_mesh(std::span<const Sphere<2>> disks, const Vec<2>& lengths, double per_length = 100.0);

/// Mesh of the grains of a system with a rectangular periodic cell.
PowderMesh powder_mesh(const System<2>& system, double per_length = 100.0);

/// Makes every interaction a closed wall: the cells on the line between both centres become solid. The line is
/// 8-connected, so no void path of 4-connected cells crosses it. Without it the mesh leaks now and then through a
/// contact that lies along a row of cells, and through the gaps of distant pairs (at most D0 = 1e-3 a, a tenth of a
/// cell), which count as closed.
void close_contacts(PowderMesh& mesh, std::span<const Sphere<2>> disks, std::span<const ContactRecord<2>> contacts);

}  // namespace softgrain
