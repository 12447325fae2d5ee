// The density field of disks in a periodic rectangle: 1 in a disk, 0 in the void, on a fine mesh [CP 3.5].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/data/scattering_curve.h"
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

// The intensity that a density field scatters, by a fast Fourier transform [CP 3.5].

/// Edges of bins of k: the first at k_first/2, each bin as wide as k_first or as `growth` times its lower edge, the
/// larger; the last edge is the first one at or beyond k_last. k_first: 2 pi over the longest period, so that every
/// bin holds modes. Throws InputError unless 0 < k_first < k_last and growth > 0.
std::vector<double> scattering_bins(double k_first, double k_last, double growth = 0.05);

/// I(k) = |chi_hat(k)|^2/A with chi_hat(k) = sum chi exp(-i k r) dx dy, averaged over the directions of the modes
/// k = 2 pi (p/L_x, q/L_y) in each bin [edge_n, edge_n+1); k = 0 is left out, empty bins too. Bitwise the same at every
/// call; may be called by several threads. Memory: 8 bytes per cell. Throws UnusableResult when there is not enough.
ScatteringCurve powder_scattering(const PowderMesh& mesh, std::span<const double> edges);

}  // namespace softgrain
