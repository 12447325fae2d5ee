// The same bits for any number of threads, where the parallel path is really taken.
#include <omp.h>

#include "common/dynamics/verlet.h"
#include "tests/support/small_packing.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Dense frictional lattice between planes; a shell around the first layer's grains adds the third geometry.
System3 large_packing() {
  System3 s = hertz_system<3>(0.4, 0.8, true);
  s.gravity = {{0.0, 0.0, -9.81}};
  RandomStream random(9, RandomPurpose::test, 1);
  const auto places = shaken_lattice<3>({}, 0.2, 16, 6);
  const auto shell = static_cast<Slot>(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    NewBody<3> grain = solid_sphere<3>(places[k], 0.1 + 0.01 * random.uniform(), 2500.0, k % 2 == 0 ? shell : -1);
    for (int d = 0; d < 3; ++d) grain.velocity[d] = 2.0 * random.uniform() - 1.0;
    add_grain(s.particles, grain);
  }
  NewBody<3> wall;
  wall.r = 2.72;
  add_shell(s.particles, wall);
  NewBody<3> plane;
  plane.x[2] = -1.58;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
  return s;
}

System3 run_with(int threads, int steps) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  System3 s = large_packing();
  VelocityVerlet<3> integrator(1e-4);
  integrator.initialise(s);
  for (int k = 0; k < steps; ++k) integrator.step(s);
  omp_set_num_threads(before);
  return s;
}

TEST(Threads, AnyNumberGivesTheSameBits) {
  const System3 one = run_with(1, 60);
  ASSERT_GT(one.contacts.size(), 8000) << "too small for the parallel path";
  ASSERT_EQ(one.contacts.sections.size(), 3U) << "all three geometries";
  EXPECT_GT(one.neighbours.rebuilds, 1);
  for (const int threads : {2, 3, 8}) {
    SCOPED_TRACE(threads);
    expect_same_state(one, run_with(threads, 60));
  }
}

}  // namespace
