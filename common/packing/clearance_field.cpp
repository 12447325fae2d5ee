#include "common/packing/clearance_field.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

constexpr int kMostCells = 64;  ///< per axis

}  // namespace

ClearanceField::ClearanceField(const std::vector<PackedSphere>& spheres, const VoidDomain& domain, double reach)
    : domain_(domain), reach_(reach) {
  for (const PackedSphere& s : spheres) append(s);
  set_reach(reach);
}

Vec3 ClearanceField::home(Vec3 x) const {
  if (domain_.shape != VoidDomain::Shape::cell) return x;
  for (int k = 0; k < 3; ++k) {
    const double period = domain_.high[k] - domain_.low[k];
    x[k] -= period * std::floor((x[k] - domain_.low[k]) / period);
  }
  return x;
}

void ClearanceField::append(const PackedSphere& sphere) {
  if (domain_.shape == VoidDomain::Shape::cell)
    append_images({home(sphere.x), sphere.r}, sphere.r + reach_);
  else
    spheres_.push_back(sphere);
}

/// Appends the sphere and those of its images that come within `reach` of the cell; the one in the cell first.
void ClearanceField::append_images(const PackedSphere& sphere, double far) {
  const Vec3 period = domain_.high - domain_.low;
  spheres_.push_back(sphere);
  for (int image = 0; image < 27; ++image) {
    const int steps[] = {image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
    PackedSphere copy = sphere;
    bool near = image != 13;
    for (int k = 0; k < 3; ++k) {
      copy.x[k] += steps[k] * period[k];
      near = near && copy.x[k] > domain_.low[k] - far && copy.x[k] < domain_.high[k] + far;
    }
    if (near) spheres_.push_back(copy);
  }
}

void ClearanceField::set_reach(double reach) {
  reach_ = reach;
  std::size_t total = 1;
  for (int k = 0; k < 3; ++k) {
    const double wanted = 1.5 * (domain_.high[k] - domain_.low[k]) / reach;
    cells_[static_cast<std::size_t>(k)] = std::clamp(static_cast<int>(std::min(wanted, 1e6)), 1, kMostCells);
    total *= static_cast<std::size_t>(cells_[static_cast<std::size_t>(k)]);
  }
  log_lists_.assign(total, {});
  for (std::size_t s = 0; s < spheres_.size(); ++s) list(static_cast<std::int32_t>(s));
}

int ClearanceField::cell(double x, int axis) const {
  const int n = cells_[static_cast<std::size_t>(axis)];
  const double share = (x - domain_.low[axis]) / (domain_.high[axis] - domain_.low[axis]);
  return static_cast<int>(std::clamp(share * n, 0.0, n - 1.0));
}

/// Lists a sphere in every cell that comes within `reach` of its surface.
void ClearanceField::list(std::int32_t sphere) {
  const PackedSphere& s = spheres_[static_cast<std::size_t>(sphere)];
  const double far = s.r + reach_;
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  for (int k = 0; k < 3; ++k) {
    low[static_cast<std::size_t>(k)] = cell(s.x[k] - far, k);
    high[static_cast<std::size_t>(k)] = cell(s.x[k] + far, k);
  }
  for (int a = low[0]; a <= high[0]; ++a)
    for (int b = low[1]; b <= high[1]; ++b)
      for (int c = low[2]; c <= high[2]; ++c) log_lists_[index(a, b, c)].push_back(sphere);
}

void ClearanceField::add(const PackedSphere& sphere) {
  const std::size_t before = spheres_.size();
  append(sphere);
  for (std::size_t s = before; s < spheres_.size(); ++s) list(static_cast<std::int32_t>(s));
}

double ClearanceField::wall_clearance(const Vec3& x) const {
  if (domain_.shape == VoidDomain::Shape::cell) return reach_;
  if (domain_.shape == VoidDomain::Shape::sphere) return 1.0 - norm(x);
  double room = domain_.high[0] - x[0];
  for (int k = 0; k < 3; ++k) room = std::min({room, domain_.high[k] - x[k], x[k] - domain_.low[k]});
  return room;
}

double ClearanceField::clearance(const Vec3& place) const {
  const Vec3 x = home(place);
  double room = std::min(reach_, wall_clearance(x));
  for (const std::int32_t s : listed(x)) {
    const PackedSphere& sphere = spheres_[static_cast<std::size_t>(s)];
    const double far = sphere.r + room;
    const double distance2 = norm2(x - sphere.x);
    if (far > 0.0 && distance2 >= far * far) continue;
    room = std::min(room, std::sqrt(distance2) - sphere.r);
  }
  return room;
}

void ClearanceField::append_walls(const Vec3& x, double most, std::vector<NearSurface>& out) const {
  if (domain_.shape == VoidDomain::Shape::cell) return;
  if (domain_.shape == VoidDomain::Shape::sphere) {
    const double distance = norm(x);
    if (1.0 - distance <= most && distance > 0.0) out.push_back({1.0 - distance, x * (-1.0 / distance)});
    return;
  }
  for (int k = 0; k < 3; ++k) {
    Vec3 axis{};
    axis[k] = 1.0;
    if (x[k] - domain_.low[k] <= most) out.push_back({x[k] - domain_.low[k], axis});
    if (domain_.high[k] - x[k] <= most) out.push_back({domain_.high[k] - x[k], -axis});
  }
}

void ClearanceField::near(const Vec3& place, double most, std::vector<NearSurface>& out) const {
  const Vec3 x = home(place);
  out.clear();
  append_walls(x, most, out);
  for (const std::int32_t s : listed(x)) {
    const PackedSphere& sphere = spheres_[static_cast<std::size_t>(s)];
    const double far = sphere.r + most;
    const Vec3 away = x - sphere.x;
    const double distance2 = norm2(away);
    if (distance2 > far * far || distance2 <= 0.0) continue;
    const double distance = std::sqrt(distance2);
    out.push_back({distance - sphere.r, away * (1.0 / distance)});
  }
  // Stable: equal clearances keep the order of the surfaces, so that nothing depends on the sorting.
  std::stable_sort(out.begin(), out.end(),
                   [](const NearSurface& a, const NearSurface& b) { return a.clearance < b.clearance; });
}

}  // namespace softgrain
