// A pair whose bodies change places in the order is the same contact seen from the other side: same law, same force,
// same history, whatever the law calls i and j.
#include <algorithm>
#include <cmath>

#include "common/contact/law_set.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/verlet.h"
#include "common/neighbours/spatial_order.h"
#include "common/neighbours/verlet_list.h"
#include "tests/support/small_packing.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Laws of the materials 0 (solid) and 1 (soft): `mixed` has its first body soft where it matters.
struct Pairing {
  const char* name;
  AnyLaw solid;
  AnyLaw mixed;
  AnyLaw soft;
};

constexpr double kModulus = 1e5;

SoftContact contact_law(bool partner_is_soft) {
  SoftContact law;
  law.normal = {0.8, 2.2, -0.8 * std::pow(0.02, 2.2)};
  law.tangential = {0.5, 1.2, -0.5 * std::pow(0.02, 1.2)};
  law.delta = 0.02;
  law.modulus = kModulus;
  law.friction = 0.4;
  law.damping = 0.1;
  law.partner_is_soft = partner_is_soft;
  return law;
}

template <LawForm kLawForm, bool kUnloading, bool kRolling>
SoftMultiContact<kLawForm, kUnloading, kRolling> multi_contact_law(bool partner_is_soft) {
  SoftMultiContact<kLawForm, kUnloading, kRolling> law;
  law.form.pressure = {0.8, 2.0, 0.001};
  if (kLawForm == LawForm::directional) law.form.coupling = {0.8, 0.15, 0.1};
  law.partner.log_weight = MonotoneCurve({std::log(0.25), 0.0, std::log(4.0)}, {-0.9, -0.5, -0.1});
  if (!partner_is_soft) law.partner.exponent = MonotoneCurve({std::log(0.25), 0.0, std::log(4.0)}, {1.3, 1.2, 1.1});
  law.partner.common_exponent = 1.2;
  law.modulus = kModulus;
  law.friction = 0.4;
  law.kt_ratio = 0.5;
  law.unloading = 1.7;
  law.rolling = 0.1;
  law.rolling_friction = 0.1;
  law.j_is_soft = partner_is_soft;
  return law;
}

template <LawForm kLawForm, bool kUnloading, bool kRolling = false>
Pairing multi_contact_pairing(const char* name, const AnyLaw& solid) {
  return {name, solid, multi_contact_law<kLawForm, kUnloading, kRolling>(false),
          multi_contact_law<kLawForm, kUnloading, kRolling>(true)};
}

AnyLaw hertz(bool rescaled, const RollingResistance& rolling = {}) {
  Material m = glass();
  m.youngs_modulus = kModulus;
  return hertz_law(HertzCoefficients::of(m, m, 0.4, 0.7, rolling), rescaled);
}

std::vector<Pairing> pairings(std::integral_constant<int, 3>) {
  LinearSpring spring;
  spring.normal = 500.0;
  spring.tangential = 300.0;
  spring.friction = 0.4;
  spring.damping = 0.1;
  const RollingResistance rolling{0.01, 0.8, 0.7};
  return {{"hertz", hertz(false), hertz(true), spring},
          {"hertz that rolls", hertz(false, rolling), hertz(true, rolling),
           LinearSpringLaw<true>{500.0, 300.0, 0.4, 0.1, rolling}},
          {"soft contact", hertz(true), contact_law(false), contact_law(true)},
          multi_contact_pairing<LawForm::pair, true>("multi-contact: pair", hertz(false)),
          multi_contact_pairing<LawForm::isotropic, false>("multi-contact: isotropic", hertz(false)),
          multi_contact_pairing<LawForm::directional, true>("multi-contact: directional", spring),
          multi_contact_pairing<LawForm::isotropic, false, true>("multi-contact: isotropic that rolls", hertz(false))};
}

std::vector<Pairing> pairings(std::integral_constant<int, 2>) {
  const CohesiveDisk<true, true> rolling{500.0, 300.0, 0.4, 0.1, 2.0, 0.02, 3.0, 0.01};
  const CohesiveDisk<true, false> sliding{500.0, 300.0, 0.4, 0.1, 2.0, 0.02, 0.0, 0.0};
  return {{"rolling disks", rolling, rolling, sliding}, {"soft contact", hertz(true), contact_law(false), rolling}};
}

