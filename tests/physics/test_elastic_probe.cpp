// The elastic probe against closed forms: lattices that a box of smooth or rough planes holds as they are, so that the
// linearised answer is a handful of springs. A rigid plane is the mirror image of the sphere that presses on it: with
// the overlap h/2 it carries the force of two equal spheres at h, and is twice as stiff.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "tests/support/grain_packs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kRadius = 1e-3;
constexpr double kModulus = 70e9;
constexpr double kPoisson = 0.2;
constexpr double kStuck = std::numeric_limits<double>::infinity();

/// dP/dh = 2 E* sqrt(R* h) of two equal spheres: E* = E/(2 (1 - nu^2)), R* = R/2.
double normal_stiffness(double overlap) {
  return kModulus / (1.0 - kPoisson * kPoisson) * std::sqrt(0.5 * kRadius * overlap);
}

/// 8 a/[(2 - nu)/G + (2 - nu)/G], a = sqrt(R* h), G = E/(2 (1 + nu)).
double tangential_stiffness(double overlap) {
  return 2.0 * kModulus / ((1.0 + kPoisson) * (2.0 - kPoisson)) * std::sqrt(0.5 * kRadius * overlap);
}

/// 16/3 a^3/(1/G + 1/G).
double torsional_stiffness(double overlap) {
  const double a = std::sqrt(0.5 * kRadius * overlap);
  return 4.0 / 3.0 * kModulus / (1.0 + kPoisson) * a * a * a;
}

ElasticResponse probed(GrainPack pack, double friction, double wall_friction, bool torsion = true) {
  refresh_contacts(pack);
  pack.friction = friction;
  for (PackWall& w : pack.walls) w.friction = wall_friction;
  LeastWorkOptions options;
  options.torsion = torsion;
  const ElasticResponse out = elastic_probe(pack, options);
  EXPECT_TRUE(out.solved);
  return out;
}

/// C11 on the diagonal, C12 beside it, and K and G as they follow, to the reduction of the linear solver.
void expect_cubic(const ElasticResponse& r, double c11, double c12) {
  constexpr double kNear = 1e-8;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) EXPECT_NEAR(r.stiffness[a][b] / c11, a == b ? 1.0 : c12 / c11, kNear) << a << b;
  EXPECT_NEAR(r.bulk_modulus() / ((c11 + 2.0 * c12) / 3.0), 1.0, kNear);
  EXPECT_NEAR(r.shear_modulus() / (0.5 * (c11 - c12)), 1.0, kNear);
}

/// n^3 spheres whose neighbours, planes included, are l = 2 R - h apart.
GrainPack simple_cubic(int n, double overlap) {
  GrainPack pack;
  const double l = 2.0 * kRadius - overlap;
  for (int k = 0; k < n * n * n; ++k)
    add_grain(pack, Vec3{{k % n + 0.5, k / n % n + 0.5, k / (n * n) + 0.5}} * l, kRadius, kModulus, kPoisson);
  add_box(pack, Vec3{{1.0, 1.0, 1.0}} * (n * l), 0.0);
  return pack;
}

/// One spring per area l^2 along each axis, of length l: C11 = k/l, nothing across, K = k/(3 l), (C11 - C12)/2 = k/(2
/// l). Nothing slides, so that friction between grains changes nothing.
TEST(ElasticProbe, SimpleCubic) {
  for (const double overlap : {1e-3 * kRadius, 0.05 * kRadius})
    for (const double friction : {0.0, 0.3, kStuck}) {
      const double c11 = normal_stiffness(overlap) / (2.0 * kRadius - overlap);
      expect_cubic(probed(simple_cubic(3, overlap), friction, 0.0), c11, 0.0);
    }
}

/// The sphere stays in the middle while two planes move: rough ones have nothing to hold.
TEST(ElasticProbe, OneSphereBetweenRoughPlanes) {
  const double overlap = 0.01 * kRadius;
  const double c11 = normal_stiffness(overlap) / (2.0 * kRadius - overlap);
  expect_cubic(probed(simple_cubic(1, overlap), 0.0, kStuck), c11, 0.0);
}

