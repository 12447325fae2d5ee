// Body- and face-centred cubic lattices between symmetry planes through grain centres: self-similar and uniaxial
// deformation against the closed form, in positions, contact forces and wall forces [QS 2.2].
#include <gtest/gtest.h>

#include <iostream>

#include "common/core/error.h"
#include "tests/support/grain_packs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kRadiusOfGrains = 1e-3;
constexpr double kModulusOfGrains = 70e9;
constexpr double kPoissonOfGrains = 0.2;

enum class Lattice { body_centred, face_centred };

bool is_site(Lattice lattice, int i, int j, int k) {
  return lattice == Lattice::face_centred ? (i + j + k) % 2 == 0 : i % 2 == j % 2 && j % 2 == k % 2;
}

/// Half a cell edge of spheres whose next neighbours just touch.
double touching(Lattice lattice) {
  return 2.0 * kRadiusOfGrains / std::sqrt(lattice == Lattice::face_centred ? 2.0 : 3.0);
}

/// cells^3 cells with half edge `half`, all outer grains on symmetry planes.
GrainPack make_lattice(Lattice lattice, int cells, double half) {
  GrainPack pack;
  const int end = 2 * cells;
  for (int i = 0; i <= end; ++i)
    for (int j = 0; j <= end; ++j)
      for (int k = 0; k <= end; ++k)
        if (is_site(lattice, i, j, k))
          add_grain(pack, Vec3{{half * i, half * j, half * k}}, kRadiusOfGrains, kModulusOfGrains, kPoissonOfGrains);
  add_box(pack, Vec3{{1.0, 1.0, 1.0}} * (end * half), 0.0);
  for (PackWall& w : pack.walls) w.symmetry = true;
  refresh_contacts(pack);
  return pack;
}

/// Displaces every grain as far as its planes let it.
void shake(GrainPack& pack, double size) {
  RandomStream random(3, RandomPurpose::test, 0);
  for (Vec3& x : pack.position)
    for (int a = 0; a < 3; ++a) {
      const double by = size * kRadiusOfGrains * (random.uniform() - 0.5);
      const double width = pack.walls[1].point[0];
      if (x[a] > 1e-6 * width && x[a] < (1.0 - 1e-6) * width) x[a] += by;
    }
  refresh_contacts(pack);
}

/// The deformation that an even strain about the centre of the box makes of `from`.
std::vector<Vec3> deformed(const std::vector<Vec3>& from, double width, const Vec3& strain) {
  std::vector<Vec3> out = from;
  for (Vec3& x : out)
    for (int a = 0; a < 3; ++a) x[a] -= strain[a] * (x[a] - 0.5 * width);
  return out;
}

double hertz(double distance) {
  const double modulus = kModulusOfGrains / (2.0 * (1.0 - kPoissonOfGrains * kPoissonOfGrains));
  const double h = 2.0 * kRadiusOfGrains - distance;
  return h > 0.0 ? 4.0 / 3.0 * modulus * std::sqrt(0.5 * kRadiusOfGrains) * std::pow(h, 1.5) : 0.0;
}

/// -k* u_s of a pair that never slides, k* of its distance before [QS 2.1].
Vec3 sticking(const Vec3& before, const Vec3& after) {
  const double shear = kModulusOfGrains / (2.0 * (1.0 + kPoissonOfGrains));
  const double radius = std::sqrt(0.5 * kRadiusOfGrains * (2.0 * kRadiusOfGrains - norm(before)));
  const Vec3 n = after * (1.0 / norm(after));
  const Vec3 moved = after - before;
  return (moved - n * dot(n, moved)) * (-4.0 * shear * radius / (2.0 - kPoissonOfGrains));
}

/// Largest relative error of positions (in R), contact forces (in the largest), and wall forces.
struct Errors {
  double position = 0.0;
  double contact = 0.0;
  double wall = 0.0;
};

