#include "macrosim/placed_spheres.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

/// Never many more cells than spheres: small grains in a large box would ask for more.
std::int64_t cells_per_edge(double edge, double largest, std::size_t spheres) {
  const double wanted = edge / (2.0 * largest);
  const double affordable = std::cbrt(2.0 * static_cast<double>(spheres)) + 1.0;
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::min(wanted, affordable)));
}

}  // namespace

PlacedSpheres::PlacedSpheres(double edge, const std::vector<double>& radii, bool periodic)
    : edge_(edge), periodic_(periodic) {
  std::vector<double> sorted = radii;
  std::sort(sorted.rbegin(), sorted.rend());
  for (std::size_t k = 0; k < sorted.size();) {
    const double largest = sorted[k];
    const std::size_t begin = k;
    while (k < sorted.size() && sorted[k] > 0.5 * largest) ++k;
    Level level;
    level.largest = largest;
    level.cells = cells_per_edge(edge, largest, k - begin);
    level.cells_per_length = static_cast<double>(level.cells) / edge;
    level.first.assign(static_cast<std::size_t>(level.cells * level.cells * level.cells), -1);
    levels_.push_back(std::move(level));
  }
  spheres_.reserve(radii.size());
}

std::int64_t PlacedSpheres::cell_of(const Level& level, double coordinate) const {
  const auto cell = static_cast<std::int64_t>(std::floor(coordinate * level.cells_per_length));
  return std::clamp<std::int64_t>(cell, 0, level.cells - 1);
}

std::int32_t& PlacedSpheres::head(Level& level, const Vec3& x) const {
  const std::int64_t row = cell_of(level, x[0]) * level.cells + cell_of(level, x[1]);
  return level.first[static_cast<std::size_t>(row * level.cells + cell_of(level, x[2]))];
}

void PlacedSpheres::add(const Vec3& x, double r) {
  // The last level whose largest sphere is not smaller.
  std::size_t k = levels_.size() - 1;
  while (k > 0 && levels_[k].largest < r) --k;
  std::int32_t& first = head(levels_[k], x);
  spheres_.push_back({x, r, first});
  first = static_cast<std::int32_t>(spheres_.size()) - 1;
}

bool PlacedSpheres::collides(const Placed& first, const Vec3& x, double r) const {
  for (const Placed* s = &first;; s = &spheres_[static_cast<std::size_t>(s->next)]) {
    const double reach = s->r + r;
    if (norm2(s->x - x) < reach * reach) return true;
    if (s->next < 0) return false;
  }
}

bool PlacedSpheres::collides(const Level& level, const Vec3& x, double r) const {
  // A little farther than spheres reach: rounding must not decide which cells are looked at.
  const double reach = (level.largest + r) * (1.0 + 1e-9);
  std::array<std::int64_t, 3> low{};
  std::array<std::int64_t, 3> high{};
  for (int a = 0; a < 3; ++a) {
    low[static_cast<std::size_t>(a)] = cell_of(level, x[a] - reach);
    high[static_cast<std::size_t>(a)] = cell_of(level, x[a] + reach);
  }
  for (std::int64_t i = low[0]; i <= high[0]; ++i)
    for (std::int64_t j = low[1]; j <= high[1]; ++j)
      for (std::int64_t k = low[2]; k <= high[2]; ++k) {
        const std::int32_t s = level.first[static_cast<std::size_t>((i * level.cells + j) * level.cells + k)];
        if (s >= 0 && collides(spheres_[static_cast<std::size_t>(s)], x, r)) return true;
      }
  return false;
}

Vec3 PlacedSpheres::place_of(double r, RandomStream& random) const {
  Vec3 x;
  for (int a = 0; a < 3; ++a) x[a] = periodic_ ? random.uniform() * edge_ : r + random.uniform() * (edge_ - 2.0 * r);
  return x;
}

/// Spheres are kept once; what is near a face asks from all places where its images are.
bool PlacedSpheres::collides(const Vec3& x, double r) const {
  if (!periodic_) return collides_in_home(x, r);
  const double reach = r + levels_.front().largest;
  for (int image = 0; image < 27; ++image) {
    const int steps[] = {image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
    Vec3 y = x;
    bool near = true;
    for (int a = 0; a < 3; ++a) {
      y[a] += steps[a] * edge_;
      near = near && y[a] > -reach && y[a] < edge_ + reach;
    }
    if (near && collides_in_home(y, r)) return true;
  }
  return false;
}

bool PlacedSpheres::collides_in_home(const Vec3& x, double r) const {
  return std::any_of(levels_.begin(), levels_.end(), [&](const Level& level) { return collides(level, x, r); });
}

}  // namespace softgrain
