// Parts of a hierarchy: what fills the voids, shells inside shells, inner soft particles with all their grains.
#include <gtest/gtest.h>

#include <cmath>

#include "common/core/error.h"
#include "common/core/solid_sphere.h"
#include "common/dynamics/force_pass.h"
#include "common/neighbours/verlet_list.h"
#include "microsim/crowd_arrangements.h"
#include "pipelines/kinds/hierarchy/level.h"
#include "tests/support/crowd.h"
#include "tests/support/synthetic_crowd.h"

namespace softgrain {
namespace {

HierarchySetup setup_of(double r_min, double r_max) {
  HierarchySetup setup;
  setup.crowd.spec = test::coarse_spec();
  setup.voids.r_max = r_max;
  setup.voids.r_min = r_min;
  return setup;
}

TEST(FillLevel, InnerSoftParticlesLieInTheVoids) {
  const HierarchySetup setup = setup_of(0.08, 0.16);
  for (std::uint64_t index = 0; index < 3; ++index) {
    const ShellPacking packing = generate_shell_packing(setup.crowd.spec, 1, index);
    const SoftContent content = fill_level(setup, packing);
    ASSERT_GT(content.inner.size(), 3U);
    EXPECT_TRUE(content.inner_packings.empty());
    for (std::size_t a = 0; a < content.inner.size(); ++a) {
      const InnerSoft& inner = content.inner[a];
      EXPECT_GE(inner.r, 0.08);
      EXPECT_LE(inner.r, 0.16);
      EXPECT_LE(norm(inner.x) + inner.r, 1.0 + 1e-9);
      for (std::size_t k = 0; k < packing.radius.size(); ++k)
        EXPECT_GE(norm(inner.x - packing.position[k]), inner.r + packing.radius[k] - 1e-9);
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_GE(norm(inner.x - content.inner[b].x), inner.r + content.inner[b].r - 1e-9);
      if (a > 0) {
        EXPECT_LE(inner.r, content.inner[a - 1].r * 1.01) << "largest hole first";
      }
    }
    EXPECT_EQ(fill_level(setup, packing).inner.size(), content.inner.size());
  }
}

TEST(FillLevel, TheCountIsALimit) {
  HierarchySetup setup = setup_of(0.05, 0.16);
  setup.voids.count = 2;
  EXPECT_EQ(fill_level(setup, generate_shell_packing(setup.crowd.spec, 1, 0)).inner.size(), 2U);
  setup = setup_of(0.9, 0.95);
  EXPECT_TRUE(fill_level(setup, generate_shell_packing(setup.crowd.spec, 1, 0)).inner.empty());
}

TEST(LawDistance, IsZeroForTheSameLawAndGrowsWithTheDifference) {
  const LawTableEntry a = synthetic::law_entry();
  LawTableEntry b = a;
  EXPECT_EQ(law_distance(a, b, Crowd::directional), 0.0);
  for (CrowdLaw& law : b.laws) law.a.value *= 1.1;
  EXPECT_NEAR(law_distance(b, a, Crowd::directional), 0.1, 1e-9);
  EXPECT_NEAR(law_distance(b, a, Crowd::pair), 0.1, 1e-9);
}

/// Shell A of radius 1, shell B of radius 0.5 in it that reaches through its wall, grains in B. `inner_first`: B has
/// the lower slot.
System3 nested(bool inner_first, const std::vector<double>& places) {
  System3 s;
  s.materials = {{"grain", 2500.0, 1e6, 0.3, false}, {"wall", 2500.0, 1e6, 0.3, false}};
  s.laws = LawSet(2);
  s.laws.set(0, 1, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 0.3, 1.0), false));
  const auto grains = static_cast<Slot>(places.size());
  const Slot a = inner_first ? grains + 1 : grains;
  const Slot b = inner_first ? grains : grains + 1;
  for (const double x : places) {
    NewBody<3> grain = solid_sphere({{x, 0.0, 0.0}}, 0.1, 2500.0, 0);
    grain.shell = b;
    add_grain(s.particles, grain);
  }
  for (const Slot slot : {grains, grains + 1}) {
    NewBody<3> shell = solid_sphere({{slot == b ? 0.55 : 0.0, 0.0, 0.0}}, slot == b ? 0.5 : 1.0, 1000.0, 1);
    if (slot == b) shell.shell = a;
    add_shell(s.particles, shell);
  }
  return s;
}

TEST(NestedShells, AGrainMeetsBoth) {
  for (const bool inner_first : {false, true}) {
    System3 s = nested(inner_first, {0.96, 0.50, 0.951});
    force_pass(s, 0.0);
    const auto& list = s.contacts;
    for (std::int32_t k = 1; k < list.size(); ++k) {
      const auto u = static_cast<std::size_t>(k);
      EXPECT_TRUE(list.i[u - 1] < list.i[u] || (list.i[u - 1] == list.i[u] && list.j[u - 1] < list.j[u])) << k;
    }
    ASSERT_EQ(contact_records(s).size(), 4U);  // two grains that meet both
    const std::size_t a = inner_first ? 4 : 3;
    const std::size_t b = inner_first ? 3 : 4;
    const Vec3 on_a = s.particles.force[a];
    const Vec3 on_b = s.particles.force[b];
    const Vec3 on_grain = s.particles.force[0];
    const Vec3 on_last = s.particles.force[2];
    EXPECT_GT(on_a[0], on_b[0]) << "the deeper contact is the stronger one";
    EXPECT_GT(on_b[0], 0.0);
    EXPECT_LT(norm(on_a + on_b + on_grain + on_last), 1e-12 * norm(on_a));
    EXPECT_EQ(norm(static_cast<Vec3>(s.particles.force[1])), 0.0);
  }
}

