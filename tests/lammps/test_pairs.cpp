// Forces of random clusters under every law, ours against the pair style: the same functions, so the same numbers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/contact/law_set.h"
#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "compute.h"
#include "fix.h"
#include "modify.h"
#include "tests/lammps/in_process.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {
namespace {

constexpr double kDensity = 2000.0;
constexpr double kStep = 1e-5;

const Material kMaterial{"m", kDensity, 5e5, 0.3, false};

LostVolumeTable table(bool soft) {
  LostVolumeTable t;
  t.log_weight = MonotoneCurve({std::log(0.25), 0.0, std::log(4.0)}, {-0.9, -0.5, -0.1});
  if (!soft) t.exponent = MonotoneCurve({std::log(0.25), 0.0, std::log(4.0)}, {1.3, 1.2, 1.1});
  t.common_exponent = 1.25;
  t.plane_weight = 1.2;
  return t;
}

/// Laws of soft bodies with solid ones and with each other.
struct Family {
  std::string name;
  AnyLaw solid_solid;
  AnyLaw soft_solid;
  AnyLaw soft_soft;
};

template <Tangential kTangential, bool kDamped, bool kRolling = false>
Family hertz_family(const std::string& name, double friction, double restitution) {
  const HertzMindlin<kTangential, kDamped, kRolling> law{
      HertzCoefficients::of(kMaterial, kMaterial, friction, restitution, {kRolling ? 0.05 : 0.0, 0.8, 0.7})};
  return {name, law, law, law};
}

Family pair_family(double damping, Extrapolation beyond) {
  SoftContact law;
  law.delta = 0.01;
  law.normal = {0.8, 3.0, -0.8 * std::pow(0.01, 3.0)};
  law.tangential = {0.5, 2.0, -0.5 * 1e-4};
  law.modulus = 5e5;
  law.friction = 0.25;
  law.damping = damping;
  law.range = {0.05, beyond};
  SoftContact both = law;
  both.partner_is_soft = true;
  return {"soft", HertzMindlin<Tangential::none, false>{HertzCoefficients::of(kMaterial, kMaterial, 0.0, 1.0)}, law,
          both};
}

template <LawForm kLawForm, bool kUnloading, bool kRolling = false>
Family multi_contact_family(const std::string& name) {
  SoftMultiContact<kLawForm, kUnloading, kRolling> law;
  law.form.pressure = {0.8, 3.0, 0.02, {0.01, Extrapolation::clamp}};
  law.form.coupling = {0.8, 0.15, 0.1};
  law.partner = table(false);
  law.modulus = 5e5;
  law.friction = 0.3;
  law.kt_ratio = 0.4;
  law.unloading = 1.7;
  law.rolling = 0.01;
  law.rolling_friction = 0.05;
  SoftMultiContact<kLawForm, kUnloading, kRolling> both = law;
  both.partner = table(true);
  both.j_is_soft = true;
  return {name, HertzMindlin<Tangential::none, false>{HertzCoefficients::of(kMaterial, kMaterial, 0.0, 1.0)}, law,
          both};
}

std::vector<Family> families() {
  LinearSpring spring{2e3, 1e3, 0.4, 0.2};
  return {hertz_family<Tangential::mindlin, true>("mindlin", 0.3, 0.5),
          hertz_family<Tangential::rescaled, false>("rescaled", 0.2, 1.0),
          hertz_family<Tangential::none, true>("smooth", 0.0, 0.7),
          {"spring", spring, spring, spring},
          pair_family(0.1, Extrapolation::extrapolate),
          pair_family(0.0, Extrapolation::clamp),
          multi_contact_family<LawForm::pair, true>("crowd pair"),
          multi_contact_family<LawForm::isotropic, false>("isotropic"),
          multi_contact_family<LawForm::directional, true>("directional, unloading"),
          multi_contact_family<LawForm::directional, false, true>("directional, rolling"),
          hertz_family<Tangential::mindlin, true, true>("mindlin, rolling", 0.3, 0.5),
          hertz_family<Tangential::rescaled, false, true>("rescaled, rolling", 0.2, 1.0)};
}

/// Clusters of two to five bodies of one family far from each other, those of the first layer on a plane that moves.
struct Clusters {
  System3 system;
  std::vector<int> type;
  std::vector<LawFileEntry> laws;
  Vec3 high{};
};

constexpr std::size_t kClusters = 600;
const Vec3 kPlaneVelocity{{0.3, -0.2, 0.4}};

Clusters make_clusters() {
  Clusters out;
  System3& s = out.system;
  const auto all = families();
  const auto materials = static_cast<std::int32_t>(2 * all.size());
  s.materials.assign(2 * all.size() + 1, kMaterial);
  s.laws = LawSet(materials + 1);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(all.size()); ++f) {
    const Family& family = all[static_cast<std::size_t>(f)];
    const std::int32_t solid_solid = s.laws.add(family.solid_solid);  // planes are solid
    const std::int32_t soft_solid = s.laws.add(family.soft_solid);
    s.laws.use(2 * f, 2 * f, solid_solid);
    s.laws.use(2 * f, materials, solid_solid);
    s.laws.use(2 * f + 1, 2 * f, soft_solid, true);
    s.laws.set(2 * f, 2 * f + 1, mirrored(family.soft_solid), true);
    s.laws.use(2 * f + 1, materials, soft_solid);
    s.laws.set(2 * f + 1, 2 * f + 1, family.soft_soft);
    out.laws.emplace_back(std::to_string(f) + " solid-solid", family.solid_solid);
    out.laws.emplace_back(std::to_string(f) + " soft-solid", family.soft_solid);
    out.laws.emplace_back(std::to_string(f) + " soft-soft", family.soft_soft);
  }
  RandomStream random(3, RandomPurpose::test, 1);
  const auto signed_random = [&](double size) { return size * (2.0 * random.uniform() - 1.0); };
  const double spacing = 0.2;
  out.high = {{10 * spacing, 10 * spacing, 6 * spacing}};
  for (std::size_t n = 0; n < kClusters; ++n) {
    const auto family = static_cast<std::int32_t>(n % all.size());
    const Vec3 middle{{(static_cast<double>(n % 10) + 0.5) * spacing,
                       (static_cast<double>(n / 10 % 10) + 0.5) * spacing,
                       n < 100 ? 0.0 : (static_cast<double>(n / 100) + 0.5) * spacing}};
    const double first = 0.01 + 0.02 * random.uniform();
    const auto bodies = 2 + static_cast<int>(4.0 * random.uniform());
    for (int k = 0; k < bodies; ++k) {
      const double r = k == 0 ? first : 0.01 + 0.02 * random.uniform();
      Vec3 n_c{{signed_random(1.0), signed_random(1.0), n < 100 ? random.uniform() : signed_random(1.0)}};
      n_c *= 1.0 / norm(n_c);
      Vec3 x = middle + n_c * (k == 0 ? 0.0 : (first + r) * (1.0 - 0.08 * random.uniform()));
      if (n < 100 && k == 0) x[2] = r * (1.0 - 0.1 * random.uniform());
      if (n < 100 && k > 0) x[2] += first;
      NewBody<3> body = solid_sphere(x, r, kDensity, 2 * family + (random.uniform() < 0.5 ? 1 : 0));
      for (int d = 0; d < 3; ++d) {
        body.velocity[d] = signed_random(5.0);
        body.spin[d] = signed_random(100.0);
      }
      add_grain(s.particles, body);
      out.type.push_back(body.material + 1);
    }
  }
  NewBody<3> plane;
  plane.material = materials;
  plane.velocity = kPlaneVelocity;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
  return out;
}