/// Overlapping grains of unequal radii, soft and solid in turn, with walls; they move and spin.
template <int D>
System<D> multi_contact(const Pairing& laws) {
  System<D> s;
  s.materials = {glass(), glass(), glass()};
  s.laws = LawSet(3);
  s.laws.set(0, 0, laws.solid);
  s.laws.set(1, 0, laws.mixed, true);
  s.laws.set(0, 1, mirrored(laws.mixed), true);
  s.laws.set(1, 1, laws.soft);
  s.laws.set(0, 2, laws.solid);
  s.laws.set(1, 2, laws.mixed);
  Vec<D> size;
  std::array<bool, D> periodic{};
  for (double& e : size.v) e = 1.2;
  periodic.fill(true);
  periodic[D - 1] = false;
  s.cell = box_cell<D>(size, periodic);
  RandomStream random(6, RandomPurpose::test, 2);
  Vec<D> middle;
  for (double& x : middle.v) x = 0.6;
  for (const Vec<D>& x : shaken_lattice<D>(middle, 0.2, 6, 5)) {
    NewBody<D> grain = test_sphere<D>(x, 0.08 + 0.05 * random.uniform(), 2500.0);
    for (double& v : grain.velocity.v) v = 0.4 * (2.0 * random.uniform() - 1.0);
    for (double& w : grain.spin.v) w = 4.0 * (2.0 * random.uniform() - 1.0);
    grain.material = random.uniform() < 0.5 ? 0 : 1;
    add_grain(s.particles, grain);
  }
  NewBody<D> floor;
  floor.x[D - 1] = 0.05;
  floor.material = 2;
  Vec<D> up;
  up[D - 1] = 1.0;
  add_plane(s.particles, floor, up);
  return s;
}

/// Two ways of giving every pair the other order, some pairs it, and none.
template <int D>
std::vector<Slot> order_number(const System<D>& s, int k) {
  std::vector<Slot> order = spatial_order(s);
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  if (k % 4 == 0) std::reverse(order.begin(), order.end());
  if (k % 4 == 1) std::rotate(order.begin(), middle, order.end());
  if (k % 4 == 2)
    std::stable_sort(order.begin(), order.end(), [&](Slot a, Slot b) {
      return s.particles.material[static_cast<std::size_t>(a)] > s.particles.material[static_cast<std::size_t>(b)];
    });
  return order;
}

/// Forces of the state as it is agree, grain by grain.
template <int D>
void expect_same_forces(const System<D>& plain, const System<D>& renamed, double tolerance, const std::string& when) {
  System<D> a = plain;
  System<D> b = renamed;
  force_pass(a, 0.0, History::none);
  force_pass(b, 0.0, History::none);
  const std::vector<Slot> slots = slots_by_id(b.particles);
  double scale = 0.0;
  for (const auto& f : a.particles.force) scale = std::max(scale, norm(static_cast<Vec<D>>(f)));
  ASSERT_GT(scale, 0.0);
  for (std::size_t u = 0; u < slots.size(); ++u) {
    const auto v = static_cast<std::size_t>(slots[u]);
    ASSERT_LT(norm(a.particles.force[u] - b.particles.force[v]), tolerance * scale) << when << ", grain " << u;
    ASSERT_LT(std::sqrt(norm2(static_cast<Rot<D>>(a.particles.torque[u] - b.particles.torque[v]))),
              0.1 * tolerance * scale)
        << when << ", grain " << u;
  }
}

/// Every pair under the law of its bodies, sorted, as in a list that has just been made.
template <int D>
void expect_in_order(const System<D>& s, const std::string& when) {
  const ContactList<D>& list = s.contacts;
  for (std::size_t k = 0; k < list.sections.size(); ++k) {
    const ContactSection& now = list.sections[k];
    if (k > 0) {
      const ContactSection& last = list.sections[k - 1];
      EXPECT_LT(std::pair(last.geometry, last.law), std::pair(now.geometry, now.law)) << when;
    }
    for (auto c = static_cast<std::size_t>(now.begin); c < static_cast<std::size_t>(now.end); ++c) {
      ASSERT_LT(list.i[c], list.j[c]) << when;
      ASSERT_EQ(s.laws.index(s.particles.material[static_cast<std::size_t>(list.i[c])],
                             s.particles.material[static_cast<std::size_t>(list.j[c])]),
                now.law)
          << when;
      if (c > static_cast<std::size_t>(now.begin)) {
        ASSERT_LT(std::pair(list.i[c - 1], list.j[c - 1]), std::pair(list.i[c], list.j[c])) << when;
      }
    }
  }
}