/// Force on grain i of a contact after the even deformation; `stick`: pairs also carry -k* u_s. A rigid plane is the
/// mirror of a grain that is not centred on it.
Vec3 closed_form(const PackContact& c, const GrainPack& pack, const std::vector<Vec3>& before,
                 const std::vector<Vec3>& after, bool stick) {
  const auto i = static_cast<std::size_t>(c.i);
  const auto j = static_cast<std::size_t>(c.j);
  if (c.j >= pack.grains()) {
    const PackWall& wall = pack.walls[j - after.size()];
    return wall.normal * hertz(2.0 * dot(after[i] - wall.point, wall.normal));
  }
  const Vec3 r = after[i] - after[j];
  const Vec3 force = r * (hertz(norm(r)) / norm(r));
  return stick ? force + sticking(before[i] - before[j], r) : force;
}

/// What a contact presses on a wall with: as its partner, or through a grain that the plane holds.
double pressed(const PackContact& c, const Vec3& force, const GrainPack& pack, std::size_t w) {
  const PackWall& wall = pack.walls[w];
  const auto held = [&](std::int32_t g) {
    return g < pack.grains() &&
           std::abs(dot(pack.position[static_cast<std::size_t>(g)] - wall.point, wall.normal)) < 1e-6 * kRadiusOfGrains;
  };
  const double along = dot(force, wall.normal);
  const bool partner = c.j == pack.grains() + static_cast<std::int32_t>(w);
  return (held(c.i) ? along : 0.0) - (partner || held(c.j) ? along : 0.0);
}

Errors compare(const GrainPack& pack, const std::vector<Vec3>& before, const std::vector<Vec3>& after, bool stick) {
  Errors out;
  for (std::size_t g = 0; g < after.size(); ++g)
    out.position = std::max(out.position, norm(pack.position[g] - after[g]) / kRadiusOfGrains);
  std::vector<double> on_wall(6, 0.0);
  double largest = 0.0;
  for (const PackContact& c : pack.contacts) {
    const Vec3 expected = closed_form(c, pack, before, after, stick);
    largest = std::max(largest, norm(expected));
    out.contact = std::max(out.contact, norm(c.normal * c.normal_force + c.tangential_force - expected));
    for (std::size_t w = 0; w < 6; ++w) on_wall[w] += pressed(c, expected, pack, w);
  }
  out.contact /= largest;
  const std::vector<Vec3> walls = wall_forces(pack);
  for (std::size_t w = 0; w < 6; ++w)
    out.wall = std::max(out.wall, std::abs(dot(walls[w], pack.walls[w].normal) / on_wall[w] - 1.0));
  return out;
}

struct Case {
  Lattice lattice = Lattice::face_centred;
  int cells = 3;
  double before = 0.0;  ///< isotropic strain of the starting lattice
  Vec3 strain{};
  double friction = 0.0;
  double shake = 0.0;
  LeastWorkMethod method = LeastWorkMethod::fast;
};

void expect_closed_form(const Case& c, std::size_t contacts, double tolerance) {
  GrainPack pack = make_lattice(c.lattice, c.cells, touching(c.lattice) * (1.0 - c.before));
  pack.friction = c.friction;
  const std::vector<Vec3> before = pack.position;
  const std::vector<Vec3> after = deformed(before, pack.walls[1].point[0], c.strain);
  if (c.shake > 0.0) shake(pack, c.shake);
  LeastWorkOptions options;
  options.method = c.method;
  options.residual_tolerance = 3e-13;  // rounding of the positions over the overlap
  options.work_tolerance = 0.0;
  options.force_tolerance = 1e-29;
  const LeastWorkResult r = advance(pack, squeeze(pack, c.strain), options);
  ASSERT_TRUE(r.converged) << to_string(r.stopped_by) << " " << r.worst_residual;
  EXPECT_EQ(pack.contacts.size(), contacts);
  const Errors errors = compare(pack, before, after, c.friction > 0.0 && c.before > 0.0);
  std::cout << "iterations " << r.iterations << ", relative errors: positions " << errors.position
            << ", contact forces " << errors.contact << ", wall forces " << errors.wall << "\n";
  EXPECT_LT(errors.position, tolerance);
  EXPECT_LT(errors.contact, tolerance);
  EXPECT_LT(errors.wall, tolerance);
}