void write_files(const Clusters& c, const std::string& directory) {
  std::ofstream(directory + "/laws.toml") << laws_text(c.laws);
  std::ofstream data(directory + "/clusters.data");
  const auto& p = c.system.particles;
  data << fmt::format("clusters\n\n{} atoms\n{} atom types\n-0.2 {} xlo xhi\n-0.2 {} ylo yhi\n-0.2 {} zlo zhi\n\n",
                      p.grains, 2 * families().size(), c.high[0] + 0.2, c.high[1] + 0.2, c.high[2] + 0.2);
  data << "Atoms # sphere\n\n";
  for (std::size_t k = 0; k < c.type.size(); ++k) {
    const auto& b = p.sphere[k];
    data << fmt::format("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", k + 1, c.type[k], 2.0 * b.r, kDensity,
                        b.x[0], b.x[1], b.x[2]);
  }
  data << "\nVelocities\n\n";
  for (std::size_t k = 0; k < c.type.size(); ++k) {
    const auto& v = p.velocity[k];
    const auto& w = p.spin[k];
    data << fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", k + 1, v[0], v[1], v[2], w[0], w[1],
                        w[2]);
  }
}

/// All but the laws between families: those never touch.
void set_up(InProcess& lammps, const std::string& directory) {
  const std::string laws = directory + "/laws.toml";
  for (const char* line : {"units si", "atom_style sphere", "boundary f f f", "newton off", "comm_modify vel yes",
                           "neighbor 0.005 multi", "neigh_modify every 1 delay 0 check yes"})
    lammps(line);
  lammps("read_data " + directory + "/clusters.data");
  std::string soft;
  std::string walls;
  const std::size_t count = families().size();
  for (std::size_t f = 0; f < count; ++f) {
    soft += fmt::format(" {}", 2 * f + 2);
    walls += fmt::format(" law {} {} \"{} solid-solid\" law {} {} \"{} soft-solid\"", 2 * f + 1, laws, f, 2 * f + 2,
                         laws, f);
  }
  lammps("pair_style softgrain soft" + soft);
  lammps("pair_coeff * * " + laws + " \"0 solid-solid\"");
  for (std::size_t f = 0; f < count; ++f) {
    lammps(fmt::format("pair_coeff {} {} {} \"{} solid-solid\"", 2 * f + 1, 2 * f + 1, laws, f));
    lammps(fmt::format("pair_coeff {} {} {} \"{} soft-solid\"", 2 * f + 1, 2 * f + 2, laws, f));  // turned round
    lammps(fmt::format("pair_coeff {} {} {} \"{} soft-soft\"", 2 * f + 2, 2 * f + 2, laws, f));
  }
  lammps(fmt::format("fix walls all softgrain/wall plane 0 0 0 0 0 1 move {} {} {}", kPlaneVelocity[0],
                     kPlaneVelocity[1], kPlaneVelocity[2]) +
         walls);
  lammps("fix move all nve/noforce");
  lammps("compute contacts all softgrain/contacts");
  lammps("thermo_style custom step c_contacts[1] f_walls[1]");
  lammps(fmt::format("timestep {:.17g}", kStep));
}

