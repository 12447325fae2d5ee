// Soft particles that remember their largest volume at rest: energy, slopes, files, threads, order.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <utility>
#include <vector>

#include "common/contact/make_laws.h"
#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/parallel_pass.h"
#include "common/neighbours/spatial_order.h"
#include "common/state/system_io.h"
#include "tests/support/small_packing.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using test::TemporaryDirectory;

constexpr double kSoftRadius = 0.01;
constexpr double kSoftModulus = 5e5;
using IsotropicLaw = SoftMultiContact<LawForm::isotropic, false>;

MultiContactLaws laws_with_ratio(double ratio, double friction = 0.0) {
  LawTableEntry entry = synthetic::law_entry();
  entry.volume_max = 0.0;  // no end of the range
  MultiContactChoices choices;
  choices.form = LawForm::isotropic;
  choices.modulus = kSoftModulus;
  choices.friction = friction;
  choices.unloading_ratio = ratio;
  return make_multi_contact_laws(entry, choices);
}

const MultiContactPressure& pressure_of(const MultiContactLaws& laws) {
  return std::get<IsotropicLaw>(laws.soft_plane).form.pressure;
}

/// Materials 0 solid, 1 soft, 2 wall; solid grains are blind to each other.
System3 system_with(const MultiContactLaws& laws) {
  System3 s;
  for (const char* name : {"solid", "soft", "wall"}) s.materials.push_back({name, 2500.0, kSoftModulus, 0.3, false});
  s.laws = LawSet(3);
  s.laws.set(1, 0, laws.soft_solid, true);
  s.laws.set(0, 1, laws.solid_soft, true);
  s.laws.set(1, 1, laws.soft_soft);
  s.laws.set(1, 2, laws.soft_plane);
  return s;
}

Slot add_ball(System3& s, const Vec3& x, double r, bool soft) {
  NewBody<3> b;
  b.x = x;
  b.r = r;
  b.mass = b.inertia = 1.0;
  b.material = soft ? 1 : 0;
  return add_grain(s.particles, b);
}

/// A soft particle at the origin between two walls that overlap it by `depth` radii each.
struct PressedParticle {
  explicit PressedParticle(const MultiContactLaws& laws) : s(system_with(laws)) {
    add_ball(s, Vec3{}, kSoftRadius, true);
    for (const double side : {-1.0, 1.0}) {
      NewBody<3> wall;
      wall.material = 2;
      wall.x = {{side * kSoftRadius, 0.0, 0.0}};
      add_plane(s.particles, wall, Vec3{{-side, 0.0, 0.0}});
    }
  }

  /// Force on the second wall over E R^2.
  double at_depths(double first, double second, BodyStiffness* stiffness = nullptr) {
    s.particles.sphere[1].x[0] = -kSoftRadius * (1.0 - first);
    s.particles.sphere[2].x[0] = kSoftRadius * (1.0 - second);
    BodyStiffness ignored;
    force_pass(s, 0.0, stiffness != nullptr ? *stiffness : ignored);
    return s.particles.force[2][0] / (kSoftModulus * kSoftRadius * kSoftRadius);
  }

  double at_depth(double both) { return at_depths(both, both); }

  System3 s;
};

