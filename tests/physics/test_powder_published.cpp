// Method 1 against the published means [CP 3.4]: small packs in the default suite, the eight published packs in the
// label "slow".
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "common/core/parallel_tasks.h"
#include "common/core/statistics.h"
#include "microsim/powder/powder_analysis.h"
#include "microsim/powder/powder_assembly.h"

namespace softgrain {
namespace {

struct PublishedPack {
  bool cohesive, rolling;
  double mu;
  double fraction, fraction_error, z, z_error;
};

constexpr PublishedPack kGrains{false, false, 0.5, 0.811, 0.001, 2.607, 0.022};
constexpr PublishedPack kRollingPowder{true, true, 0.5, 0.688, 0.001, 2.971, 0.006};
constexpr std::array kPublished{PublishedPack{false, false, 0.15, 0.8262, 0.0007, 3.174, 0.012},
                                kGrains,
                                PublishedPack{false, true, 0.15, 0.8238, 0.0014, 3.160, 0.024},
                                PublishedPack{false, true, 0.5, 0.803, 0.002, 2.526, 0.021},
                                PublishedPack{true, false, 0.15, 0.727, 0.001, 3.345, 0.009},
                                PublishedPack{true, false, 0.5, 0.7232, 0.0012, 3.103, 0.006},
                                PublishedPack{true, true, 0.15, 0.710, 0.002, 3.253, 0.003},
                                kRollingPowder};

PowderSpec spec_of(const PublishedPack& pack) {
  PowderSpec spec;
  spec.cohesive = pack.cohesive;
  spec.solid_fraction = pack.cohesive ? 0.36 : 0.13;
  spec.friction = pack.mu;
  spec.rolling = pack.rolling;
  return spec;
}

struct MethodMeans {
  MeanError fraction;
  MeanError z;
  MeanError rumpf;
  MeanError branch;
};

MethodMeans method1(const PowderSpec& spec, std::uint64_t seed, std::int64_t samples) {
  std::vector<double> fraction(static_cast<std::size_t>(samples));
  std::vector<double> z(fraction);
  std::vector<double> rumpf(fraction);
  std::vector<double> branch(fraction);
  parallel_tasks(samples, [&](std::int64_t number) {
    const auto k = static_cast<std::size_t>(number);
    PowderState s = start_powder(spec, seed, k);
    const PowderResult r = run_powder(s, spec, powder_phases(spec, {}), {});
    EXPECT_TRUE(r.usable) << r.reason;
    const PowderContacts c = powder_contacts(s.system, kPowderZeroForce, spec.cohesive);
    fraction[k] = r.fraction;
    z[k] = c.coordination;
    rumpf[k] = c.rumpf_pressure / spec.stress();
    branch[k] = c.branch_pressure / spec.stress();
  });
  return {mean_error(fraction), mean_error(z), mean_error(rumpf), mean_error(branch)};
}

/// 400 disks with kappa = 1e4, four samples. Eight of them gave 0.6928(26) and 2.954(12) with cohesion, 0.8077(14) and
/// 2.714(22) without it, where softer contacts make more of them. A cell as light as 0.3 (sum m)/(L/a) ends at a
/// coordination of 2.6 with cohesion.
TEST(PowderPublished, SmallPacksAreAsDenseAndAsConnected) {
  const auto small = [](const PublishedPack& pack) {
    PowderSpec spec = spec_of(pack);
    spec.disks = 400;
    spec.stiffness = 1e4;
    return method1(spec, 11, 4);
  };
  const MethodMeans powder = small(kRollingPowder);
  EXPECT_NEAR(powder.fraction.mean, kRollingPowder.fraction, 0.014);
  EXPECT_NEAR(powder.z.mean, kRollingPowder.z, 0.07);
  EXPECT_NEAR(powder.branch.mean, 1.0, 0.01);
  const MethodMeans grains = small(kGrains);
  EXPECT_NEAR(grains.fraction.mean, kGrains.fraction, 0.010);
  EXPECT_NEAR(grains.z.mean, kGrains.z, 0.18);
  EXPECT_NEAR(grains.rumpf.mean, 1.0, 0.05);
  EXPECT_NEAR(grains.branch.mean, 1.0, 1e-3);
  EXPECT_GT(grains.fraction.mean, powder.fraction.mean + 0.08) << "published: 0.123";
  EXPECT_GT(powder.z.mean, grains.z.mean + 0.1) << "published: 0.36";
}

/// Solid fraction and coordination within two joint standard errors, or within 0.006 and 0.03.
TEST(SlowPowder, TheEightPublishedPacksComeOut) {
  for (const PublishedPack& p : kPublished) {
    const MethodMeans m = method1(spec_of(p), 1, 4);
    const std::string what = std::string(p.cohesive ? "cohesion" : "no cohesion") + (p.rolling ? ", rolling" : "") +
                             ", mu " + std::to_string(p.mu);
    EXPECT_NEAR(m.fraction.mean, p.fraction, std::max(2.0 * std::hypot(m.fraction.error, p.fraction_error), 0.006))
        << what;
    EXPECT_NEAR(m.z.mean, p.z, std::max(2.0 * std::hypot(m.z.error, p.z_error), 0.03)) << what;
    EXPECT_NEAR(m.branch.mean, 1.0, p.cohesive ? 0.01 : 1e-3) << what;
    if (!p.cohesive) {
      EXPECT_NEAR(m.rumpf.mean, 1.0, 0.05) << what;
    }
  }
}

}  // namespace
}  // namespace softgrain