constexpr Vec3 kIsotropic{{0.02, 0.02, 0.02}};
constexpr Vec3 kUniaxial{{0.0, 0.0, 0.02}};
/// Pairs of neighbours in 3^3 cells.
constexpr std::size_t kFacePairs = 756;
constexpr std::size_t kBodyPairs = 216;
constexpr std::size_t kBodySecondPairs = 198 + 6 * 9;  // with planes as mirrors

TEST(LeastWorkSymmetry, FaceCentredIsotropic) {
  expect_closed_form({.strain = kIsotropic, .shake = 1e-3}, kFacePairs, 1e-12);
  expect_closed_form({.strain = kIsotropic, .shake = 1e-4, .method = LeastWorkMethod::published}, kFacePairs, 1e-11);
}

TEST(LeastWorkSymmetry, FaceCentredUniaxial) {
  expect_closed_form({.before = 0.02, .strain = kUniaxial, .shake = 1e-3}, kFacePairs, 1e-12);
  const double stuck = std::numeric_limits<double>::infinity();
  expect_closed_form({.before = 0.02, .strain = kUniaxial, .friction = stuck}, kFacePairs, 1e-12);
}

TEST(LeastWorkSymmetry, BodyCentredIsotropic) {
  // Next neighbours alone leave the lattice without shear stiffness: one cell, or friction, or second neighbours too.
  expect_closed_form({.lattice = Lattice::body_centred, .cells = 1, .strain = kIsotropic, .shake = 1e-3}, 8, 1e-12);
  expect_closed_form({.lattice = Lattice::body_centred, .strain = kIsotropic, .friction = 0.3}, kBodyPairs, 1e-12);
  const Case both{.lattice = Lattice::body_centred, .before = 0.2, .strain = kIsotropic, .shake = 1e-3};
  expect_closed_form(both, kBodyPairs + kBodySecondPairs, 1e-12);
}

TEST(LeastWorkSymmetry, BodyCentredUniaxial) {
  const double stuck = std::numeric_limits<double>::infinity();
  const Case nearest{.lattice = Lattice::body_centred, .before = 0.02, .strain = kUniaxial, .friction = stuck};
  expect_closed_form(nearest, kBodyPairs, 1e-12);
  const Case both{.lattice = Lattice::body_centred, .before = 0.2, .strain = kUniaxial, .shake = 1e-3};
  expect_closed_form(both, kBodyPairs + kBodySecondPairs, 1e-12);
}

TEST(LeastWorkSymmetry, AGrainThatIsNotCentredMeetsAPlaneWithoutFriction) {
  GrainPack pack;
  add_grain(pack, {{0.0, 1e-3, 1e-3}}, 1e-3);
  add_grain(pack, {{1.9e-3, 1e-3, 1e-3}}, 1e-3);
  add_box(pack, {{2.8e-3, 2e-3, 2e-3}}, 0.0);
  for (PackWall& w : pack.walls) w.symmetry = true;
  pack.friction = 0.3;
  const LeastWorkResult r = advance(pack, std::vector<Vec3>(6), {});
  ASSERT_TRUE(r.converged) << to_string(r.stopped_by);
  EXPECT_EQ(pack.position[0][0], 0.0);
  const std::vector<Vec3> forces = wall_forces(pack);
  EXPECT_GT(forces[1][0], 0.0);
  EXPECT_NEAR(forces[0][0] / forces[1][0], -1.0, 1e-5);
  ASSERT_EQ(pack.contacts.size(), 2U);
}

TEST(LeastWorkSymmetry, RefusesFrictionAndSkewPlanes) {
  GrainPack pack = make_lattice(Lattice::face_centred, 1, touching(Lattice::face_centred));
  pack.walls[0].friction = 0.3;
  EXPECT_THROW(advance(pack, std::vector<Vec3>(6), {}), InputError);
  pack.walls[0].friction = 0.0;
  pack.walls[0].normal = {{0.8, 0.6, 0.0}};
  EXPECT_THROW(advance(pack, std::vector<Vec3>(6), {}), InputError);
}

}  // namespace