/// Bodies fly on as they are, contacts remember.
void fly(System3& s, int steps) {
  auto& p = s.particles;
  for (int k = 0; k < steps; ++k) {
    for (std::size_t u = 0; u < p.sphere.size(); ++u) p.sphere[u].x += p.velocity[u] * kStep;
    force_pass(s, kStep, History::advance);
  }
}

Vec3 vec(const double* a) { return {{a[0], a[1], a[2]}}; }

/// Forces of the families differ by orders of magnitude: each body is held to its own, but to no less than kLeast of
/// the largest of its family. Just above the threshold of a law the force is what two nearly equal powers differ by,
/// and its last digits are rounding.
constexpr double kRounding = 1e-13;
constexpr double kLeast = 1e-3;

class PairStyle : public ::testing::Test {
 protected:
  PairStyle() : clusters(make_clusters()) {
    write_files(clusters, directory.path());
    set_up(lammps, directory.path());
  }

  [[nodiscard]] std::size_t family_of(std::size_t body) const {
    return static_cast<std::size_t>(clusters.type[body] - 1) / 2;
  }
  /// Force on a body with its torque over the radius.
  [[nodiscard]] double own_force(std::size_t body) const {
    const auto& p = clusters.system.particles;
    return norm(p.force[body]) + norm(p.torque[body]) / p.sphere[body].r;
  }

  /// Largest difference of force (torque over radius) over the force on a body; see kLeast.
  double difference() {
    auto& atoms = lammps.atoms();
    const auto& p = clusters.system.particles;
    std::vector<double> largest(families().size(), 0.0);
    for (std::size_t u = 0; u < clusters.type.size(); ++u)
      largest[family_of(u)] = std::max(largest[family_of(u)], own_force(u));
    double worst = 0.0;
    for (int i = 0; i < atoms.nlocal; ++i) {
      const auto u = static_cast<std::size_t>(atoms.tag[i] - 1);
      const double off = norm(vec(atoms.f[i]) - p.force[u]) + norm(vec(atoms.torque[i]) - p.torque[u]) / p.sphere[u].r;
      if (own_force(u) > 0.0)
        worst = std::max(worst, off / std::max(own_force(u), kLeast * largest[family_of(u)]));
      else
        EXPECT_EQ(off, 0.0) << atoms.tag[i];
    }
    for (const double force : largest) EXPECT_GT(force, 0.0);
    return worst;
  }

  TemporaryDirectory directory;
  Clusters clusters;
  InProcess lammps;
};

TEST_F(PairStyle, ForcesOfAThousandPairsAreOurs) {
  fly(clusters.system, 5);
  lammps("run 5");
  const auto records = contact_records(clusters.system);
  ASSERT_GT(records.size(), 1000U);
  EXPECT_LT(difference(), kRounding);
}

TEST_F(PairStyle, AtTheStartToo) {
  force_pass(clusters.system, 0.0, History::none);
  lammps("run 0");
  EXPECT_LT(difference(), kRounding);
}

}  // namespace
}  // namespace softgrain::test