/// Four spheres in alternate corners of a cube, each against three planes and the three others: repeated by reflection,
/// a cubic lattice with springs along the axes and along the face diagonals. The planes press with sqrt(2) times the
/// force of a pair, which is equilibrium.
struct Tetrahedron {
  double overlap;       ///< of the pairs
  double wall_overlap;  ///< of a sphere and its mirror image
  double place;         ///< of the first sphere, from its three planes
  double length;        ///< of the box

  explicit Tetrahedron(double h)
      : overlap(h),
        wall_overlap(std::cbrt(2.0) * h),
        place(kRadius - 0.5 * wall_overlap),
        length(2.0 * place + (2.0 * kRadius - h) / std::sqrt(2.0)) {}

  [[nodiscard]] GrainPack pack() const {
    GrainPack out;
    const double p = place;
    const double q = length - place;
    for (const Vec3& x : {Vec3{{p, p, p}}, Vec3{{q, q, p}}, Vec3{{q, p, q}}, Vec3{{p, q, q}}})
      add_grain(out, x, kRadius, kModulus, kPoisson);
    add_box(out, Vec3{{1.0, 1.0, 1.0}} * length, 0.0);
    return out;
  }
};

struct CubicModuli {
  double c11;
  double c12;
};

/// Springs of contacts across their normals.
struct Tangential {
  double slide = 0.0;  ///< of pairs [N/m]
  double twist = 0.0;  ///< about the normal [N m]
  double wall_slide = 0.0;
  double wall_twist = 0.0;
};

/// Strain e along z. By the twofold axes and the mirror planes of the strained cluster the first sphere moves by
/// (u, u, w) and turns by (omega, -omega, 0); the others follow by symmetry. With k, t of a pair (arm b to the contact)
/// and W, q of a plane (arm c), the first sphere and its neighbour across x and z slide by s (1, 0, -1),
/// s = u - w - sqrt(2) b omega, and twist by sqrt(2) omega; over the planes across x, y and z it slides by
/// (0, u, w - c omega), (u, 0, w - c omega) and (u + c omega, u + c omega, 0). Its moment vanishes:
///   sqrt(2) b t s + c q [(w - c omega) - (u + c omega)] - (twist + wall twist) omega = 0, so omega = phi (u - w),
///   phi = (sqrt(2) b t - c q)/(2 b^2 t + 2 c^2 q + twist + wall twist).
/// With g = t (1 - sqrt(2) b phi) + q c phi its forces vanish:
///   along x: (W + 3 k + 2 q + g) u + (k - g) w = 0,
///   along z: (W + 2 k + 2 q + 2 g) w + 2 (k - g) u = W e L/2.
/// Two spheres press on each plane: C11 = 2 W (e L/2 - w)/(e L^2), C12 = -2 W u/(e L^2). Where nothing but t holds the
/// spheres they roll on each other (s = g = 0).
CubicModuli closed_form(const Tetrahedron& cell, const Tangential& across) {
  const double k = normal_stiffness(cell.overlap);
  const double wall = 2.0 * normal_stiffness(cell.wall_overlap);
  const double b = kRadius - 0.5 * cell.overlap;
  const double c = cell.place;
  const auto [t, twist, q, wall_twist] = across;
  const double holds = 2.0 * (b * b * t + c * c * q) + twist + wall_twist;
  const double phi = holds > 0.0 ? (std::sqrt(2.0) * b * t - c * q) / holds : 0.0;
  const double g = t * (1.0 - std::sqrt(2.0) * b * phi) + q * c * phi;
  const double ratio = (k - g) / (wall + 3.0 * k + 2.0 * q + g);  // -u/w
  const double half = 0.5 * cell.length;                          // e = 1
  const double w = wall * half / (wall + 2.0 * k + 2.0 * q + 2.0 * g - 2.0 * (k - g) * ratio);
  const double area = cell.length * cell.length;
  return {2.0 * wall * (half - w) / area, 2.0 * wall * ratio * w / area};
}

