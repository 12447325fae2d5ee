// A saved state is the state: same bits after reading, same bits after going on from it. Checkpoints find damage.
#include "common/state/system_io.h"

#include <filesystem>
#include <fstream>
#include <limits>

#include "common/core/error.h"
#include "common/dynamics/verlet.h"
#include "common/state/checkpoint.h"
#include "tests/support/small_packing.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

template <int D>
System<D> saved_and_read(const System<D>& s) {
  const TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("state.h5"));
    write_system(file.root().create("state"), s);
    file.commit();
  }
  System<D> read;
  read.materials = s.materials;
  read.laws = s.laws;
  read_system(h5::open_file(directory.file("state.h5")).open("state"), read);
  return read;
}

template <int D>
void run(System<D>& s, int steps, bool first) {
  VelocityVerlet<D> integrator(1e-4);
  if (first) integrator.initialise(s);
  for (int k = 0; k < steps; ++k) integrator.step(s);
}

template <int D>
void expect_restart_is_bitwise(System<D> s) {
  System<D> other = s;
  run(s, 500, true);
  run(other, 200, true);
  System<D> restored = saved_and_read(other);
  expect_same_state(other, restored);
  run(restored, 300, false);
  expect_same_state(s, restored);
  EXPECT_GT(s.neighbours.rebuilds, 2);
  bool spring = false;
  for (const auto& x : s.contacts.spring) spring = spring || norm(x) > 0.0;
  EXPECT_TRUE(spring) << "the packing must have histories to lose";
}

TEST(SystemIo, RestartIsBitwise3D) { expect_restart_is_bitwise(shell_and_plane_system<3>(0.4, 0.7, false)); }
TEST(SystemIo, RestartIsBitwiseWithMemory3D) { expect_restart_is_bitwise(shell_and_plane_system<3>(0.4, 0.7, true)); }
TEST(SystemIo, RestartIsBitwise2D) { expect_restart_is_bitwise(shell_and_plane_system<2>(0.4, 0.7, true)); }

TEST(SystemIo, RestartIsBitwiseInAShearedPeriodicCell) {
  System3 s = hertz_system<3>(0.4, 0.8, false);
  s.cell = box_cell<3>({{1.2, 1.2, 1.2}}, {true, true, true});
  s.cell.velocity_gradient[0][1] = 3.0;
  RandomStream random(3, RandomPurpose::test, 2);
  for (const Vec3& x : shaken_lattice<3>({{0.6, 0.6, 0.6}}, 0.3, 4, 5)) {
    NewBody<3> grain = test_sphere<3>(x, 0.13 + 0.02 * random.uniform(), 2500.0);
    for (int k = 0; k < 3; ++k) grain.velocity[k] = 4.0 * random.uniform() - 2.0;
    add_grain(s.particles, grain);
  }
  expect_restart_is_bitwise(s);
}

TEST(SystemIo, AStateOfOtherDimensionOrLengthIsRefused) {
  const System3 s = shell_and_plane_system<3>(0.4, 0.7, false);
  const TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("state.h5"));
    write_system(file.root().create("state"), s);
    file.commit();
  }
  const h5::Group group = h5::open_file(directory.file("state.h5")).open("state");
  System<2> flat = shell_and_plane_system<2>(0.4, 0.7, false);
  EXPECT_THROW(read_system(group, flat), IoError);
}

/// A run went on with them, to results that were no numbers.
TEST(SystemIo, NumbersThatAreNotFiniteAreDamage) {
  System3 s = shell_and_plane_system<3>(0.4, 0.7, false);
  s.particles.spin.front()[1] = std::numeric_limits<double>::quiet_NaN();
  try {
    (void)saved_and_read(s);
    ADD_FAILURE() << "it was read";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("state.h5: /state/bodies/spin: saved state: 'spin' holds a number"),
              std::string::npos)
        << e.what();
  }
}

/// Whatever follows shells outwards would go round for ever.
TEST(SystemIo, AShellThatLiesInItselfIsDamage) {
  System3 s = shell_and_plane_system<3>(0.4, 0.7, false);
  ASSERT_GT(s.particles.shells, 0);
  const auto shell = static_cast<std::size_t>(s.particles.grains);
  EXPECT_NO_THROW(saved_and_read(s));
  s.particles.shell[shell] = s.particles.grains;
  EXPECT_THROW(saved_and_read(s), IoError);
  s.particles.shell[shell] = -1;
  s.particles.shell[0] = 0;
  EXPECT_THROW(saved_and_read(s), IoError) << "a grain is no shell";
}

void write_number(const std::string& path, const std::string& scene, double number) {
  write_checkpoint(path, scene,
                   [&](const h5::Group& g) { g.create("a").write("x", std::vector<double>(1000, number)); });
}

double read_number(const h5::Group& g) { return g.open("a").doubles("x").back(); }

void damage(const std::string& path, double number) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::string bytes(reinterpret_cast<const char*>(&number), sizeof number);
  const auto at = text.find(bytes + bytes);
  ASSERT_NE(at, std::string::npos);
  file.clear();
  file.seekp(static_cast<std::streamoff>(at));
  file.put('\x55');
}

TEST(Checkpoint, NewestFirstPreviousWhenDamagedNothingWithout) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("checkpoint.h5");
  std::string note;
  EXPECT_FALSE(open_checkpoint(path, "scene", note).has_value());
  write_number(path, "scene", 1.25);
  write_number(path, "scene", 2.75);
  EXPECT_EQ(read_number(*open_checkpoint(path, "scene", note)), 2.75);
  EXPECT_EQ(note, "");
  damage(path, 2.75);
  EXPECT_EQ(read_number(*open_checkpoint(path, "scene", note)), 1.25);
  EXPECT_NE(note.find("previous"), std::string::npos) << note;
  damage(path + ".previous", 1.25);
  EXPECT_THROW((void)open_checkpoint(path, "scene", note), IoError);
}

TEST(Checkpoint, TruncatedFileFallsBack) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("checkpoint.h5");
  write_number(path, "scene", 1.25);
  write_number(path, "scene", 2.75);
  std::filesystem::resize_file(path, 100);
  std::string note;
  EXPECT_EQ(read_number(*open_checkpoint(path, "scene", note)), 1.25);
}

TEST(Checkpoint, BelongsToItsScene) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("checkpoint.h5");
  write_number(path, "scene", 1.25);
  std::string note;
  EXPECT_THROW((void)open_checkpoint(path, "another scene", note), InputError);
}

TEST(Checkpoint, RemovedWithItsPrevious) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("checkpoint.h5");
  write_number(path, "scene", 1.25);
  write_number(path, "scene", 2.75);
  remove_checkpoint(path);
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

}  // namespace