TEST(UnloadingRatio, ClosedFormOfAParticleBetweenWalls) {
  constexpr double kRatio = 1.3;
  constexpr double kDeepest = 0.22;
  const MultiContactLaws laws = laws_with_ratio(kRatio);
  PressedParticle pressed(laws);
  PressedParticle elastic(laws_with_ratio(1.0));
  for (const double depth : {0.12, 0.2, kDeepest}) {
    EXPECT_EQ(pressed.at_depth(depth), elastic.at_depth(depth)) << "loading is as without a memory";
    keep_largest_volumes(pressed.s);
    keep_largest_volumes(elastic.s);
  }
  EXPECT_TRUE(elastic.s.particles.largest_volume.empty());
  const double most = 2.0 * lens(kDeepest, 0.0).volume;
  EXPECT_NEAR(pressed.s.particles.largest_volume.at(0), most, 1e-14);
  const auto closed_form = [&](double depth) {
    const Lens<double> v = lens(depth, 0.0);
    const double seen = most - kRatio * (most - 2.0 * v.volume);
    return seen > 0.0 ? v.slope * pressure_of(laws).at(seen).p : 0.0;
  };
  EXPECT_GT(closed_form(0.18), 0.0);
  for (const double depth : {0.21, 0.18, 0.15, 0.05, 0.19, kDeepest}) {
    EXPECT_NEAR(pressed.at_depth(depth), closed_form(depth), 1e-12) << depth;
    keep_largest_volumes(pressed.s);  // what is smaller moves nothing
  }
  EXPECT_EQ(pressed.at_depth(0.05), 0.0) << "in touch, and unloaded";
  EXPECT_EQ(pressed.at_depth(0.24), elastic.at_depth(0.24)) << "beyond, loading goes on";
}

/// Both along the curve of the pressure and by the stiffness that relaxations go by.
TEST(UnloadingRatio, UnloadingIsSteeperByTheRatio) {
  for (const double ratio : {1.3, 3.0}) {
    PressedParticle pressed(laws_with_ratio(ratio));
    constexpr double kDeepest = 0.2;
    constexpr double kStep = 1e-5;
    const auto pressure = [&](double depth) { return pressed.at_depth(depth) / lens(depth, 0.0).slope; };
    const double top = pressure(kDeepest);
    keep_largest_volumes(pressed.s);
    const double up = pressure(kDeepest + kStep) - top;
    const double down = top - pressure(kDeepest - kStep);
    EXPECT_NEAR(down / up, ratio, 2e-3 * ratio);
    BodyStiffness k;
    (void)pressed.at_depths(0.17, 0.17, &k);
    const double slope =
        (pressed.at_depths(0.17, 0.17 + kStep) - pressed.at_depths(0.17, 0.17 - kStep)) / (2.0 * kStep);
    const double kt_ratio = synthetic::law_entry().slide_plane.kt_ratio.value;
    EXPECT_NEAR(k.translation[2] / (kSoftModulus * kSoftRadius), slope * (1.0 + kt_ratio), 1e-4 * slope);
  }
}

/// Integral of the pressure from 0 to a volume.
double stored_below(const MultiContactPressure& pressure, double volume) {
  constexpr int kParts = 20000;
  double sum = 0.0;
  for (int k = 0; k < kParts && volume > 0.0; ++k) sum += pressure.at(volume * (k + 0.5) / kParts).p * volume / kParts;
  return sum;
}

/// Energy of all soft particles at their present volumes, with their largest ones as they are [J].
double energy_of(System3& s, const MultiContactPressure& pressure, double ratio) {
  force_pass(s, 0.0);
  double sum = 0.0;
  for (Slot i = 0; i < s.particles.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    if (s.particles.material[u] != 1) continue;
    const double volume = s.contacts.particle_sum[u].volume;
    const double most = s.particles.largest_volume[u];
    const double scale = kSoftModulus * std::pow(s.particles.sphere[u].r, 3);
    const double back = stored_below(pressure, most - ratio * (most - std::min(volume, most))) / ratio;
    const double on = volume > most ? stored_below(pressure, volume) - stored_below(pressure, most) : 0.0;
    sum += scale * (back + on);
  }
  return sum;
}

