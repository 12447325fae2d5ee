// One look at all contacts: depths, stored energy, and how far fitted laws are from what was measured.
#include "common/dynamics/contact_watch.h"

#include <gtest/gtest.h>

#include "common/contact/multi_contact_form.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/verlet.h"

namespace {

using namespace softgrain;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Two spheres of radii 1 and 0.5 with this overlap, centres along x.
System3 two_spheres(const AnyLaw& law, double overlap) {
  System3 s;
  s.materials.resize(2);
  s.laws = LawSet(2);
  s.laws.set(0, 1, law, true);
  add_grain(s.particles, {Vec3{}, 1.0, 2.0, 0.8, 0});
  add_grain(s.particles, {Vec3{{1.5 - overlap, 0.0, 0.0}}, 0.5, 0.25, 0.025, 1});
  return s;
}

SoftContact soft_law(LawRange range) {
  SoftContact law;
  law.normal = {2.0, 2.5, -2.0 * std::pow(0.1, 2.5)};
  law.delta = 0.1;
  law.modulus = 10.0;
  law.range = range;
  return law;
}

double stored_at(const AnyLaw& law, double overlap) {
  System3 s = two_spheres(law, overlap);
  force_pass(s, 0.0);
  const ContactWatch<3> watch = watch_contacts(s);
  EXPECT_TRUE(watch.energy_known);
  return watch.stored;
}

double force_at(const AnyLaw& law, double overlap) {
  System3 s = two_spheres(law, overlap);
  force_pass(s, 0.0);
  return -s.particles.force[0][0];
}

TEST(ContactWatch, TheElasticForceIsTheDerivativeOfWhatIsStored) {
  LinearSpring spring;
  spring.normal = 7.0;
  const AnyLaw laws[] = {hertz_law({3.0, 1.0, 0.0, 0.0}, false), spring, soft_law({}),
                         soft_law({0.2, Extrapolation::clamp})};
  for (const AnyLaw& law : laws)
    for (const double h : {0.05, 0.15, 0.3}) {
      constexpr double d = 1e-5;
      const double slope = (stored_at(law, h + d) - stored_at(law, h - d)) / (2.0 * d);
      EXPECT_NEAR(slope, force_at(law, h), 1e-7 * force_at(law, h) + 1e-12) << law.index() << " at " << h;
    }
}

TEST(ContactWatch, EnergyOfAnElasticObliqueImpactIsKept) {
  LinearSpring spring;
  spring.normal = 100.0;
  spring.tangential = 40.0;
  spring.friction = 50.0;  // never slides
  System3 s = two_spheres(spring, -0.01);
  s.particles.velocity[1] = Vec3{{-1.0, 0.6, 0.2}};
  VelocityVerlet<3> verlet(2e-4);
  verlet.initialise(s);
  const double start = kinetic_energy(s.particles);
  double stored = 0.0;
  // Until the spheres part: what the tangential spring holds then is lost.
  for (int k = 0; k < 1500; ++k) {
    verlet.step(s);
    const double now = watch_contacts(s).stored;
    if (now == 0.0 && stored > 0.0) break;
    stored = std::max(stored, now);
    ASSERT_NEAR(kinetic_energy(s.particles) + now, start, 3e-3 * start) << k;
  }
  EXPECT_GT(stored, 0.5 * start);
}

TEST(ContactWatch, FindsTheDeepestContactAndWhatIsBehindAPlane) {
  System3 s = two_spheres(hertz_law({3.0, 1.0, 0.0, 0.0}, false), 0.2);
  s.laws.set(0, 0, hertz_law({3.0, 1.0, 0.0, 0.0}, false));
  NewBody<3> plane;
  plane.x = Vec3{{0.0, 0.0, -0.1}};
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
  force_pass(s, 0.0);
  ContactWatch<3> watch = watch_contacts(s);
  EXPECT_NEAR(watch.overlap, 0.9, 1e-12) << "of the large sphere with the plane";
  EXPECT_EQ(watch.j, 2);
  EXPECT_TRUE(watch.behind_planes.empty());
  s.particles.sphere[2].x[2] = 0.05;
  force_pass(s, 0.0);
  watch = watch_contacts(s);
  EXPECT_EQ(watch.behind_planes, std::vector<Slot>{0});
}

TEST(ContactWatch, CountsPairLawsByOverlap) {
  const LawRange range{0.2, Extrapolation::error};
  System3 s = two_spheres(soft_law(range), 0.15);  // Delta 0.15: the soft one has radius 1
  force_pass(s, 0.0);
  LawUse use = watch_contacts(s).laws;
  EXPECT_EQ(use.evaluations, 1);
  EXPECT_EQ(use.beyond, 0);
  EXPECT_NEAR(use.max_range_ratio, 0.75, 1e-12);
  EXPECT_EQ(law_use_text(use), "");
  s = two_spheres(soft_law(range), 0.3);
  force_pass(s, 0.0);
  use = watch_contacts(s).laws;
  EXPECT_EQ(use.beyond, 1);
  EXPECT_EQ(use.rejected, 1);
  EXPECT_NE(law_use_text(use).find("1 of 1 uses of fitted laws beyond what was measured, up to 1.50 times"),
            std::string::npos)
      << law_use_text(use);
}

template <LawForm kLawForm>
LawUse multi_contact_use(Extrapolation beyond) {
  SoftMultiContact<kLawForm, false> law;
  law.form.pressure = {0.6, 2.5, 0.05, {0.02, beyond}};
  law.modulus = 10.0;
  System3 s = two_spheres(law, 0.3);
  force_pass(s, 0.0);
  return watch_contacts(s).laws;
}

TEST(ContactWatch, CountsMultiContactLawsByLostVolume) {
  const double volume = lens(0.3, 1.0 / 0.5).volume;
  for (const LawUse& use : {multi_contact_use<LawForm::pair>(Extrapolation::clamp),
                            multi_contact_use<LawForm::isotropic>(Extrapolation::clamp),
                            multi_contact_use<LawForm::directional>(Extrapolation::clamp)}) {
    EXPECT_EQ(use.evaluations, 1);
    EXPECT_NEAR(use.max_range_ratio, volume / 0.02, 1e-9);
    EXPECT_EQ(use.clamped, use.beyond);
    EXPECT_EQ(use.rejected, 0);
  }
}

TEST(ContactWatch, AClampedMultiContactLawKeepsItsPressure) {
  MultiContactPressure open{0.6, 2.5, 0.05};
  MultiContactPressure clamped = open;
  clamped.range = {0.1, Extrapolation::clamp};
  EXPECT_EQ(clamped.at(0.09).p, open.at(0.09).p);
  EXPECT_EQ(clamped.at(0.2).p, open.at(0.1).p);
  EXPECT_EQ(clamped.at(0.2).slope, 0.0);
  clamped.range = {0.1, Extrapolation::extrapolate};
  EXPECT_EQ(clamped.at(0.2).p, open.at(0.2).p);
}

TEST(ContactWatch, WhatIsNoNumberIsTheWorst) {
  LinearSpring spring;
  spring.normal = 7.0;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Slot lost : {0, 1}) {  // before and after the sound pair in the list
    System3 s = two_spheres(spring, 0.2);
    s.laws.set(0, 0, spring);
    add_grain(s.particles, {Vec3{{-1.7, 0.0, 0.0}}, 0.9, 2.0, 0.8, 0});
    force_pass(s, 0.0);
    ASSERT_EQ(s.contacts.size(), 2);
    s.particles.sphere[static_cast<std::size_t>(lost + 1)].x[2] = nan;
    EXPECT_TRUE(std::isnan(watch_contacts(s).overlap)) << lost;
  }
}

