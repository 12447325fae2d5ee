// Parts of a hierarchy: what a level holds, shells inside shells, inner soft particles with all their grains.
#include <gtest/gtest.h>

#include <cmath>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/data/multi_contact_replicates.h"
#include "common/dynamics/force_pass.h"
#include "common/neighbours/verlet_list.h"
#include "common/packing/void_filling.h"
#include "microsim/filled_shell.h"
#include "microsim/multi_contact_arrangements.h"
#include "pipelines/kinds/hierarchy/level.h"
#include "tests/support/known_multi_contact.h"
#include "tests/support/multi_contact.h"

namespace softgrain {
namespace {

HierarchySetup setup_of(double inner_radius) {
  HierarchySetup setup;
  setup.multi_contact.spec = test::coarse_spec();
  setup.inner_radius = inner_radius;
  setup.next_volume = next_volume(setup.multi_contact.spec.exponent, setup.multi_contact.spec.polydispersity);
  return setup;
}

double volume_of(const std::vector<InnerSoft>& inner) {
  double sum = 0.0;
  for (const InnerSoft& s : inner) sum += cube(s.r);
  return sum;
}

/// No sphere overlaps another one or the shell, and each of them touches something.
void expect_touching(const std::vector<PackedSphere>& spheres) {
  for (std::size_t a = 0; a < spheres.size(); ++a) {
    double room = 1.0 - norm(spheres[a].x) - spheres[a].r;
    for (std::size_t b = 0; b < spheres.size(); ++b)
      if (b != a) room = std::min(room, norm(spheres[a].x - spheres[b].x) - spheres[a].r - spheres[b].r);
    EXPECT_NEAR(room, 0.0, 1e-12) << a;
  }
}

TEST(NextVolume, IsThatOfTheDistribution) {
  EXPECT_NEAR(next_volume(3.5, 10.0), std::sqrt(0.1), 1e-15);
  // Integrals of r^3 r^-b over both ranges.
  for (const double b : {2.8, 3.5, 4.3}) {
    const auto volume = [b](double low, double high) { return std::pow(high, 4.0 - b) - std::pow(low, 4.0 - b); };
    EXPECT_NEAR(next_volume(b, 5.0), volume(0.2, 1.0) / volume(1.0, 5.0), 1e-12) << b;
  }
}

TEST(FillShell, SoftParticlesHoldTheMassOfTheNextLevel) {
  const HierarchySetup setup = setup_of(0.125);
  constexpr double kGrainsBelow = 0.7;
  for (std::uint64_t index = 0; index < 3; ++index) {
    const ShellPacking published = generate_shell_packing(setup.multi_contact.spec, 1, index);
    const ShellFilling filling{setup.inner_radius, setup.next_volume / kGrainsBelow, 0.05};
    const SoftContent content = fill_shell(setup.multi_contact.spec, filling, published, 1);
    const double grains = content.grains.solid_fraction();
    const double soft = volume_of(content.inner);
    const double one = cube(setup.inner_radius);
    EXPECT_NEAR(soft * kGrainsBelow / grains, setup.next_volume, 0.06) << "one soft particle is " << one / grains;
    const double packed = grains + cube(0.95) * soft;
    EXPECT_LE(packed, published.solid_fraction() * 1.03);
    EXPECT_GE(packed, 0.55);
    std::vector<PackedSphere> all;
    for (std::size_t k = 0; k < content.grains.radius.size(); ++k)
      all.push_back({content.grains.position[k], content.grains.radius[k]});
    for (const InnerSoft& s : content.inner) all.push_back({s.x, 0.95 * s.r});  // at their onset
    expect_touching(all);
    const SoftContent again = fill_shell(setup.multi_contact.spec, filling, published, 1);
    ASSERT_EQ(again.inner.size(), content.inner.size());
    EXPECT_EQ(again.inner.front().x, content.inner.front().x);
    EXPECT_NE(fill_shell(setup.multi_contact.spec, filling, published, 2).inner.front().x, content.inner.front().x);
  }
}

TEST(FillHoles, InnerSoftParticlesLieInTheVoids) {
  HierarchySetup setup = setup_of(0.16);
  setup.inner_radius_min = 0.08;
  for (std::uint64_t index = 0; index < 3; ++index) {
    const ShellPacking packing = generate_shell_packing(setup.multi_contact.spec, 1, index);
    const SoftContent content = fill_holes(setup, {0.16, 10.0, 0.0}, packing);
    ASSERT_GT(content.inner.size(), 3U);
    EXPECT_EQ(content.grains.radius, packing.radius);
    for (std::size_t a = 0; a < content.inner.size(); ++a) {
      const InnerSoft& inner = content.inner[a];
      EXPECT_GE(inner.r, 0.08);
      EXPECT_LE(inner.r, 0.16);
      EXPECT_LE(norm(inner.x) + inner.r, 1.0 + 1e-9);
      for (std::size_t k = 0; k < packing.radius.size(); ++k)
        EXPECT_GE(norm(inner.x - packing.position[k]), inner.r + packing.radius[k] - 1e-9);
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_GE(norm(inner.x - content.inner[b].x), inner.r + content.inner[b].r - 1e-9);
    }
    // No more than their mass, but for the last one.
    const double wanted = 0.5 * volume_of(content.inner) / packing.solid_fraction();
    const SoftContent less = fill_holes(setup, {0.16, wanted, 0.0}, packing);
    EXPECT_GE(volume_of(less.inner), 0.5 * volume_of(content.inner));
    EXPECT_LE(volume_of(less.inner), 0.5 * volume_of(content.inner) + cube(0.16));
  }
}

TEST(CompactInShell, GrowsToTheRadiiWhereThereIsRoom) {
  RandomStream random(1, RandomPurpose::test, 0);
  const std::vector<double> few(60, 0.18);  // 0.35 of the volume
  const CompactedShell loose = compact_in_shell(few, random);
  EXPECT_EQ(loose.share, 1.0);
  for (const double r : loose.packing.radius) EXPECT_NEAR(r, 0.18, 0.18 * 2e-3);
  const std::vector<double> many(300, 0.15);  // 1.01 of it
  const CompactedShell jammed = compact_in_shell(many, random);
  EXPECT_LT(jammed.share, 0.9);
  // Equal spheres jam at 0.64, less beside a wall seven of them across.
  EXPECT_GT(jammed.packing.solid_fraction(), 0.50);
  EXPECT_LT(jammed.packing.solid_fraction(), 0.66);
  EXPECT_THROW((void)compact_in_shell({}, random), InputError);
  EXPECT_THROW((void)compact_in_shell({1.2}, random), InputError);
}

TEST(LevelErrors, TheOnsetIsWhereSixPlanesBegin) {
  const LawTableEntry entry = synthetic::law_entry();
  const MultiContactLaw& law = *entry.find(LawForm::isotropic);
  const double onset = law_onset(law, 0.28);
  const MultiContactModel model = multi_contact_model(law);
  const auto force = [&](double x) { return multi_contact_forces(model, six_planes(), std::vector<double>(6, x))[0]; };
  EXPECT_GT(onset, 0.01);
  EXPECT_LT(onset, law.delta.value);
  EXPECT_EQ(force(onset * (1.0 - 1e-6)), 0.0);
  EXPECT_GT(force(onset * (1.0 + 1e-6)), 0.0);
}

TEST(LevelErrors, DrawsOfTheLawBelowGoIntoThoseOfTheLevel) {
  LawTableEntry below = synthetic::law_entry();
  for (MultiContactLaw& law : below.laws)
    for (const double factor : {0.8, 1.0, 1.25}) {
      law.replicates.push_back(multi_contact_numbers(law));
      law.replicates.back()[0] *= factor;
    }
  const std::vector<double> draws = strength_draws(below, LawForm::isotropic, 0.5);
  ASSERT_EQ(draws.size(), 3U);
  EXPECT_NEAR(draws[0], std::sqrt(0.8), 1e-12);
  EXPECT_NEAR(draws[1], 1.0, 1e-12);
  EXPECT_NEAR(draws[2], std::sqrt(1.25), 1e-12);
  LawTableEntry level = synthetic::law_entry();
  for (MultiContactLaw& law : level.laws) law.replicates.assign(6, multi_contact_numbers(law));
  EXPECT_NEAR(strength_error(level, LawForm::isotropic), 0.0, 1e-12);
  const Estimate before = level.find(LawForm::isotropic)->a;
  spread(level, draws);
  EXPECT_NEAR(level.find(LawForm::isotropic)->replicates[3][0], before.value * std::sqrt(0.8), 1e-12);
  EXPECT_GT(level.find(LawForm::isotropic)->a.standard_error, before.standard_error);
  EXPECT_GT(strength_error(level, LawForm::isotropic), 0.08);
  EXPECT_NEAR(law_strength(*scaled_law(below, 1.25).find(LawForm::isotropic), 0.2),
              1.25 * law_strength(*below.find(LawForm::isotropic), 0.2), 1e-12);
}

/// Orientations of one packing are one sample, and a configuration that bears nothing says nothing.
TEST(LevelChange, CountsPackingsAndWhatBearsForce) {
  synthetic::MultiContactOptionsKnown o;
  o.noise = 0.1;
  const std::vector<MultiContactConfiguration> list{
      synthetic::multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3),
      synthetic::multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.01)};
  const MultiContactModel model = synthetic::known(LawForm::isotropic);
  MultiContactMeasurements below = synthetic::multi_contact_measurements(model, list, o);
  o.noise = 0.0;
  MultiContactMeasurements above = synthetic::multi_contact_measurements(model, list, o);
  const auto once = level_change(above, below, 0);
  ASSERT_TRUE(once);
  EXPECT_GT(once->error, 0.0);
  EXPECT_FALSE(level_change(above, below, 1)) << "below its threshold";
  for (MultiContactMeasurements* data : {&above, &below}) {
    const std::vector<MultiContactRun> runs = data->runs;
    for (MultiContactRun run : runs) {
      run.orientation = 1;
      data->runs.push_back(run);
    }
  }
  const auto twice = level_change(above, below, 0);
  ASSERT_TRUE(twice);
  EXPECT_NEAR(twice->ratio, once->ratio, 1e-12);
  EXPECT_NEAR(twice->error, once->error, 1e-12);
}

