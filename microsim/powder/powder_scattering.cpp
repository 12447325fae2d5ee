#include "microsim/powder/powder_mesh.h"

#include <fftw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// FFTW's planner keeps global tables; only the execution of a plan is free of locks.
std::mutex& planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

struct FreeFftw {
  void operator()(double* memory) const { fftw_free(memory); }
};
using Field = std::unique_ptr<double[], FreeFftw>;

/// Complex numbers per row of a half spectrum.
std::int64_t half_row(const PowderMesh& mesh) { return mesh.nx / 2 + 1; }

/// sum chi exp(-i k r) in place: ny rows of half_row complex numbers.
Field transform(const PowderMesh& mesh) {
  const std::int64_t stride = 2 * half_row(mesh);
  Field field(fftw_alloc_real(static_cast<std::size_t>(mesh.ny * stride)));
  if (!field) throw UnusableResult(fmt::format("powder: no memory for a mesh of {} x {} cells", mesh.nx, mesh.ny));
  // FFTW_ESTIMATE: no timing trials, so that the same transform runs everywhere; it leaves the field as it is.
  fftw_plan plan = nullptr;
  {
    const std::lock_guard<std::mutex> lock(planner_mutex());
    plan = fftw_plan_dft_r2c_2d(static_cast<int>(mesh.ny), static_cast<int>(mesh.nx), field.get(),
                                reinterpret_cast<fftw_complex*>(field.get()), FFTW_ESTIMATE);
  }
  if (plan == nullptr) throw UnusableResult(fmt::format("powder: no transform of {} x {} cells", mesh.nx, mesh.ny));
  for (std::int64_t j = 0; j < mesh.ny; ++j) {
    const std::uint8_t* row = mesh.solid.data() + j * mesh.nx;
    std::copy(row, row + mesh.nx, field.get() + j * stride);
  }
  fftw_execute(plan);
  const std::lock_guard<std::mutex> lock(planner_mutex());
  fftw_destroy_plan(plan);
  return field;
}

/// Sums over the modes of each bin; those that stand for themselves and their opposite count twice.
struct BinSums {
  std::vector<double> count;
  std::vector<double> k;
  std::vector<double> square;

  explicit BinSums(std::size_t bins) : count(bins), k(bins), square(bins) {}
  void add(std::size_t bin, double weight, double wave_number, double power) {
    count[bin] += weight;
    k[bin] += weight * wave_number;
    square[bin] += weight * power;
  }
};

BinSums sum_modes(const PowderMesh& mesh, const double* field, std::span<const double> edges) {
  BinSums sums(edges.size() - 1);
  const Vec<2> unit{{2.0 * std::numbers::pi / mesh.lengths[0], 2.0 * std::numbers::pi / mesh.lengths[1]}};
  const std::int64_t columns = half_row(mesh);
  for (std::int64_t j = 0; j < mesh.ny; ++j) {
    const double ky = unit[1] * static_cast<double>(2 * j <= mesh.ny ? j : j - mesh.ny);
    const double* row = field + 2 * j * columns;
    for (std::int64_t i = j == 0 ? 1 : 0; i < columns; ++i) {
      const double kx = unit[0] * static_cast<double>(i);
      const double k = std::sqrt(kx * kx + ky * ky);
      if (k >= edges.back()) break;
      if (k < edges.front()) continue;
      const auto bin = static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), k) - edges.begin() - 1);
      const bool own_opposite = i == 0 || 2 * i == mesh.nx;
      sums.add(bin, own_opposite ? 1.0 : 2.0, k, row[2 * i] * row[2 * i] + row[2 * i + 1] * row[2 * i + 1]);
    }
  }
  return sums;
}

}  // namespace

std::vector<double> scattering_bins(double k_first, double k_last, double growth) {
  if (!(k_first > 0.0) || !(k_last > k_first) || !(growth > 0.0))
    throw InputError(fmt::format("scattering: bins from {} to {}, growing by {}: must rise and be above 0", k_first,
                                 k_last, growth));
  std::vector<double> edges{0.5 * k_first};
  while (edges.back() < k_last) edges.push_back(edges.back() + std::max(k_first, growth * edges.back()));
  return edges;
}

ScatteringCurve powder_scattering(const PowderMesh& mesh, std::span<const double> edges) {
  const Field field = transform(mesh);
  const BinSums sums = sum_modes(mesh, field.get(), edges);
  const Vec<2> d = mesh.spacing();
  const double cell = d[0] * d[1];
  const double scale = cell * cell / (mesh.lengths[0] * mesh.lengths[1]);
  ScatteringCurve out;
  for (std::size_t bin = 0; bin < sums.count.size(); ++bin) {
    if (sums.count[bin] == 0.0) continue;
    out.k.push_back(sums.k[bin] / sums.count[bin]);
    out.intensity.push_back(scale * sums.square[bin] / sums.count[bin]);
    out.modes.push_back(0.5 * sums.count[bin]);
  }
  return out;
}

}  // namespace softgrain