TEST(NestedShells, ALostGrainIsFoundInEitherShell) {
  System3 s = nested(false, {1.15});  // beyond both walls by more than its radius
  EXPECT_THROW(force_pass(s, 0.0), NotUsable);
  System3 inner = nested(true, {-0.2});  // in the outer shell, out of the inner one
  EXPECT_THROW(force_pass(inner, 0.0), NotUsable);
  System3 fine = nested(true, {0.3});
  EXPECT_NO_THROW(force_pass(fine, 0.0));
}

/// Two inner soft particles that hold their grains.
class ResolvedInner : public ::testing::Test {
 protected:
  ResolvedInner() {
    spec_ = test::coarse_spec();
    HierarchySetup setup = setup_of(0.1, 0.3);
    setup.crowd.spec = spec_;
    setup.voids.count = 2;
    content_ = fill_level(setup, generate_shell_packing(spec_, 1, 0));
    for (std::uint64_t k = 0; k < 2; ++k) content_.inner_packings.push_back(generate_shell_packing(spec_, 1, 100 + k));
    laws_ = inner_laws(setup, synthetic::law_entry());
  }
  CrowdExperiment make(Arrangement arranged, double overlap) {
    return make_crowd(spec_, test::crowd_of(PartnerKind::plane, 0.0, directions_of(arranged), overlap), content_, {},
                      &laws_);
  }

  SoftParticleSpec spec_;
  SoftContent content_;
  InnerLaws laws_;
};

TEST_F(ResolvedInner, CountsAndMasses) {
  ASSERT_EQ(content_.inner.size(), 2U);
  const CrowdExperiment e = make(Arrangement::opposite, 0.2);
  const auto& p = e.system.particles;
  std::size_t grains = content_.grains.radius.size();
  for (const ShellPacking& inner : content_.inner_packings) grains += inner.radius.size();
  EXPECT_EQ(p.grains, static_cast<Slot>(grains));
  EXPECT_EQ(e.centre_bodies, p.grains);
  EXPECT_EQ(p.shells, 3);
  EXPECT_EQ(p.planes, 2);
  Slot begin = static_cast<Slot>(content_.grains.radius.size());
  for (std::size_t k = 0; k < 2; ++k) {
    const auto shell = static_cast<std::size_t>(e.centre_shell) + 1 + k;
    const double r = content_.inner[k].r * spec_.shell_radius;
    const double mass = spec_.density * content_.inner_packings[k].solid_fraction() * kSphereVolume * r * r * r;
    EXPECT_EQ(p.sphere[shell].r, r);
    EXPECT_NEAR(1.0 / p.inverse_mass[shell], mass, 1e-12 * mass);
    EXPECT_EQ(p.shell[shell], e.centre_shell);
    double content = 0.0;
    for (const double y : content_.inner_packings[k].radius) {
      const auto u = static_cast<std::size_t>(begin++);
      EXPECT_EQ(p.shell[u], static_cast<Slot>(shell));
      EXPECT_NEAR(p.sphere[u].r, y * r, 1e-15);
      EXPECT_LE(norm(p.sphere[u].x - p.sphere[shell].x), r);
      content += 1.0 / p.inverse_mass[u];
    }
    EXPECT_NEAR(content, mass, 1e-9 * mass) << "the shell weighs what it holds";
  }
  EXPECT_EQ(p.inverse_mass[static_cast<std::size_t>(e.centre_shell)], 0.0);
}

TEST_F(ResolvedInner, ForcesBalance) {
  CrowdExperiment e = make(Arrangement::opposite, 0.25);
  CrowdOptions options;
  options.tolerance = 1e-3;
  const CrowdRun run = run_crowd(e, {{1.0}}, options);
  ASSERT_TRUE(run.points[0].converged);
  EXPECT_GT(run.points[0].normal[0], 1e-3);
  force_pass(e.system, 0.0);
  const auto& p = e.system.particles;
  Vec3 sum{};
  for (std::size_t u = 0; u < p.force.size(); ++u) sum += p.force[u];
  const double largest = run.points[0].normal[0] * spec_.youngs_modulus * spec_.shell_radius * spec_.shell_radius;
  EXPECT_LT(norm(sum), 1e-12 * largest);
  for (Slot shell = e.centre_shell + 1; shell < e.centre_shell + 3; ++shell)
    EXPECT_LT(norm(static_cast<Vec3>(p.force[static_cast<std::size_t>(shell)])), 1e-2 * largest);
}

TEST_F(ResolvedInner, OnlyTheCentreHoldsThem) {
  const CrowdConfiguration c = test::crowd_of(PartnerKind::soft, 1.0, directions_of(Arrangement::one), 0.2);
  EXPECT_THROW((void)make_crowd(spec_, c, content_, {&content_}, &laws_), BadInput);
}

}  // namespace
}  // namespace softgrain
