// The published limit of friction (P of the reference state): the law is continuous enough for an equilibrium to exist,
// packs with many sliding contacts run through, and both minimisers find the same answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <utility>

#include "common/statics/contact_law.h"
#include "tests/support/grain_packs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kFriction = 0.3;

/// Stiffness 1 and limit 1; the reference force is at the limit, along x.
statics::FrictionConstants unit_contact() {
  statics::FrictionConstants c;
  c.shear = 1.0;
  c.contact_radius0 = 1.0;
  c.friction = kFriction;
  c.limit0 = 1.0;
  c.tangential0 = {{1.0, 0.0, 0.0}};
  return c;
}

TEST(LeastWorkReferenceRule, TheForceTurnsSmoothlyWithTheDirectionOfSlip) {
  const statics::FrictionConstants c = unit_contact();
  // "About" k*/sqrt(2 (1 - kReferenceShare)): 1/2 more.
  const double steepest = 1.5 / std::sqrt(2.0 * (1.0 - statics::kReferenceShare));
  constexpr int kTurns = 20000;
  for (const double slip : {1e-4, 1e-2, 0.05, 0.3, 3.0, 100.0}) {
    Vec3 before;
    double worst = 0.0;
    for (int k = 0; k <= kTurns; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kTurns;
      const Vec3 slid = Vec3{{std::cos(angle), std::sin(angle), 0.0}} * slip;
      const Vec3 force = statics::tangential_by_reference(c, 1.0 / kFriction, c.tangential0, slid).force;
      EXPECT_LE(norm(force), 1.0 + 1e-12);
      if (k > 0) worst = std::max(worst, norm(force - before));
      before = force;
    }
    EXPECT_LT(worst, steepest * slip * 2.0 * std::numbers::pi / kTurns) << "slip " << slip;
  }
}

/// Q = Qp with k' = 0 where |Qp| > mu P0, unless the contact slips back: the force is not cut to mu P0.
TEST(LeastWorkReferenceRule, AContactThatCarriesMoreThanItsLimitKeepsIt) {
  statics::FrictionConstants c = unit_contact();
  c.limit0 = 0.6;  // P fell by 0.4 since Q0 was at its limit
  const double p0 = c.limit0 / kFriction;
  const auto force = [&](const Vec3& slid) { return statics::tangential_by_reference(c, p0, c.tangential0, slid); };
  EXPECT_NEAR(norm(force({}).force), statics::kReferenceShare, 1e-12);
  const statics::TangentialForce on = force({{-0.4, 0.0, 0.0}});
  EXPECT_NEAR(on.force[0], 1.0, 1e-12);
  EXPECT_LE(on.stiffness, 0.01);
  EXPECT_EQ(on.limit, 1.0);
  EXPECT_NEAR(force({{0.25, 0.0, 0.0}}).force[0], statics::kReferenceShare - 0.25, 1e-12);  // back: it sticks
}

/// Torsion likewise.
TEST(LeastWorkReferenceRule, AContactThatCarriesMoreTorsionThanItsLimitKeepsIt) {
  using Law = statics::FrictionLaw<CoulombRule::reference, true>;
  statics::FrictionConstants c = unit_contact();
  c.twist = 1.0;
  c.torsion0 = 0.5;  // the limit is 3 pi/16 a0 mu P0 = 0.589
  const auto moment = [&](double turned) {
    statics::ContactPlace place;
    place.normal = {{0.0, 0.0, 1.0}};
    place.overlap = 1.0;
    const statics::NormalForce normal{c.limit0 / kFriction, 1.0, 0.0};
    return statics::torsion_response<Law>(c, normal, 1.0, place, {{0.0, 0.0, turned}}, {}).moment;
  };
  EXPECT_NEAR(moment(0.0), 0.5, 1e-12);
  EXPECT_NEAR(moment(-1.0), 3.0 * std::numbers::pi / 16.0, 1e-12);
  c.limit0 = 0.1;
  EXPECT_NEAR(moment(0.0), 0.5, 1e-12);
  EXPECT_NEAR(moment(-1.0), 0.5, 1e-12);
  EXPECT_NEAR(moment(0.2), 0.3, 1e-12);
}

const PackContact* find_contact(const std::vector<PackContact>& all, const PackContact& c) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const PackContact& o) { return o.i == c.i && o.j == c.j; });
  return found == all.end() ? nullptr : &*found;
}

/// What a state says of its contacts is not cut when the next increment begins, and sliding is |Q| >= mu P of the
/// state.
TEST(LeastWorkReferenceRule, SlidingGoesByTheForcesOfTheState) {
  GrainPack pack = random_pack(7, kFriction);
  LeastWorkOptions options;
  options.coulomb = CoulombRule::reference;
  std::int64_t above = 0;
  std::int64_t sliding = 0;
  double before = 0.0;
  double after = 0.0;
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(advance(pack, squeeze(pack, {{0.0, 0.0, 3e-4}}), options).converged);
    const GrainPack start = pack;
    ASSERT_TRUE(advance(pack, std::vector<Vec3>(6), options).converged);  // nothing moves
    for (const PackContact& now : pack.contacts) {
      EXPECT_EQ(now.sliding, norm(now.tangential_force) >= (1.0 - 1e-6) * kFriction * now.normal_force);
      sliding += now.sliding ? 1 : 0;
      const PackContact* then = find_contact(start.contacts, now);
      if (then == nullptr || norm(then->tangential_force) < 1.05 * kFriction * then->normal_force) continue;
      ++above;
      before += norm(then->tangential_force);
      after += norm(now.tangential_force);
    }
  }
  EXPECT_GT(above, 200);
  EXPECT_GT(sliding, above);
  EXPECT_NEAR(after / before, 1.0, 0.02);
}

