// Cohesive disks in two dimensions, ours against the pair style.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "common/contact/law_file.h"
#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "tests/lammps/in_process.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {
namespace {

constexpr double kStep = 1e-5;
constexpr double kDensity = 1000.0;
constexpr std::size_t kClusters = 300;

std::vector<NamedLaw> disk_laws() {
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

TEST(Disks, ForcesAndMomentsAreOurs) {
  const TemporaryDirectory directory;
  System<2> ours = make_disks();
  write_disks(ours, directory.path());
  InProcess lammps;
  lammps("shell cd " + directory.path());
  for (const char* line : {"units si", "dimension 2", "atom_style sphere", "boundary f f p", "newton off",
                           "comm_modify vel yes", "neighbor 0.005 multi", "neigh_modify every 1 delay 0 check yes",
                           "read_data disks.data", "set type * density/disc 1000", "pair_style softgrain soft none",
                           "pair_coeff * * laws.toml plain", "pair_coeff 2 2 laws.toml sliding",
                           "pair_coeff 3 3 laws.toml rolling", "fix move all nve/noforce", "timestep 1e-5", "run 5"})
    lammps(line);
  auto& p = ours.particles;
  for (int k = 0; k < 5; ++k) {
    for (std::size_t u = 0; u < p.sphere.size(); ++u) p.sphere[u].x += p.velocity[u] * kStep;
    force_pass(ours, kStep, History::advance);
  }
  const auto& atoms = lammps.atoms();
  ASSERT_EQ(atoms.nlocal, p.grains);
  int pulled = 0;
  int turned = 0;
  for (int i = 0; i < atoms.nlocal; ++i) {
    const auto u = static_cast<std::size_t>(atoms.tag[i] - 1);
    const double own = norm(p.force[u]) + std::abs(p.torque[u][0]) / p.sphere[u].r;
    const Vec2 f{{atoms.f[i][0], atoms.f[i][1]}};
    EXPECT_LE(norm(f - p.force[u]), 1e-13 * own) << atoms.tag[i];
    EXPECT_LE(std::abs(atoms.torque[i][2] - p.torque[u][0]), 1e-13 * own * p.sphere[u].r) << atoms.tag[i];
    EXPECT_EQ(atoms.f[i][2], 0.0);
    turned += p.torque[u][0] != 0.0 ? 1 : 0;
  }
  for (const ContactRecord<2>& c : contact_records(ours)) pulled += c.overlap < 0.0 ? 1 : 0;
  EXPECT_GT(pulled, 50);
  EXPECT_GT(turned, 100);
}

}  // namespace
}  // namespace softgrain::test
