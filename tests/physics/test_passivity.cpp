// Friction must not make energy. The rescaled spring never does; the published form does a little, and how much is
// known. Nor do laws of soft particles with several neighbours, whatever way they are led.
#include <gtest/gtest.h>

#include "common/contact/make_laws.h"
#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/parallel_pass.h"
#include "tests/support/impact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Material kOxide{"oxide", 4000.0, 3.8e11, 0.23, false};

/// Energy after over before, for an impact at `degrees` from the normal with a backspin of `spin_share` of the sliding
/// speed.
double energy_ratio(const Material& material, Partner partner, bool rescaled, double e, double friction, double degrees,
                    double spin_share) {
  const double angle = degrees * std::numbers::pi / 180.0;
  ImpactSetup setup{partner, 0.0025, partner == Partner::shell_inside ? 3.0 : 2.0, 3.9 * std::cos(angle),
                    3.9 * std::sin(angle)};
  setup.spin[1] = -spin_share * setup.sliding_speed / setup.radius;
  const HertzCoefficients k = HertzCoefficients::of(material, material, friction, e);
  System3 s = impact_system(setup, hertz_law(k, rescaled), material);
  const double duration =
      hertz_impact(std::sqrt(effective_radius(setup)) * k.inverse_d, effective_mass(s), setup.speed).duration;
  const ImpactOutcome out = collide(s, partner, duration / 4000.0, 40000);
  EXPECT_TRUE(out.ended);
  return out.energy_ratio;
}

template <class Use>
void over_impacts(Use&& use) {
  for (const Partner partner : {Partner::sphere, Partner::plane, Partner::shell_inside})
    for (const double friction : {0.092, 0.5})
      for (const double degrees : {5.0, 20.0, 45.0, 70.0, 85.0, 89.0})
        for (const double spin : {0.0, -0.9, 1.5}) use(partner, friction, degrees, spin);
}

TEST(Passivity, TheRescaledSpringNeverMakesEnergy) {
  over_impacts([](Partner partner, double friction, double degrees, double spin) {
    for (const double e : {1.0, 0.9, 0.5})
      EXPECT_LE(energy_ratio(kOxide, partner, true, e, friction, degrees, spin), 1.0 + 1e-9)
          << "e " << e << ", mu " << friction << ", " << degrees << " degrees, spin " << spin;
  });
}

/// Largest share of energy that the published form makes on a plane, over angles and spins.
double largest_creation(double friction) {
  const Material worst{"worst", 4000.0, 3.8e11, 0.0, false};  // of Poisson's ratios 0, 0.23, 0.45
  double most = 0.0;
  for (const double degrees : {1.0, 5.0, 13.0, 29.0, 49.0, 69.0, 85.0})
    for (const double spin : {-1.0, 0.0, 1.5, 2.0, 3.0})
      most = std::max(most, energy_ratio(worst, Partner::plane, false, 1.0, friction, degrees, spin) - 1.0);
  return most;
}

TEST(Passivity, WhatThePublishedSpringMakesIsBounded) {
  // Measured on a fine grid of angles, spins and Poisson's ratios: 0.015 %, 0.13 %, 0.37 %, 1.3 % (and 8.6 % at mu =
  // 5).
  const std::vector<std::pair<double, double>> bounds{{0.1, 2e-4}, {0.3, 1.5e-3}, {0.5, 4e-3}, {1.0, 1.5e-2}};
  for (const auto& [friction, bound] : bounds) {
    const double most = largest_creation(friction);
    EXPECT_LT(most, bound) << "mu " << friction;
    EXPECT_GT(most, 0.25 * bound) << "mu " << friction
                                  << ": if this form has become passive, say so in the documentation";
  }
}

