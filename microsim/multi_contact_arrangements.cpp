#include "microsim/multi_contact_arrangements.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/random.h"

namespace softgrain {

namespace {

constexpr Vec3 kX{{1.0, 0.0, 0.0}};
constexpr Vec3 kY{{0.0, 1.0, 0.0}};
constexpr Vec3 kZ{{0.0, 0.0, 1.0}};

std::vector<Vec3> cube_directions() {
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

/// Each direction is the one of some random ones that is farthest from all before it (Mitchell's best candidate).
std::vector<Vec3> spread_directions(RandomStream& random, std::size_t count, int candidates) {
  std::vector<Vec3> out;
  while (out.size() < count) {
    Vec3 best = random_direction(random);
    for (int k = 1; k < candidates; ++k) {
      const Vec3 v = random_direction(random);
      if (nearest(out, v) < nearest(out, best)) best = v;
    }
    out.push_back(best);
  }
  return out;
}

std::vector<Vec3> random_directions(std::size_t count) {
  constexpr std::uint64_t kSeed = 1;
  constexpr int kCandidates = 40;
  RandomStream random(kSeed, RandomPurpose::directions, 0);
  return spread_directions(random, count, kCandidates);
}

/// Whether a body among these cannot slip away: near every one of many directions there is one of them.
bool encloses(const std::vector<Vec3>& directions) {
  constexpr std::size_t kProbes = 400;
  constexpr double kNear = 0.17;  // cosine of 80 degrees
  static const std::vector<Vec3> probes = random_directions(kProbes);
  return std::all_of(probes.begin(), probes.end(), [&](const Vec3& v) { return nearest(directions, v) > kNear; });
}

/// Draws one neighbour. Neighbours are drawn in the order in which they are asked for. Each takes two random numbers,
/// so that what is drawn of one does not change the others.
MultiContactPartner draw_partner(const ScatterChoice& choice, RandomStream& random) {
  const double which = random.uniform();
  const double size = random.uniform();
  MultiContactPartner p;
  p.kind = choice.kind.value_or(which < 0.6   ? PartnerKind::solid
                                : which < 0.8 ? PartnerKind::plane
                                              : PartnerKind::soft);
  if (p.kind == PartnerKind::plane)
    p.smooth = choice.smooth;
  else
    p.ratio = choice.ratios[static_cast<std::size_t>(size * static_cast<double>(choice.ratios.size()))];
  return p;
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
    case Arrangement::scattered:
      return {};
    default:
      return cube_directions();
  }
}

std::vector<double> depth_shares(Arrangement arrangement, double shallow) {
  std::vector<double> shares(directions_of(arrangement).size(), 1.0);
  if (arrangement == Arrangement::beside_five) shares[0] = shallow;
  return shares;
}

std::vector<ScatteredNeighbour> scattered_neighbours(const ScatterChoice& choice) {
  constexpr int kCandidates = 8;
  RandomStream random(choice.draw, RandomPurpose::directions, 1);
  std::vector<Vec3> directions;
  do directions = spread_directions(random, static_cast<std::size_t>(choice.count), kCandidates);
  while (!encloses(directions));
  std::vector<ScatteredNeighbour> out;
  double deepest = 0.0;
  for (const Vec3& d : directions) {
    ScatteredNeighbour n{draw_partner(choice, random), choice.shallow + (1.0 - choice.shallow) * random.uniform()};
    n.partner.direction = d;
    deepest = std::max(deepest, n.share);
    out.push_back(n);
  }
  for (ScatteredNeighbour& n : out) n.share /= deepest;
  return out;
}

}  // namespace softgrain