TEST(LawDistance, IsZeroForTheSameLawAndGrowsWithTheDifference) {
  const LawTableEntry a = synthetic::law_entry();
  LawTableEntry b = a;
  EXPECT_EQ(law_distance(a, b, LawForm::directional), 0.0);
  for (MultiContactLaw& law : b.laws) law.a.value *= 1.1;
  EXPECT_NEAR(law_distance(b, a, LawForm::directional), 0.1, 1e-9);
  EXPECT_NEAR(law_distance(b, a, LawForm::pair), 0.1, 1e-9);
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
  EXPECT_THROW(force_pass(s, 0.0), UnusableResult);
  System3 inner = nested(true, {-0.2});  // in the outer shell, out of the inner one
  EXPECT_THROW(force_pass(inner, 0.0), UnusableResult);
  System3 fine = nested(true, {0.3});
  EXPECT_NO_THROW(force_pass(fine, 0.0));
}

/// Two inner soft particles that hold their grains.
class ResolvedInner : public ::testing::Test {
 protected:
  ResolvedInner() {
    spec_ = test::coarse_spec();
    const HierarchySetup setup = setup_of(0.2);
    content_ = fill_shell(spec_, {0.2, 0.025, 0.0}, generate_shell_packing(spec_, 1, 0), 1);
    for (std::uint64_t k = 0; k < 2; ++k) content_.inner_packings.push_back(generate_shell_packing(spec_, 1, 100 + k));
    laws_ = inner_laws(setup, synthetic::law_entry());
  }
  MultiContactExperiment make(Arrangement arranged, double overlap) {
    return make_multi_contact(spec_, test::multi_contact_of(PartnerKind::plane, 0.0, directions_of(arranged), overlap),
                              content_, {}, &laws_);
  }

  SoftParticleSpec spec_;
  SoftContent content_;
  InnerLaws laws_;
};

TEST_F(ResolvedInner, CountsAndMasses) {
  ASSERT_EQ(content_.inner.size(), 2U);
  const MultiContactExperiment e = make(Arrangement::opposite, 0.2);
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
  MultiContactExperiment e = make(Arrangement::opposite, 0.25);
  MultiContactOptions options;
  options.tolerance = 1e-3;
  const MultiContactRun run = run_multi_contact(e, {{1.0}}, options);
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
  const MultiContactConfiguration c =
      test::multi_contact_of(PartnerKind::soft, 1.0, directions_of(Arrangement::one), 0.2);
  EXPECT_THROW((void)make_multi_contact(spec_, c, content_, {&content_}, &laws_), InputError);
}

}  // namespace
}  // namespace softgrain