/// One soft particle over a plane, beside a second plane, a solid sphere and a soft one; all but the first stay.
System3 crowded(const MultiContactLaws& laws) {
  System3 s;
  s.materials = {{"soft", 2500.0, 5e5, 0.3, false}, {"solid", 2500.0, 5e5, 0.3, false}};
  s.laws = LawSet(2);
  s.laws.set(0, 0, laws.soft_soft);
  s.laws.set(0, 1, laws.soft_solid, true);
  s.laws.set(1, 0, laws.solid_soft, true);
  const auto ball = [&](Vec3 x, double r, std::int32_t material) {
    NewBody<3> b = test_sphere<3>(x, r, 2500.0);
    b.material = material;
    add_grain(s.particles, b);
  };
  ball({{0.0, 0.0, 0.0}}, 1.0, 0);
  ball({{-1.9, 0.3, 0.6}}, 1.0, 0);
  ball({{0.2, -1.4, 0.5}}, 0.5, 1);
  NewBody<3> wall;
  wall.material = 1;
  wall.x = {{0.0, 0.0, -1.0}};
  add_plane(s.particles, wall, Vec3{{0.0, 0.0, 1.0}});
  wall.x = {{1.0, 0.0, 0.0}};
  add_plane(s.particles, wall, Vec3{{-1.0, 0.0, 0.0}});
  return s;
}

struct CycleWork {
  double net = 0.0;  ///< of whoever leads the body [J]
  double way = 0.0;  ///< of both signs
};

/// Along a closed way that begins and ends out of touch: out of the corner, into it, all about, and back.
CycleWork lead_around(const MultiContactLaws& laws, std::uint64_t seed) {
  System3 s = crowded(laws);
  RandomStream random(seed, RandomPurpose::test, 0);
  std::array<std::array<double, 4>, 6> amplitude{};
  for (auto& row : amplitude)
    for (double& a : row) a = random.normal();
  constexpr int kSteps = 6000;
  constexpr int kRest = 7;            // steps between two states at rest, for laws that remember them
  const auto place = [&](double t) {  // three of place, three of turning; zero at both ends
    std::array<double, 6> q{};
    const double inside = std::sin(std::numbers::pi * t);
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t n = 0; n < 4; ++n)
        q[k] += 0.03 * amplitude[k][n] * inside * std::sin(2.0 * std::numbers::pi * static_cast<double>(n + 1) * t);
    const double deep = 0.2 * inside;  // against all neighbours, from out of touch
    q[0] += 0.6 * deep - 0.05, q[1] -= 0.3 * deep, q[2] += 0.15 - 1.6 * deep;
    return q;
  };
  CycleWork work;
  auto last = place(0.0);
  Vec3 force{};
  Vec3 torque{};
  for (int k = 0; k <= kSteps; ++k) {
    const auto now = place(static_cast<double>(k) / kSteps);
    const Vec3 step{{now[0] - last[0], now[1] - last[1], now[2] - last[2]}};
    const Vec3 turn{{now[3] - last[3], now[4] - last[4], now[5] - last[5]}};
    for (int d = 0; d < 3; ++d) s.particles.sphere[0].x[d] = now[static_cast<std::size_t>(d)];
    s.particles.velocity[0] = step;
    s.particles.spin[0] = turn;
    force_pass(s, 1.0, History::advance);
    if (k % kRest == 0) keep_largest_volumes(s);
    const Vec3 new_force(s.particles.force[0]);
    const Vec3 new_torque(s.particles.torque[0]);
    const double done = -0.5 * (dot(force + new_force, step) + dot(torque + new_torque, turn));
    work.net += done;
    work.way += std::abs(done);
    force = new_force, torque = new_torque;
    last = now;
  }
  EXPECT_EQ(norm(force), 0.0) << "ends out of touch";
  return work;
}

