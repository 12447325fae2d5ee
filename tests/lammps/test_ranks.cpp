// softgrain-lammps under MPI: any number of ranks comes to the same state, and a restart goes on as if nothing had
// been.
#include <gtest/gtest.h>

#include "tests/lammps/dump_file.h"
#include "tests/lammps/macro_scene.h"
#include "tests/lammps/run_ranks.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {
namespace {

/// Largest difference of any number over `scale`.
double difference(const State& a, const State& b, double scale) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0.0;
  for (const auto& [id, values] : a) {
    const auto& others = b.at(id);
    for (std::size_t k = 0; k < values.size(); ++k) worst = std::max(worst, std::abs(values[k] - others[k]) / scale);
  }
  return worst;
}

class Ranks : public ::testing::Test {
 protected:
  Ranks() : scene(macro_scene(90, true)) { write_scene(scene, directory.path()); }

  /// Runs head.in and `protocol`; what it dumps comes back.
  State run(int ranks, const std::string& protocol, bool restart = false) {
    const std::string name = "state." + std::to_string(++runs_);
    std::ofstream(directory.path() + "/run.in")
        << "variable restart equal " << (restart ? 1 : 0) << "\natom_modify sort 0 0\n"
        << read_text(directory.path() + "/head.in") << protocol << "write_dump all custom " << name
        << " id x y z vx vy vz modify sort id format float %.17g\n";
    EXPECT_EQ(run_ranks(ranks, directory.path(), "-in run.in"), 0) << read_text(directory.path() + "/screen.txt");
    return read_dump(directory.path() + "/" + name);
  }

  TemporaryDirectory directory;
  MacroScene scene;

 private:
  int runs_ = 0;
};

constexpr double kRadius = 0.008;

const std::string kStrain = "change_box all z scale 0.98 remap\nrun 20000\n";

/// Dynamics with friction and dashpots instead of the relaxation.
const std::string kDynamics = R"(thermo_style one
unfix relax
fix move all nve/sphere
timestep 1e-5
velocity all create 1e17 87 loop geom
change_box all z scale 0.97 remap
)";

TEST_F(Ranks, OneTwoAndFourAgree) {
  const State one = run(1, kStrain);
  ASSERT_EQ(one.size(), 90U);
  for (const int ranks : {2, 4}) EXPECT_LT(difference(one, run(ranks, kStrain), kRadius), 1e-8) << ranks;
}

TEST_F(Ranks, DynamicsAgreesToo) {
  const State one = run(1, kDynamics + "run 300\n");
  for (const int ranks : {2, 4})
    EXPECT_LT(difference(one, run(ranks, kDynamics + "run 300\n"), kRadius), 1e-9) << ranks;
}

// Without walls bodies touch images of each other, and on one rank of themselves.
TEST_F(Ranks, PeriodicBoxesAgreeToo) {
  std::string head = read_text(directory.path() + "/head.in");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const auto at = head.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    head.replace(at, from.size(), to);
  };
  replace("boundary f f f", "boundary p p p");
  replace("fix walls", "# fix walls");
  replace("thermo_style custom", "# thermo_style custom");
  std::ofstream(directory.path() + "/head.in") << head;
  const std::string protocol = kDynamics + "run 300\n";
  const State one = run(1, protocol);
  for (const int ranks : {2, 4}) EXPECT_LT(difference(one, run(ranks, protocol), kRadius), 1e-9) << ranks;
}

TEST_F(Ranks, RestartBetweenIncrementsGoesOn) {
  const std::string kShort = "fix_modify relax max_passes 20\n" + kStrain;
  for (const int ranks : {1, 2}) {
    const State straight = run(ranks, kStrain + "write_restart scene.restart\n" + kShort);
    const State again = run(ranks, "run 0\n" + kShort, true);
    // Several ranks may hold their atoms in another order after a restart: other roundings of sums.
    if (ranks == 1)
      EXPECT_EQ(difference(straight, again, 1.0), 0.0);
    else
      EXPECT_LT(difference(straight, again, kRadius), 1e-12);
  }
}

TEST_F(Ranks, RestartWithinARunGoesOn) {
  const std::string rest = "thermo_style one\nunfix relax\nfix move all nve/sphere\ntimestep 1e-5\nrun 150\n";
  const auto copy = [&](const std::string& from, const std::string& to) {
    std::filesystem::copy_file(directory.path() + "/" + from, directory.path() + "/" + to,
                               std::filesystem::copy_options::overwrite_existing);
  };
  State straight;
  for (const int ranks : {1, 2}) {
    straight = run(ranks, kDynamics + "restart 150 scene.restart.*\nrun 300\n");
    copy("scene.restart.150", "scene.restart");
    EXPECT_LT(difference(straight, run(ranks, rest, true), kRadius), 1e-10) << ranks;
  }
  // It is the history that does it: places and velocities alone, as a data file holds them, lead elsewhere.
  (void)run(1, kDynamics + "run 150\nwrite_data half.data nocoeff\n");
  copy("half.data", "scene.data");
  EXPECT_GT(difference(straight, run(1, rest), kRadius), 1e-6);
}

}  // namespace
}  // namespace softgrain::test
