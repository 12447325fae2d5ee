// The intensity that a density field scatters, by a fast Fourier transform [CP 3.5].
#pragma once

#include <span>
#include <vector>

#include "common/data/scattering_curve.h"
#include "microsim/powder/powder_mesh.h"

namespace softgrain {

/// Edges of bins of k: the first at k_first/2, each bin as wide as k_first or as `growth` times its lower edge, the
/// larger; the last edge is the first one at or beyond k_last. k_first: 2 pi over the longest period, so that every
/// bin holds modes. Throws InputError unless 0 < k_first < k_last and growth > 0.
std::vector<double> scattering_bins(double k_first, double k_last, double growth = 0.05);

/// I(k) = |chi_hat(k)|^2/A with chi_hat(k) = sum chi exp(-i k r) dx dy, averaged over the directions of the modes
/// k = 2 pi (p/L_x, q/L_y) in each bin [edge_n, edge_n+1); k = 0 is left out, empty bins too. Bitwise the same at every
/// call; may be called by several threads. Memory: 8 bytes per cell. Throws UnusableResult when there is not enough.
ScatteringCurve powder_scattering(const PowderMesh& mesh, std::span<const double> edges);

}  // namespace softgrain
