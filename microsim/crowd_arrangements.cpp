#include "microsim/crowd_arrangements.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/random.h"

namespace softgrain {

namespace {

constexpr Vec3 kX{{1.0, 0.0, 0.0}};
constexpr Vec3 kY{{0.0, 1.0, 0.0}};
constexpr Vec3 kZ{{0.0, 0.0, 1.0}};

std::vector<Vec3> cube() {
  return {kX, Vec3{{-1.0, 0.0, 0.0}}, kY, Vec3{{0.0, -1.0, 0.0}}, kZ, Vec3{{0.0, 0.0, -1.0}}};
}

std::vector<Vec3> tetrahedron() {
  const double s = 1.0 / std::sqrt(3.0);
  return {Vec3{{s, s, s}}, Vec3{{s, -s, -s}}, Vec3{{-s, s, -s}}, Vec3{{-s, -s, s}}};
}

/// Cyclic permutations of (0, +-1, +-golden ratio).
std::vector<Vec3> icosahedron() {
  const double length = std::sqrt(1.0 + std::numbers::phi * std::numbers::phi);
  const double a = 1.0 / length;
  const double b = std::numbers::phi / length;
  std::vector<Vec3> out;
  for (const double s : {a, -a})
    for (const double t : {b, -b}) {
      out.push_back({{0.0, s, t}});
      out.push_back({{s, t, 0.0}});
      out.push_back({{t, 0.0, s}});
    }
  return out;
}

/// Uniform on the sphere: height and longitude.
Vec3 random_direction(RandomStream& random) {
  const double z = 2.0 * random.uniform() - 1.0;
  const double turn = 2.0 * std::numbers::pi * random.uniform();
  const double r = std::sqrt(1.0 - z * z);
  const Vec3 v{{r * std::cos(turn), r * std::sin(turn), z}};
  return v * (1.0 / norm(v));
}

/// Cosine of the angle to the nearest of `all`.
double nearest(const std::vector<Vec3>& all, const Vec3& v) {
  double largest = -1.0;
  for (const Vec3& u : all) largest = std::max(largest, dot(u, v));
  return largest;
}

/// Each direction is the one of many random ones that is farthest from all before it (Mitchell's best candidate).
std::vector<Vec3> random_directions(int count) {
  constexpr std::uint64_t kSeed = 1;
  constexpr int kCandidates = 40;
  RandomStream random(kSeed, RandomPurpose::directions, 0);
  std::vector<Vec3> out;
  while (static_cast<int>(out.size()) < count) {
    Vec3 best = random_direction(random);
    for (int k = 1; k < kCandidates; ++k) {
      const Vec3 v = random_direction(random);
      if (nearest(out, v) < nearest(out, best)) best = v;
    }
    out.push_back(best);
  }
  return out;
}

}  // namespace

std::vector<Vec3> directions_of(Arrangement arrangement) {
  switch (arrangement) {
    case Arrangement::one:
      return {kX};
    case Arrangement::opposite:
      return {kX, Vec3{{-1.0, 0.0, 0.0}}};
    case Arrangement::orthogonal:
      return {kX, kY};
    case Arrangement::sixty:
      return {kX, Vec3{{0.5, std::sqrt(0.75), 0.0}}};
    case Arrangement::octant:
      return {kX, kY, kZ};
    case Arrangement::tetrahedron:
      return tetrahedron();
    case Arrangement::icosahedron:
      return icosahedron();
    case Arrangement::random_8:
      return random_directions(8);
    default:
      return cube();
  }
}

std::vector<double> depth_shares(Arrangement arrangement, double shallow) {
  std::vector<double> shares(directions_of(arrangement).size(), 1.0);
  if (arrangement == Arrangement::beside_five) shares[0] = shallow;
  return shares;
}

}  // namespace softgrain