TEST(ContactWatch, UsesOfALawThatAreNoNumberLieBeyondIt) {
  System3 s = two_spheres(soft_law({0.2, Extrapolation::error}), 0.15);
  force_pass(s, 0.0);
  s.particles.sphere[1].x[2] = std::numeric_limits<double>::quiet_NaN();
  const LawUse use = watch_contacts(s).laws;
  EXPECT_EQ(use.beyond, 1);
  EXPECT_TRUE(std::isnan(use.max_range_ratio));
}

/// Multi-contact laws ask whether there is lost volume at all: not a number is not nothing.
template <LawForm kLawForm>
void expect_lost() {
  SoftMultiContact<kLawForm, false> law;
  law.form.pressure = {0.6, 2.5, 0.05};
  law.modulus = 10.0;
  System3 s = two_spheres(law, 0.3);
  force_pass(s, 0.0);
  ASSERT_GT(std::abs(s.particles.force[0][0]), 0.0);
  s.particles.sphere[1].x[2] = std::numeric_limits<double>::quiet_NaN();
  s.particles.force.assign(s.particles.force.size(), {});
  add_contact_forces(s, 0.0, History::none);
  EXPECT_TRUE(std::isnan(s.particles.force[0][0]));
}

TEST(ContactWatch, MultiContactLawsLoseNoNumber) {
  expect_lost<LawForm::pair>();
  expect_lost<LawForm::isotropic>();
  expect_lost<LawForm::directional>();
}

TEST(ContactWatch, LooksAndTouchesNothing) {
  System3 s = two_spheres(hertz_law({3.0, 1.0, 0.3, 0.4}, true), 0.2);
  s.particles.velocity[1] = Vec3{{0.0, 1.0, 0.0}};
  VelocityVerlet<3> verlet(1e-3);
  verlet.initialise(s);
  System3 watched = s;
  VelocityVerlet<3> other(1e-3);
  other.initialise(watched);
  for (int k = 0; k < 50; ++k) {
    verlet.step(s);
    other.step(watched);
    (void)watch_contacts(watched);
  }
  for (std::size_t u = 0; u < 2; ++u) {
    EXPECT_EQ(s.particles.sphere[u].x, watched.particles.sphere[u].x);
    EXPECT_EQ(s.particles.spin[u][2], watched.particles.spin[u][2]);
  }
}

}  // namespace