TEST(Passivity, NoCycleOfPressingSlidingRollingAndLettingGoGainsEnergy) {
  const LawTable table = load_law_table(SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml");
  for (const LawForm form : {LawForm::pair, LawForm::isotropic, LawForm::directional})
    for (const bool rolling : {false, true})
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        MultiContactChoices choices;
        choices.form = form;
        choices.modulus = 5e5;
        choices.rolling = rolling;
        const CycleWork work = lead_around(make_multi_contact_laws(main_entry(table), choices), seed);
        EXPECT_GT(work.net, 1e-3 * work.way) << to_string(form) << (rolling ? ", rolling, " : ", ") << seed;
      }
}

/// The largest volume at rest moves along the way. Without friction what is lost is lost by the memory alone.
TEST(Passivity, NoCycleOfParticlesThatRememberGainsEnergy) {
  const LawTable table = load_law_table(SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml");
  MultiContactChoices choices;
  choices.form = LawForm::isotropic;
  choices.modulus = 5e5;
  const auto work = [&](double ratio, bool rubs, std::uint64_t seed) {
    choices.unloading_ratio = ratio;
    choices.friction = rubs ? -1.0 : 0.0;  // as measured, or none
    choices.rolling = rubs;
    return lead_around(make_multi_contact_laws(main_entry(table), choices), seed);
  };
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const CycleWork elastic = work(1.0, false, seed);
    const CycleWork some = work(1.3, false, seed);
    const CycleWork more = work(3.0, false, seed);
    EXPECT_NEAR(elastic.net, 0.0, 1e-4 * elastic.way) << seed;
    EXPECT_GT(some.net, 0.02 * some.way) << seed;
    EXPECT_GT(more.net / more.way, 1.5 * some.net / some.way) << seed;
    for (const double ratio : {1.3, 3.0}) {
      const CycleWork rubbed = work(ratio, true, seed);
      EXPECT_GT(rubbed.net, 0.02 * rubbed.way) << ratio << ", " << seed;
    }
  }
}

/// Pressed lightly, slid within the friction limit, pressed on, slid back, let go: a spring of the stiffness of the
/// moment gains.
TEST(Passivity, WhatIsPressedOnAfterASlideGivesNothingForNothing) {
  const LawTable table = load_law_table(SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml");
  MultiContactChoices choices;
  choices.modulus = 5e5;
  choices.friction = 5.0;  // nothing slides: all that goes in comes back, or less
  choices.wall_friction = 5.0;
  const MultiContactLaws laws = make_multi_contact_laws(main_entry(table), choices);
  System3 s = crowded(laws);
  Vec3 at{{-0.4, 0.0, 0.1}};
  Vec3 force{};
  double net = 0.0;
  double put_in = 0.0;
  double drag_before = 0.0;
  const auto lead = [&](const Vec3& by) {
    constexpr int kSteps = 2000;
    for (int k = 0; k < kSteps; ++k) {
      const Vec3 step = by * (1.0 / kSteps);
      at += step;
      for (int d = 0; d < 3; ++d) s.particles.sphere[0].x[d] = at[d];
      s.particles.velocity[0] = step;
      force_pass(s, 1.0, History::advance);
      const Vec3 now(s.particles.force[0]);
      const double done = -0.5 * dot(force + now, step);
      net += done;
      put_in += std::max(done, 0.0);
      force = now;
    }
  };
  s.particles.sphere[1].x[0] -= 5.0;  // the plane alone
  s.particles.sphere[2].x[1] -= 5.0;
  lead({{0.0, 0.0, -0.26}});
  lead({{0.02, 0.0, 0.0}});
  drag_before = force[0];
  EXPECT_LT(drag_before, 0.0);
  lead({{0.0, 0.0, -0.10}});
  EXPECT_NEAR(force[0], drag_before, 1e-9 * std::abs(drag_before)) << "pressed on, the drag stays";
  lead({{-0.02, 0.0, 0.0}});
  lead({{0.0, 0.0, 0.36}});
  EXPECT_EQ(norm(force), 0.0);
  EXPECT_GT(net, 0.0);
  EXPECT_LT(net, 0.2 * put_in);
}

}  // namespace
