#include "common/packing/clearance_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softgrain {

namespace {

/// Shorter directions of ascent count as none: a maximum, as far as the present step can tell.
constexpr double kFlat = 0.03;

/// Shortest vector of the convex hull of the gradients (Gilbert's iteration): the direction of
/// steepest ascent of the smallest clearance, zero at a maximum.
Vec3 steepest(const std::vector<NearSurface>& surfaces) {
  constexpr int kMostRounds = 40;
  Vec3 d = surfaces[0].away;
  for (int round = 0; round < kMostRounds && norm2(d) > kFlat * kFlat; ++round) {
    std::size_t worst = 0;
    for (std::size_t k = 1; k < surfaces.size(); ++k)
      if (dot(d, surfaces[k].away) < dot(d, surfaces[worst].away)) worst = k;
    const Vec3 towards = surfaces[worst].away - d;
    const double gain = -dot(d, towards);
    if (gain <= 1e-3 * norm2(d) || gain <= 1e-8) break;
    d += towards * std::min(1.0, gain / norm2(towards));
  }
  return d;
}

/// Solves the symmetric N x N system a x = b by elimination with pivots; false when singular.
template <int N>
bool solve(std::array<std::array<double, N + 1>, N>& a, std::array<double, N>& x) {
  for (int c = 0; c < N; ++c) {
    int pivot = c;
    for (int r = c + 1; r < N; ++r)
      if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
    std::swap(a[c], a[pivot]);
    if (std::abs(a[c][c]) < 1e-10) return false;
    for (int r = c + 1; r < N; ++r) {
      const double f = a[r][c] / a[c][c];
      for (int k = c; k <= N; ++k) a[r][k] -= f * a[c][k];
    }
  }
  for (int c = N - 1; c >= 0; --c) {
    x[c] = a[c][N];
    for (int k = c + 1; k < N; ++k) x[c] -= a[c][k] * x[k];
    x[c] /= a[c][c];
  }
  return true;
}

/// One Newton step to the point of equal clearance from surfaces [0, n), least squares: g_k . dx - drho = rho - c_k.
bool newton_step(const std::vector<NearSurface>& surfaces, std::size_t n, Vec3& dx) {
  std::array<std::array<double, 5>, 4> a{};
  const double rho = surfaces[0].clearance;
  for (std::size_t s = 0; s < n; ++s) {
    const Vec3& g = surfaces[s].away;
    const std::array<double, 5> row{g[0], g[1], g[2], -1.0, rho - surfaces[s].clearance};
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c < 5; ++c) a[r][c] += row[r] * row[c];
  }
  std::array<double, 4> x{};
  if (!solve<4>(a, x)) return false;
  dx = {{x[0], x[1], x[2]}};
  return true;
}

/// Sharpens a maximum that is known to within `step`; keeps what was there when that does not raise it.
void polish(const ClearanceField& field, PackedSphere& hole, double step) {
  std::vector<NearSurface> surfaces;
  for (int round = 0; round < 6; ++round) {
    field.near(hole.x, hole.r + 3.0 * step, surfaces);
    Vec3 dx;
    if (surfaces.size() < 4 || !newton_step(surfaces, surfaces.size(), dx) || norm(dx) > 10.0 * step) return;
    const double room = field.clearance(hole.x + dx);
    if (room <= hole.r) return;
    hole = {hole.x + dx, room};
  }
}

/// Smallest move d with c_k + g_k . d = r for the surfaces [0, n), n <= 3: d = G^T (G G^T)^-1 (r - c).
bool move_to_touch(const std::vector<NearSurface>& surfaces, std::size_t n, double r, Vec3& d) {
  std::array<std::array<double, 4>, 3> a{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      a[i][j] = i < n && j < n ? dot(surfaces[i].away, surfaces[j].away) : (i == j ? 1.0 : 0.0);
    a[i][3] = i < n ? r - surfaces[i].clearance : 0.0;
  }
  std::array<double, 3> x{};
  if (!solve<3>(a, x)) return false;
  d = {};
  for (std::size_t i = 0; i < n; ++i) d += surfaces[i].away * x[i];
  return true;
}

/// Moves x to a place where the n nearest surfaces are touched and none is overlapped; false when there is none near.
bool touch(const ClearanceField& field, Vec3& x, double r, std::size_t n) {
  std::vector<NearSurface> surfaces;
  Vec3 y = x;
  for (int round = 0; round < 40; ++round) {
    field.near(y, field.reach(), surfaces);
    Vec3 d;
    if (surfaces.size() < n || !move_to_touch(surfaces, n, r, d)) return false;
    const double length = norm(d);
    if (length < 1e-14 * r) break;
    y += d * std::min(1.0, 0.3 * r / length);
  }
  field.near(y, field.reach(), surfaces);
  constexpr double kTouching = 1e-12;
  if (surfaces.size() < n || surfaces[n - 1].clearance > r * (1.0 + kTouching) ||
      surfaces[0].clearance < r * (1.0 - kTouching))
    return false;
  x = y;
  return true;
}

}  // namespace

PackedSphere climb(const ClearanceField& field, const Vec3& x) {
  PackedSphere hole{x, field.clearance(x)};
  std::vector<NearSurface> surfaces;
  double step = 0.5 * std::max(hole.r, 1e-3 * field.reach());
  for (int round = 0; round < 100 && step > 1e-4 * std::abs(hole.r) && hole.r < field.reach(); ++round) {
    field.near(hole.x, hole.r + step, surfaces);
    if (surfaces.empty()) break;
    const Vec3 d = steepest(surfaces);
    const double length = norm(d);
    if (length <= kFlat) {
      step *= 0.4;
      continue;
    }
    const Vec3 y = hole.x + d * (step / length);
    const double room = field.clearance(y);
    if (room > hole.r + 0.1 * step * length)
      hole = {y, room};
    else
      step *= 0.5;
  }
  if (hole.r > 0.0 && hole.r < field.reach()) polish(field, hole, step);
  return hole;
}

Vec3 settle(const ClearanceField& field, const Vec3& x, double r) {
  Vec3 best = x;
  // In the open, where no surface is near enough to be known: along -z, by steps that can meet nothing.
  // In a periodic cell there may be none at all.
  constexpr int kFarEnough = 10000;
  for (int k = 0; k < kFarEnough && field.clearance(best) >= field.reach() && r < field.reach(); ++k)
    best[2] -= field.reach() - r;
  for (std::size_t n = 1; n <= 3; ++n)
    if (!touch(field, best, r, n)) break;
  return best;
}

}  // namespace softgrain