/// A run whose grains change places now and then is a run that leaves them alone.
template <int D>
void changes_nothing(const Pairing& laws) {
  constexpr double kStep = 1e-4;
  System<D> plain = multi_contact<D>(laws);
  System<D> renamed = plain;
  VelocityVerlet<D> first(kStep);
  VelocityVerlet<D> second(kStep);
  first.initialise(plain);
  second.initialise(renamed);
  for (int k = 0; k < 8; ++k) {
    first.advance(plain, 20);
    second.advance(renamed, 20);
    const std::string when = std::string(laws.name) + ", " + std::to_string(D) + "D, order " + std::to_string(k);
    reorder_grains(renamed, order_number(renamed, k));
    expect_same_forces(plain, renamed, 1e-9, when);
    System<D> listed_anew = renamed;
    rebuild_neighbours(listed_anew);
    expect_same_forces(plain, listed_anew, 1e-9, when + ", list made anew");
    expect_in_order(renamed, when);
  }
  restore_order(renamed);
  expect_same_forces(plain, renamed, 1e-9, std::string(laws.name) + ", order restored");
}

TEST(RenamedPairs, KeepLawSideAndHistory) {
  for (const Pairing& laws : pairings(std::integral_constant<int, 3>{})) changes_nothing<3>(laws);
  for (const Pairing& laws : pairings(std::integral_constant<int, 2>{})) changes_nothing<2>(laws);
}

/// One pair turned over twice, with all that it remembers.
TEST(RenamedPairs, OneByOneAndBack) {
  const AnyLaw law = CohesiveDisk<true, true>{500.0, 300.0, 0.4, 0.0, 0.0, 0.0, 3.0, 1.0};
  System<2> s;
  s.materials = {glass()};
  s.laws = LawSet(1);
  s.laws.set(0, 0, law);
  add_grain(s.particles, test_sphere<2>({{0.0, 0.0}}, 0.1, 2500.0));
  add_grain(s.particles, test_sphere<2>({{0.15, 0.0}}, 0.1, 2500.0));
  s.particles.spin[0][0] = 3.0;
  force_pass(s, 1e-3, History::advance);
  const double turned = s.contacts.memory[0];
  const auto slid = s.contacts.spring[0];
  ASSERT_NE(turned, 0.0);
  reorder_grains(s, {1, 0});
  EXPECT_EQ(s.contacts.memory[0], -turned) << "an angle of i against j";
  EXPECT_EQ(s.contacts.spring[0], -slid);
  restore_order(s);
  EXPECT_EQ(s.contacts.memory[0], turned);
  EXPECT_EQ(s.contacts.spring[0], slid);
}

TEST(RenamedPairs, WhatHasRolledInSpaceIsSeenFromTheOtherSide) {
  System<3> s;
  s.materials = {glass()};
  s.laws = LawSet(1);
  s.laws.set(0, 0, multi_contact_law<LawForm::pair, false, true>(true));
  add_grain(s.particles, test_sphere<3>({{0.0, 0.0, 0.0}}, 0.1, 2500.0));
  add_grain(s.particles, test_sphere<3>({{0.15, 0.0, 0.0}}, 0.1, 2500.0));
  s.particles.spin[0] = Vec3{{0.0, 1e-3, 2e-3}};
  force_pass(s, 1e-3, History::advance);
  const Vec3 rolled = s.contacts.roll[0];
  ASSERT_NEAR(rolled[1], 1e-6, 1e-12);
  reorder_grains(s, {1, 0});
  EXPECT_EQ(Vec3(s.contacts.roll[0]), -rolled);
  restore_order(s);
  EXPECT_EQ(Vec3(s.contacts.roll[0]), rolled);
}

}  // namespace
