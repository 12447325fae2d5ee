// The least-work solver on small packs: both methods, unloading, failure, threads, scale.
#include <gtest/gtest.h>
#include <omp.h>

#include <iostream>

#include "common/core/error.h"
#include "common/statics/pack_problem.h"
#include "tests/support/grain_packs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kMu = 0.3;

const GrainPack& frictional_pack() {
  static const GrainPack pack = random_pack(5, kMu);
  return pack;
}

std::vector<Vec3> uniaxial(const GrainPack& pack, double strain) { return squeeze(pack, {{0.0, 0.0, strain}}); }

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, norm(a[k] - b[k]));
  return worst;
}

bool same_bits(const GrainPack& a, const GrainPack& b) {
  if (a.position != b.position || a.contacts.size() != b.contacts.size()) return false;
  for (std::size_t w = 0; w < a.walls.size(); ++w)
    if (!(a.walls[w].point == b.walls[w].point)) return false;
  for (std::size_t c = 0; c < a.contacts.size(); ++c) {
    const PackContact& p = a.contacts[c];
    const PackContact& q = b.contacts[c];
    if (p.i != q.i || p.j != q.j || p.normal_force != q.normal_force || !(p.tangential_force == q.tangential_force) ||
        p.torsion != q.torsion || p.sliding != q.sliding)
      return false;
  }
  return true;
}

TEST(LeastWork, PublishedAndFastReachTheSameEquilibrium) {
  GrainPack fast = frictional_pack();
  GrainPack published = fast;
  LeastWorkOptions options;
  options.coulomb = CoulombRule::reference;
  options.residual_tolerance = 1e-9;
  options.work_tolerance = 0.0;
  options.force_tolerance = 1e-24;
  options.max_iterations = 200000;
  options.sub_increments = 1;
  const std::vector<Vec3> moves = uniaxial(fast, 2e-5);
  ASSERT_TRUE(advance(fast, moves, options).converged);
  options.method = LeastWorkMethod::published;
  const LeastWorkResult r = advance(published, moves, options);
  ASSERT_TRUE(r.converged) << to_string(r.stopped_by) << " " << r.worst_residual;
  const double scale = norm(wall_forces(fast)[5]);
  // A sliding contact does not fix its grains' place exactly; the forces agree to the share that slides.
  EXPECT_LT(largest_difference(wall_forces(fast), wall_forces(published)), 1e-4 * scale);
}

TEST(LeastWork, EveryGrainBalances) {
  GrainPack pack = frictional_pack();
  LeastWorkOptions options;
  options.residual_tolerance = 1e-9;
  for (int k = 0; k < 3; ++k) {
    const LeastWorkResult r = advance(pack, uniaxial(pack, 1e-4), options);
    ASSERT_TRUE(r.converged) << to_string(r.stopped_by);
    EXPECT_LE(r.worst_residual, 1e-9);
  }
  // All walls together carry nothing.
  Vec3 sum;
  double largest = 0.0;
  for (const Vec3& f : wall_forces(pack)) {
    sum += f;
    largest = std::max(largest, norm(f));
  }
  EXPECT_LT(norm(sum), 1e-7 * largest);
}

TEST(LeastWork, NoTangentialForceAboveTheLimitEvenWhenContactsUnload) {
  GrainPack pack = frictional_pack();
  LeastWorkOptions options;
  for (const double strain : {3e-4, 3e-4, -4e-4}) {
    ASSERT_TRUE(advance(pack, uniaxial(pack, strain), options).converged);
    int sliding = 0;
    for (const PackContact& c : pack.contacts) {
      EXPECT_LE(norm(c.tangential_force), kMu * c.normal_force * (1.0 + 1e-9));
      EXPECT_EQ(c.sliding, norm(c.tangential_force) >= (1.0 - 1e-6) * kMu * c.normal_force);
      sliding += c.sliding ? 1 : 0;
    }
    EXPECT_GT(sliding, 0);
  }
}

