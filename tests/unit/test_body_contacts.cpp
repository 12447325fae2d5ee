// Contacts between bodies of macro scenes: the grains of a soft particle act as one.
#include <gtest/gtest.h>

#include <cmath>

#include "macrosim/body_contacts.h"
#include "macrosim/compression.h"

namespace softgrain {
namespace {

/// Bodies 0 (two grains, at x = -1 and x = -1 but y = +-0.5), 1 (one grain at the origin) and 2 (a shell at x = 2 with
/// one grain); a wall below all.
MacroSystem hand_made() {
  MacroSystem m;
  auto& p = m.system.particles;
  NewBody<3> grain;
  grain.r = 0.5;
  grain.mass = 1.0;
  for (const Vec3& x : {Vec3{{-1.0, 0.5, 0.0}}, Vec3{{-1.0, -0.5, 0.0}}, Vec3{}, Vec3{{1.5, 0.0, 0.0}}}) {
    grain.x = x;
    add_grain(p, grain);
  }
  NewBody<3> shell;
  shell.x = {{2.0, 0.0, 0.0}};
  shell.r = 1.0;
  add_shell(p, shell);
  m.bodies = 3;
  m.body = {0, 0, 1, 2, 2};
  m.box = add_box(m.system, {{-2.0, -2.0, -0.5}}, {{3.0, 2.0, 2.0}}, 0);
  for (std::int32_t wall = 0; wall < 6; ++wall) m.body.push_back(m.bodies + wall);
  return m;
}

ContactRecord<3> contact(Slot i, Slot j, const Vec3& normal, double normal_force, const Vec3& tangential = {}) {
  ContactRecord<3> c;
  c.i = i;
  c.j = j;
  c.normal = normal;
  c.normal_force = normal_force;
  c.tangential_force = tangential;
  return c;
}

TEST(BodyContacts, ForcesOfAPairAreSummedAndOwnContactsLeftOut) {
  const MacroSystem m = hand_made();
  const double h = 1.0 / std::sqrt(1.25);
  const std::vector<ContactRecord<3>> contacts{
      contact(0, 1, {{0.0, 1.0, 0.0}}, 7.0),                 // within body 0
      contact(0, 2, {{-h, 0.5 * h, 0.0}}, 2.0),              // upper grain of 0 on 1
      contact(1, 2, {{-h, -0.5 * h, 0.0}}, 2.0),             // lower grain of 0 on 1
      contact(3, 2, {{1.0, 0.0, 0.0}}, 3.0, {{0, 0.1, 0}}),  // written from body 2 to body 1
      contact(3, 4, {{1.0, 0.0, 0.0}}, 5.0),                 // grain of 2 on its own shell
      contact(0, 9, {{0.0, 0.0, 1.0}}, 4.0),                 // on the wall below
      contact(1, 9, {{0.0, 0.0, 1.0}}, 1.0)};
  ASSERT_EQ(m.box.plane[4], 9);
  const auto between = body_contacts(m, contacts);
  ASSERT_EQ(between.size(), 3U);
  EXPECT_EQ(between[0].a, 0);
  EXPECT_EQ(between[0].b, 1);
  EXPECT_NEAR(between[0].force[0], -4.0 * h, 1e-14);
  EXPECT_NEAR(between[0].force[1], 0.0, 1e-14);
  EXPECT_NEAR(between[0].normal_force, 4.0 * h, 1e-14);
  EXPECT_EQ(between[0].branch, (Vec3{{-1.0, 0.0, 0.0}}));
  EXPECT_EQ(between[1].a, 0);
  EXPECT_EQ(between[1].b, 3 + 4);
  EXPECT_DOUBLE_EQ(between[1].normal_force, 5.0);
  EXPECT_EQ(between[1].branch, (Vec3{{0.0, 0.0, 0.5}}));
  EXPECT_EQ(between[2].a, 1);
  EXPECT_EQ(between[2].b, 2);
  EXPECT_EQ(between[2].force, (Vec3{{-3.0, -0.1, 0.0}}));  // on body 1
  EXPECT_EQ(between[2].branch, (Vec3{{-2.0, 0.0, 0.0}}));  // from the middle of the shell
  EXPECT_DOUBLE_EQ(between[2].normal_force, 3.0);
  EXPECT_DOUBLE_EQ(body_coordination(m, between), 5.0 / 3.0);
  EXPECT_DOUBLE_EQ(fabric_anisotropy(m, between), -1.0);  // both along x; the wall does not count
}

TEST(BodyContacts, WithoutContactsThereIsNoFabric) {
  const MacroSystem m = hand_made();
  EXPECT_EQ(fabric_anisotropy(m, std::vector<BodyContact>{}), 0.0);
  EXPECT_EQ(fabric_anisotropy(m, std::vector<ContactRecord<3>>{}), 0.0);
  EXPECT_EQ(body_coordination(m, {}), 0.0);
}

/// One grain squeezed by six walls: the walls' own stress is that of the contacts with bodies.
TEST(BodyContacts, AGrainBetweenSixWallsIsSymmetric) {
  const MacroPacking packing{{{-0.99, -0.99, -0.99}}, {{0.99, 0.99, 0.99}}, {{{}, 1.0, false}}};
  MacroSystem m = make_law_system({}, packing, {}, 1.0);
  force_pass(m.system, 0.0);
  const auto between = body_contacts(m, contact_records(m.system));
  ASSERT_EQ(between.size(), 6U);
  for (const BodyContact& c : between) EXPECT_DOUBLE_EQ(c.normal_force, between[0].normal_force);
  const Vec3 stress = box_stress(m.system, m.box);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(stress[k], between[0].normal_force / (1.98 * 1.98), 1e-12 * stress[0]);
  EXPECT_DOUBLE_EQ(body_coordination(m, between), 6.0);
}

/// A contact with a wall reaches from the centre to the wall along its normal, wherever on the wall it is: what it
/// bears along the wall does no work on the stress of that direction. V sigma_zz = sum of P (R - h) over the planes
/// across z.
TEST(BodyContacts, FrictionAlongAWallIsNoStressAcrossIt) {
  constexpr double kRadius = 1.0;
  System3 s;
  s.materials = {{"glass", 2500.0, 1e7, 0.25, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 1e3, 1.0), false));
  NewBody<3> grain;
  grain.x = {{0.004, -0.003, 0.006}};
  grain.r = kRadius;
  grain.mass = grain.inertia = 1.0;
  grain.velocity = {{0.2, -0.3, 0.5}};
  add_grain(s.particles, grain);
  const Box box = add_box(s, {{-0.99, -0.99, -0.99}}, {{0.99, 0.99, 0.99}}, 0);
  force_pass(s, 1e-2);
  s.contacts.commit();
  Vec3 sum{};
  double along = 0.0;
  for (const ContactRecord<3>& c : contact_records(s)) {
    for (int k = 0; k < 3; ++k) sum[k] += std::abs(c.normal[k]) * c.normal_force * (kRadius - c.overlap);
    along = std::max(along, norm(c.tangential_force) / c.normal_force);
  }
  ASSERT_GT(along, 0.1) << "no friction to tell apart";
  const Vec3 stress = contact_stress(s, box);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(stress[k] / (sum[k] / (1.98 * 1.98 * 1.98)), 1.0, 1e-12);
}

}  // namespace
}  // namespace softgrain