/// A sphere on a rigid plane has the contact radius of two spheres at its mirrored overlap, and its own compliance
/// only.
Tangential springs(const Tetrahedron& cell, bool grains, bool walls, bool torsion) {
  Tangential out;
  if (grains) out.slide = tangential_stiffness(cell.overlap);
  if (grains && torsion) out.twist = torsional_stiffness(cell.overlap);
  if (walls) out.wall_slide = 2.0 * tangential_stiffness(cell.wall_overlap);
  if (walls && torsion) out.wall_twist = 2.0 * torsional_stiffness(cell.wall_overlap);
  return out;
}

TEST(ElasticProbe, TetrahedraWithoutFriction) {
  for (const double overlap : {1e-3 * kRadius, 0.05 * kRadius}) {
    const Tetrahedron cell(overlap);
    const CubicModuli expected = closed_form(cell, {});
    EXPECT_GT(expected.c12, 0.1 * expected.c11);
    expect_cubic(probed(cell.pack(), 0.0, 0.0), expected.c11, expected.c12);
    // Grains that may roll on each other carry nothing across.
    expect_cubic(probed(cell.pack(), kStuck, 0.0, false), expected.c11, expected.c12);
  }
}

TEST(ElasticProbe, TetrahedraWithTangentialStiffness) {
  for (const double overlap : {1e-3 * kRadius, 0.05 * kRadius}) {
    const Tetrahedron cell(overlap);
    for (const bool torsion : {false, true})
      for (const bool grains : {false, true})
        for (const bool walls : {false, true}) {
          const CubicModuli expected = closed_form(cell, springs(cell, grains, walls, torsion));
          SCOPED_TRACE(::testing::Message()
                       << overlap << " torsion " << torsion << " grains " << grains << " walls " << walls);
          expect_cubic(probed(cell.pack(), grains ? kStuck : 0.0, walls ? kStuck : 0.0, torsion), expected.c11,
                       expected.c12);
        }
    const double rough = closed_form(cell, springs(cell, true, true, false)).c12;
    EXPECT_GT(std::abs(rough / closed_form(cell, springs(cell, false, true, false)).c12 - 1.0), 0.02)
        << "or the springs between grains decide nothing";
  }
}

/// The probe takes contacts as stuck, whatever the limit; only a limit of zero means that there is no spring.
TEST(ElasticProbe, TheLimitOfFrictionDoesNotMatter) {
  const Tetrahedron cell(0.01 * kRadius);
  const ElasticResponse weak = probed(cell.pack(), 0.01, 0.01);
  const ElasticResponse strong = probed(cell.pack(), kStuck, kStuck);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) EXPECT_NEAR(weak.stiffness[a][b] / strong.stiffness[a][b], 1.0, 1e-8);
}

TEST(ElasticProbe, TheTetrahedronIsInEquilibrium) {
  GrainPack pack = Tetrahedron(0.01 * kRadius).pack();
  refresh_contacts(pack);
  ASSERT_EQ(pack.contacts.size(), 6U + 12U);
  std::vector<Vec3> net(4);
  double largest = 0.0;
  for (const PackContact& c : pack.contacts) {
    net[static_cast<std::size_t>(c.i)] += c.normal * c.normal_force;
    if (c.j < 4) net[static_cast<std::size_t>(c.j)] -= c.normal * c.normal_force;
    largest = std::max(largest, c.normal_force);
  }
  for (const Vec3& f : net) EXPECT_LT(norm(f), 1e-10 * largest);
}

TEST(ElasticProbe, RefusesWhatIsNoBox) {
  GrainPack pack = simple_cubic(1, 1e-5);
  refresh_contacts(pack);
  pack.walls.pop_back();
  EXPECT_THROW(elastic_probe(pack, {}), InputError);
}

}  // namespace