/// Difference between the slope of Pi and minus the force along one direction, in the mean contact force, when all
/// grains are displaced and turned by about `size` of their radius.
double gradient_error(const GrainPack& pack, double size) {
  RandomStream random(9, RandomPurpose::test, 0);
  statics::PackProblem problem(pack, std::vector<Vec3>(6), CoulombRule::reference, true);
  statics::Unknowns theta(problem.size()), direction(problem.size());
  for (double& v : theta) v = size * 1e-3 * (random.uniform() - 0.5);
  for (double& v : direction) v = random.uniform() - 0.5;
  // A rattler's contact that opens takes its tangential force with it: Pi jumps. Such grains stay where they are.
  for (const PackContact& c : pack.contacts)
    for (const std::int32_t g : {c.i, c.j})
      if (c.overlap < 1e-6 && g < pack.grains())
        for (std::size_t k = 0; k < 6; ++k) {
          theta[6 * static_cast<std::size_t>(g) + k] = 0.0;
          direction[6 * static_cast<std::size_t>(g) + k] = 0.0;
        }
  statics::PackForces forces;
  problem.evaluate(theta, forces);
  const double expected = -statics::dot(forces.force, direction);
  const double scale =
      forces.contact_force / static_cast<double>(forces.contacts) * std::sqrt(statics::dot(direction, direction));
  const double step = 1e-10;
  statics::add_scaled(theta, step, direction);
  problem.evaluate(theta, forces);
  const double high = forces.work;
  statics::add_scaled(theta, -2.0 * step, direction);
  problem.evaluate(theta, forces);
  return std::abs((high - forces.work) / (2.0 * step) - expected) / scale;
}

TEST(LeastWork, FreeGradientIsRightToFirstOrderInTheDisplacement) {
  GrainPack pack = frictional_pack();
  ASSERT_TRUE(advance(pack, uniaxial(pack, 1e-4), {}).converged);
  pack.friction = std::numeric_limits<double>::infinity();  // no slip, and none opens: Pi is smooth
  const double coarse = gradient_error(pack, 3e-5);
  const double fine = gradient_error(pack, 1e-5);
  std::cout << "error of the gradient at |u|/R = 3e-5 and 1e-5: " << coarse << " " << fine << "\n";
  EXPECT_LT(coarse, 1e-6);
  EXPECT_NEAR(coarse / fine, 3.0, 0.5);
}

TEST(LeastWork, AnIncrementThatDoesNotConvergeLeavesThePackAlone) {
  for (const LeastWorkMethod method : {LeastWorkMethod::fast, LeastWorkMethod::published}) {
    GrainPack pack = frictional_pack();
    LeastWorkOptions options;
    options.method = method;
    options.max_iterations = 1;
    options.residual_tolerance = 1e-12;
    const LeastWorkResult r = advance(pack, uniaxial(pack, 1e-3), options);
    EXPECT_FALSE(r.converged);
    EXPECT_EQ(r.stopped_by, LeastWorkEnd::cap);
    EXPECT_TRUE(same_bits(pack, frictional_pack()));
  }
}

TEST(LeastWork, RefusesWallsThatPassEachOtherAndGrainsOutside) {
  GrainPack pack = frictional_pack();
  EXPECT_THROW(advance(pack, uniaxial(pack, 1.01), {}), UnusableResult);
  GrainPack one;
  add_grain(one, {{0.5e-3, 0.5e-3, -0.1e-3}}, 1e-4);
  add_box(one, {{1e-3, 1e-3, 1e-3}}, 0.0);
  EXPECT_THROW(advance(one, std::vector<Vec3>(6), {}), UnusableResult);
  EXPECT_THROW(advance(pack, std::vector<Vec3>(5), {}), InputError);
}

TEST(LeastWork, GrainsWithoutContactsStayWhenWallsStay) {
  GrainPack pack;
  add_grain(pack, {{0.99e-3, 2e-3, 2e-3}}, 1e-3);
  add_grain(pack, {{2.97e-3, 2e-3, 2e-3}}, 1e-3);
  add_grain(pack, {{8e-3, 8e-3, 8e-3}}, 1e-3);
  add_box(pack, {{1e-2, 1e-2, 1e-2}}, kMu);
  refresh_contacts(pack);
  const Vec3 before = pack.position.back();
  LeastWorkOptions options;
  options.residual_tolerance = 1e-3;
  ASSERT_TRUE(advance(pack, std::vector<Vec3>(6), options).converged);
  EXPECT_EQ(pack.position.back(), before);
  EXPECT_NE(pack.position.front()[0], 0.99e-3);
}

TEST(LeastWork, AGrainUnderGravityFallsOntoTheFloorAndRests) {
  GrainPack pack;
  add_grain(pack, {{5e-3, 5e-3, 1.3e-3}}, 1e-3);
  add_box(pack, {{1e-2, 1e-2, 1e-2}}, kMu);
  pack.weight = {10.0};
  pack.gravity = {{0.0, 0.0, -1.0}};
  const LeastWorkResult r = advance(pack, std::vector<Vec3>(6), {});
  ASSERT_TRUE(r.converged) << to_string(r.stopped_by);
  ASSERT_EQ(pack.contacts.size(), 1U);
  EXPECT_NEAR(pack.contacts[0].normal_force, 10.0, 1e-5);
  EXPECT_NEAR(wall_forces(pack)[4][2], -10.0, 1e-5);
}

