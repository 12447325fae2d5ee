// Cohesive disks in two dimensions, ours against the pair style.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>

#include "common/contact/law_set.h"
#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "tests/lammps/dump_file.h"
#include "tests/lammps/in_process.h"
#include "tests/lammps/run_ranks.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {
namespace {

constexpr double kStep = 1e-5;
constexpr double kDensity = 1000.0;
constexpr std::size_t kClusters = 300;

std::vector<LawFileEntry> disk_laws() {
  return {{"plain", CohesiveDisk<false, false>{1e4, 0.0, 0.0, 0.1, 5.0, 2e-3, 0.0, 0.0}},
          {"sliding", CohesiveDisk<true, false>{1e4, 7e3, 0.3, 0.1, 5.0, 2e-3, 0.0, 0.0}},
          {"rolling", CohesiveDisk<true, true>{1e4, 7e3, 0.3, 0.1, 5.0, 2e-3, 0.5, 1e-3}}};
}

/// Clusters of two to four disks that overlap, or are within or beyond the reach of attraction.
System<2> make_disks() {
  System<2> s;
  const auto laws = disk_laws();
  s.materials.assign(laws.size(), {"disk", kDensity, 1e6, 0.3, false});
  s.laws = LawSet(static_cast<std::int32_t>(laws.size()));
  for (std::size_t f = 0; f < laws.size(); ++f)
    s.laws.set(static_cast<std::int32_t>(f), static_cast<std::int32_t>(f), laws[f].second);
  RandomStream random(4, RandomPurpose::test, 2);
  const auto add = [&](const Vec2& x, double r, std::size_t family) {
    NewBody<2> b;
    b.x = x;
    b.r = r;
    b.mass = kDensity * std::numbers::pi * r * r;
    b.inertia = 0.5 * b.mass * r * r;
    b.material = static_cast<std::int32_t>(family);
    for (int d = 0; d < 2; ++d) b.velocity[d] = 4.0 * random.uniform() - 2.0;
    b.spin[0] = 100.0 * random.uniform() - 50.0;
    add_grain(s.particles, b);
  };
  for (std::size_t n = 0; n < kClusters; ++n) {
    const Vec2 middle{{static_cast<double>(n % 20) * 0.2, static_cast<double>(n / 20) * 0.2}};
    const double first = 0.01 + 0.02 * random.uniform();
    add(middle, first, n % disk_laws().size());
    const auto others = 1 + static_cast<int>(3.0 * random.uniform());
    for (int k = 0; k < others; ++k) {
      const double r = 0.01 + 0.02 * random.uniform();
      const double angle = 2.0 * std::numbers::pi * random.uniform();
      const double gap = 4e-3 * random.uniform() - 1.5e-3;
      add(middle + Vec2{{std::cos(angle), std::sin(angle)}} * (first + r + gap), r, n % disk_laws().size());
    }
  }
  return s;
}

void write_disks(const System<2>& s, const std::string& directory) {
  std::ofstream(directory + "/laws.toml") << laws_text(disk_laws());
  std::ofstream data(directory + "/disks.data");
  const auto& p = s.particles;
  data << fmt::format("disks\n\n{} atoms\n3 atom types\n-0.2 4.2 xlo xhi\n-0.2 3.2 ylo yhi\n-0.05 0.05 zlo zhi\n\n",
                      p.grains);
  data << "Atoms # sphere\n\n";
  for (std::size_t k = 0; k < p.sphere.size(); ++k)
    data << fmt::format("{} {} {:.17g} 1 {:.17g} {:.17g} 0\n", k + 1, p.material[k] + 1, 2.0 * p.sphere[k].r,
                        p.sphere[k].x[0], p.sphere[k].x[1]);
  data << "\nVelocities\n\n";
  for (std::size_t k = 0; k < p.sphere.size(); ++k)
    data << fmt::format("{} {:.17g} {:.17g} 0 0 0 {:.17g}\n", k + 1, p.velocity[k][0], p.velocity[k][1], p.spin[k][0]);
}

/// Disks of LAMMPS that go straight on with what they were given, and the forces of every step.
std::vector<std::string> straight_on(const std::string& before_reading, const std::string& lists, int steps) {
  return {"units si",
          "dimension 2",
          "atom_style sphere",
          "boundary f f p",
          "newton off",
          "comm_modify vel yes",
          "neighbor 0.005 multi",
          "neigh_modify every 1 delay 0 " + lists,
          before_reading,
          "read_data disks.data",
          "set type * density/disc 1000",
          "pair_style softgrain soft none",
          "pair_coeff * * laws.toml plain",
          "pair_coeff 2 2 laws.toml sliding",
          "pair_coeff 3 3 laws.toml rolling",
          "fix move all nve/noforce",
          "timestep 1e-5",
          "run " + std::to_string(steps)};
}

void go_straight_on(System<2>& s, int steps) {
  auto& p = s.particles;
  for (int k = 0; k < steps; ++k) {
    for (std::size_t u = 0; u < p.sphere.size(); ++u) p.sphere[u].x += p.velocity[u] * kStep;
    force_pass(s, kStep, History::advance);
  }
}

/// Force in the plane and moment out of it.
struct Load {
  Vec2 force{};
  double moment = 0.0;
};

/// Returns how many of ours are turned by a moment.
int expect_ours(const System<2>& ours, const std::map<int, Load>& theirs, double tolerance) {
  const auto& p = ours.particles;
  EXPECT_EQ(theirs.size(), p.sphere.size());
  int turned = 0;
  for (const auto& [tag, load] : theirs) {
    const auto u = static_cast<std::size_t>(tag - 1);
    const double own = norm(p.force[u]) + std::abs(p.torque[u][0]) / p.sphere[u].r;
    EXPECT_LE(norm(load.force - p.force[u]), tolerance * own) << tag;
    EXPECT_LE(std::abs(load.moment - p.torque[u][0]), tolerance * own * p.sphere[u].r) << tag;
    turned += p.torque[u][0] != 0.0 ? 1 : 0;
  }
  return turned;
}

std::map<int, Load> loads_of(InProcess& lammps) {
  std::map<int, Load> out;
  const auto& atoms = lammps.atoms();
  for (int i = 0; i < atoms.nlocal; ++i) {
    EXPECT_EQ(atoms.f[i][2], 0.0);
    out[atoms.tag[i]] = {{{atoms.f[i][0], atoms.f[i][1]}}, atoms.torque[i][2]};
  }
  return out;
}

TEST(Disks, ForcesAndMomentsAreOurs) {
  const TemporaryDirectory directory;
  System<2> ours = make_disks();
  write_disks(ours, directory.path());
  InProcess lammps;
  lammps("shell cd " + directory.path());
  for (const std::string& line : straight_on("", "check yes", 5)) lammps(line);
  go_straight_on(ours, 5);
  int pulled = 0;
  for (const ContactRecord<2>& c : contact_records(ours)) pulled += c.overlap < 0.0 ? 1 : 0;
  EXPECT_GT(expect_ours(ours, loads_of(lammps), 1e-13), 100);
  EXPECT_GT(pulled, 50);
}

/// Where atoms are sorted, or handed from rank to rank, the second of a pair may become the first: springs and angles
/// of rolling are then seen from the other side.
TEST(Disks, HistoriesGoOnWhenPairsChangeTheirOrder) {
  constexpr int kSteps = 300;
  System<2> ours = make_disks();
  const TemporaryDirectory directory;
  write_disks(ours, directory.path());
  go_straight_on(ours, kSteps);
  {
    InProcess lammps;
    lammps("shell cd " + directory.path());
    for (const std::string& line : straight_on("atom_modify sort 2 0.01", "check no", kSteps)) lammps(line);
    EXPECT_GT(expect_ours(ours, loads_of(lammps), 1e-9), 100) << "sorted";
  }
  for (const int ranks : {1, 2}) {
    std::ofstream script(directory.path() + "/run.in");
    for (const std::string& line : straight_on("atom_modify sort 2 0.01", "check no", kSteps)) script << line << "\n";
    script << "write_dump all custom loads id fx fy tqz modify sort id format float %.17g\n";
    script.close();
    ASSERT_EQ(run_ranks(ranks, directory.path(), "-in run.in"), 0) << read_text(directory.path() + "/screen.txt");
    std::map<int, Load> loads;
    for (const auto& [tag, x] : read_dump(directory.path() + "/loads")) loads[tag] = {{{x.at(0), x.at(1)}}, x.at(2)};
    EXPECT_GT(expect_ours(ours, loads, 1e-9), 100) << ranks << " ranks";
  }
}

}  // namespace
}  // namespace softgrain::test