/// Two soft particles, solid ones and a wall; the first unloads, the second loads on.
TEST(UnloadingRatio, ForcesAreTheDerivativeOfTheEnergy) {
  constexpr double kRatio = 1.5;
  const MultiContactLaws laws = laws_with_ratio(kRatio);
  System3 s = system_with(laws);
  add_ball(s, Vec3{}, 0.01, true);
  add_ball(s, {{0.0, 0.0178, 0.001}}, 0.011, true);
  add_ball(s, {{0.0155, 0.0, 0.0}}, 0.0075, false);
  add_ball(s, {{0.0, 0.0355, 0.0}}, 0.009, false);
  NewBody<3> wall;
  wall.material = 2;
  wall.x = {{0.0, 0.0, -0.0082}};
  add_plane(s.particles, wall, Vec3{{0.0, 0.0, 1.0}});
  force_pass(s, 0.0);
  keep_largest_volumes(s);
  s.particles.sphere[2].x[0] += 3e-4;
  s.particles.sphere[3].x[1] -= 4e-4;
  force_pass(s, 0.0);
  const auto& sums = s.contacts.particle_sum;
  const auto& largest = s.particles.largest_volume;
  ASSERT_LT(sums[0].volume, 0.99 * largest[0]);
  ASSERT_GT(sums[1].volume, 1.01 * largest[1]);
  const auto forces = s.particles.force;
  RandomStream random(7, RandomPurpose::test, 0);
  for (int trial = 0; trial < 6; ++trial) {
    std::vector<Vec3> way(4);
    double along = 0.0;
    double size = 0.0;
    for (std::size_t u = 0; u < way.size(); ++u) {
      for (double& x : way[u].v) x = random.normal();
      along += dot(Vec3(forces[u]), way[u]);
      size += norm(Vec3(forces[u])) * norm(way[u]);
    }
    constexpr double kStep = 1e-7;
    const auto energy_at = [&](double step) {
      System3 moved = s;
      for (std::size_t u = 0; u < way.size(); ++u) moved.particles.sphere[u].x += way[u] * step;
      return energy_of(moved, pressure_of(laws), kRatio);
    };
    EXPECT_NEAR(-(energy_at(kStep) - energy_at(-kStep)) / (2.0 * kStep), along, 2e-4 * size) << trial;
  }
}

/// At the same places the energy falls when the largest volume moves.
TEST(UnloadingRatio, TheMemoryStoresNothing) {
  constexpr double kRatio = 1.5;
  const MultiContactLaws laws = laws_with_ratio(kRatio);
  PressedParticle pressed(laws);
  (void)pressed.at_depth(0.15);
  keep_largest_volumes(pressed.s);
  (void)pressed.at_depth(0.2);
  const double before = energy_of(pressed.s, pressure_of(laws), kRatio);
  keep_largest_volumes(pressed.s);
  const double after = energy_of(pressed.s, pressure_of(laws), kRatio);
  EXPECT_GT(after, 0.0);
  EXPECT_LT(after, 0.99 * before);
}

/// A lattice of soft and solid bodies with friction that was pressed and has begun to unload.
System3 unloaded_lattice(int edge, double ratio) {
  System3 s = system_with(laws_with_ratio(ratio, 0.3));
  for (int k = 0; k < edge * edge * edge; ++k)
    add_ball(s, Vec3{{double(k % edge), double(k / edge % edge), double(k / (edge * edge))}} * 0.0178,
             k % 7 == 0 ? 0.0101 : 0.01, k % 3 != 0);
  force_pass(s, 0.0);
  keep_largest_volumes(s);
  for (auto& sphere : s.particles.sphere) sphere.x *= 1.005;
  return s;
}

TEST(UnloadingRatio, ThreadsChangeNoBitOfTheMemory) {
  const int before = omp_get_max_threads();
  const auto run = [&](int threads, bool ordered, double ratio) {
    omp_set_num_threads(threads);
    System3 s = unloaded_lattice(17, ratio);
    if (ordered) reorder_grains(s, spatial_order(s));
    BodyStiffness stiffness;
    force_pass(s, 0.0, stiffness);
    keep_largest_volumes(s);
    omp_set_num_threads(before);
    return std::pair(s, stiffness);
  };
  for (const bool ordered : {false, true}) {
    const auto [one, k] = run(1, ordered, 1.3);
    ASSERT_GT(one.contacts.size(), 8000) << "too small for the parallel path";
    EXPECT_NE(one.particles.force, run(1, ordered, 1.0).first.particles.force) << "the memory counts";
    for (const int threads : {2, 3}) {
      const auto [many, also] = run(threads, ordered, 1.3);
      EXPECT_EQ(one.particles.force, many.particles.force) << threads << ordered;
      EXPECT_EQ(one.particles.largest_volume, many.particles.largest_volume) << threads << ordered;
      EXPECT_EQ(k.translation, also.translation) << threads << ordered;
    }
  }
}