TEST(LeastWorkReferenceRule, TheForceFadesWhereAContactOpensAndOnlyThere) {
  const statics::FrictionConstants c = unit_contact();
  const Vec3 slid{{-1.0, 0.5, 0.0}};
  const double p0 = c.limit0 / kFriction;
  const double full = norm(statics::tangential_by_reference(c, p0, c.tangential0, slid).force);
  EXPECT_NEAR(full, c.limit0, 1e-12);
  for (const double part : {0.0, 1e-6, 0.3, 0.99, 1.0, 1.01, 10.0}) {
    const double p = part * p0 / statics::kOpening;
    const statics::TangentialForce t = statics::tangential_by_reference(c, p, c.tangential0, slid);
    EXPECT_NEAR(norm(t.force), full * std::min(1.0, part), 1e-12) << "P/P0 " << p / p0;
  }
}

TEST(LeastWorkReferenceRule, APackWithSlidingAndOpeningContactsRunsThrough) {
  GrainPack pack = random_pack(7, kFriction);
  LeastWorkOptions options;
  options.coulomb = CoulombRule::reference;
  options.max_iterations = 1000;  // with the rule as published the 11th increment used up any number
  for (int k = 0; k < 40; ++k) {
    const LeastWorkResult r = advance(pack, squeeze(pack, {{0.0, 0.0, 3e-4}}), options);
    ASSERT_TRUE(r.converged) << "increment " << k << ": " << to_string(r.stopped_by) << " " << r.worst_residual;
  }
}

Vec3 force_of(const PackContact& c) { return c.normal * c.normal_force + c.tangential_force; }

/// Largest difference between the forces of contacts that two states share, and the largest force of a contact that
/// only one of them has.
double largest_difference(const std::vector<PackContact>& a, const std::vector<PackContact>& b) {
  double worst = 0.0;
  std::size_t k = 0;
  std::size_t m = 0;
  const auto key = [](const PackContact& c) { return std::pair{c.i, c.j}; };
  while (k < a.size() || m < b.size()) {
    if (m == b.size() || (k < a.size() && key(a[k]) < key(b[m]))) {
      worst = std::max(worst, norm(force_of(a[k++])));
    } else if (k == a.size() || key(b[m]) < key(a[k])) {
      worst = std::max(worst, norm(force_of(b[m++])));
    } else {
      worst = std::max(worst, norm(force_of(a[k++]) - force_of(b[m++])));
    }
  }
  return worst;
}

TEST(LeastWorkReferenceRule, PublishedAndFastAgreeWhileContactsSlide) {
  GrainPack fast = random_pack(7, kFriction);
  LeastWorkOptions options;
  options.coulomb = CoulombRule::reference;
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(advance(fast, squeeze(fast, {{0.0, 0.0, 1e-4}}), options).converged);
  GrainPack published = fast;
  options.residual_tolerance = 1e-9;
  options.work_tolerance = 0.0;
  options.force_tolerance = 1e-24;
  options.max_iterations = 100000;
  LeastWorkOptions slow = options;
  slow.method = LeastWorkMethod::published;
  slow.sub_increments = 1;
  // By reciprocity a force on a wall changes by sum_g v_g . f_g when the grains are out of balance by f, where v is how
  // they move (and turn) when the wall is displaced by 1, so at most by sum |f_g| <= sqrt(2 grains) |f| if no grain
  // moves further than the wall; the same holds for the two sides of a contact. Errors of the increments add.
  double bound = 0.0;
  for (int k = 0; k < 4; ++k) {
    const std::vector<Vec3> moves = squeeze(fast, {{0.0, 0.0, 1e-4}});
    const LeastWorkResult a = advance(fast, moves, options);
    const LeastWorkResult b = advance(published, moves, slow);
    ASSERT_TRUE(a.converged) << to_string(a.stopped_by);
    ASSERT_TRUE(b.converged) << to_string(b.stopped_by) << " " << b.worst_residual;
    bound += std::sqrt(2.0 * fast.grains()) * (std::sqrt(a.residual_energy) + std::sqrt(b.residual_energy));
    const double contacts = largest_difference(fast.contacts, published.contacts);
    double walls = 0.0;
    for (std::size_t w = 0; w < 6; ++w) walls = std::max(walls, norm(wall_forces(fast)[w] - wall_forces(published)[w]));
    const double scale = norm(wall_forces(fast)[5]);
    const auto sliding =
        std::count_if(fast.contacts.begin(), fast.contacts.end(), [](const PackContact& c) { return c.sliding; });
    std::cout << "sliding " << sliding << " of " << fast.contacts.size() << ", over the force on a wall: walls "
              << walls / scale << ", contacts " << contacts / scale << ", bound " << bound / scale << "\n";
    EXPECT_GT(sliding, 50);
    EXPECT_LT(bound, 1e-6 * scale);
    EXPECT_LT(walls, bound);
    EXPECT_LT(contacts, bound);
  }
}

}  // namespace