TEST(LeastWork, AnEmptyPackIsInEquilibrium) {
  GrainPack pack;
  add_box(pack, {{1e-2, 1e-2, 1e-2}}, 0.0);
  EXPECT_TRUE(advance(pack, uniaxial(pack, 1e-2), {}).converged);
}

/// A shaken cubic lattice with enough contacts for the parallel loops.
GrainPack large_pack() {
  constexpr int kN = 20;
  GrainPack pack;
  RandomStream random(4, RandomPurpose::test, 0);
  for (int k = 0; k < kN * kN * kN; ++k) {
    Vec3 x{{2.0 * (k % kN) + 1.0, 2.0 * (k / kN % kN) + 1.0, 2.0 * (k / (kN * kN)) + 1.0}};
    for (int a = 0; a < 3; ++a) x[a] += 1e-3 * (random.uniform() - 0.5);
    add_grain(pack, x * 1e-3, 1.01e-3);
  }
  add_box(pack, {{0.04, 0.04, 0.04}}, kMu);
  pack.friction = kMu;
  refresh_contacts(pack);
  return pack;
}

TEST(LeastWork, SameBitsForAnyNumberOfThreads) {
  const GrainPack start = large_pack();
  LeastWorkOptions options;
  std::vector<GrainPack> packs;
  const int before = omp_get_max_threads();
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    packs.push_back(start);
    ASSERT_TRUE(advance(packs.back(), uniaxial(start, 1e-4), options).converged);
  }
  omp_set_num_threads(before);
  EXPECT_TRUE(same_bits(packs[0], packs[1]));
  EXPECT_TRUE(same_bits(packs[0], packs[2]));
  EXPECT_FALSE(same_bits(packs[0], start));
}

TEST(LeastWork, UnitsDoNotMatter) {
  GrainPack pack = frictional_pack();
  GrainPack scaled = pack;
  for (Vec3& x : scaled.position) x *= 16.0;
  for (double& r : scaled.radius) r *= 16.0;
  for (double& e : scaled.youngs_modulus) e *= 256.0;
  for (PackWall& w : scaled.walls) w.point *= 16.0;
  for (PackContact& c : scaled.contacts) {
    c.overlap *= 16.0;
    c.normal_force *= 65536.0;
    c.contact_radius *= 16.0;
    c.tangential_force *= 65536.0;
    c.torsion *= 1048576.0;
  }
  for (const LeastWorkMethod method : {LeastWorkMethod::fast, LeastWorkMethod::published}) {
    LeastWorkOptions options;
    options.method = method;
    GrainPack a = pack;
    GrainPack b = scaled;
    const LeastWorkResult ra = advance(a, uniaxial(a, 1e-4), options);
    const LeastWorkResult rb = advance(b, uniaxial(b, 1e-4), options);
    EXPECT_EQ(ra.iterations, rb.iterations);
    EXPECT_EQ(ra.worst_residual, rb.worst_residual);
    for (Vec3& x : a.position) x *= 16.0;
    EXPECT_EQ(a.position, b.position);
  }
}

TEST(LeastWork, ProbeAgreesWithASmallIncrementOfAStuckPack) {
  GrainPack pack = frictional_pack();
  pack.friction = std::numeric_limits<double>::infinity();
  for (PackWall& w : pack.walls) w.friction = pack.friction;
  LeastWorkOptions options;
  options.residual_tolerance = 1e-9;
  const ElasticResponse probe = elastic_probe(pack, options);
  ASSERT_TRUE(probe.solved);
  // Reciprocity.
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b) EXPECT_NEAR(probe.stiffness[a][b] / probe.stiffness[b][a], 1.0, 1e-6);
  const double strain = 1e-7;
  const std::vector<Vec3> before = wall_forces(pack);
  ASSERT_TRUE(advance(pack, uniaxial(pack, strain), options).converged);
  const double area =
      (pack.walls[1].point[0] - pack.walls[0].point[0]) * (pack.walls[3].point[1] - pack.walls[2].point[1]);
  const double stress = 0.5 * ((wall_forces(pack)[5] - before[5])[2] - (wall_forces(pack)[4] - before[4])[2]) / area;
  EXPECT_NEAR(stress / strain / probe.stiffness[2][2], 1.0, 0.02);
}

}  // namespace