TEST(UnloadingRatio, TheMemoryGoesWithItsParticle) {
  System3 plain = unloaded_lattice(5, 1.3);
  System3 ordered = plain;
  std::vector<Slot> order = spatial_order(ordered);
  std::reverse(order.begin(), order.end());
  reorder_grains(ordered, order);
  const auto& before = plain.particles.largest_volume;
  const auto& after = ordered.particles.largest_volume;
  ASSERT_EQ(after.size(), before.size());
  EXPECT_NE(after, before);
  force_pass(plain, 0.0);
  force_pass(ordered, 0.0);
  double largest_force = 0.0;
  for (const auto& force : plain.particles.force) largest_force = std::max(largest_force, norm(Vec3(force)));
  for (std::size_t u = 0; u < after.size(); ++u) {
    const auto id = static_cast<std::size_t>(ordered.particles.id[u]);
    EXPECT_EQ(after[u], before[id]) << u;
    EXPECT_LT(norm(Vec3(ordered.particles.force[u]) - Vec3(plain.particles.force[id])), 1e-12 * largest_force) << u;
  }
  restore_order(ordered);
  EXPECT_EQ(ordered.particles.largest_volume, before);
}

/// One that comes later has had no volume at rest, and the others keep theirs.
TEST(UnloadingRatio, ABodyThatIsAddedHasNothingToRemember) {
  PressedParticle pressed(laws_with_ratio(1.3));
  (void)pressed.at_depth(0.2);
  keep_largest_volumes(pressed.s);
  const double most = pressed.s.particles.largest_volume.at(0);
  ASSERT_GT(most, 0.0);
  add_ball(pressed.s, {{0.0, 0.05, 0.0}}, kSoftRadius, true);
  EXPECT_EQ(pressed.s.particles.largest_volume, (std::vector<double>{most, 0.0, 0.0, 0.0}));
}

/// A state through a file.
System3 through_a_file(const System3& s, bool has_memory) {
  const TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("state.h5"));
    write_system(file.root().create("state"), s);
    file.commit();
  }
  const h5::Group group = h5::open_file(directory.file("state.h5")).open("state");
  EXPECT_EQ(group.open("bodies").has("largest_volume"), has_memory);
  System3 read;
  read.materials = s.materials;
  read.laws = s.laws;
  read_system(group, read);
  return read;
}

TEST(UnloadingRatio, AStateIsSavedWithTheMemoryOrWithoutOne) {
  for (const double ratio : {1.0, 1.3}) {
    System3 s = unloaded_lattice(4, ratio);
    force_pass(s, 0.0, History::advance);
    System3 restored = through_a_file(s, ratio > 1.0);
    test::expect_same_state(s, restored);
    for (System3* one : {&s, &restored}) {
      for (auto& sphere : one->particles.sphere) sphere.x *= 1.002;
      force_pass(*one, 0.0, History::advance);
      keep_largest_volumes(*one);
    }
    test::expect_same_state(s, restored);
  }
}

TEST(UnloadingRatio, AMemoryThatIsNoVolumeIsDamage) {
  System3 s = unloaded_lattice(2, 1.3);
  s.particles.largest_volume[1] = -1e-3;
  EXPECT_THROW((void)through_a_file(s, true), IoError);
  s.particles.largest_volume[1] = std::nan("");
  EXPECT_THROW((void)through_a_file(s, true), IoError);
}

}  // namespace
}  // namespace softgrain
