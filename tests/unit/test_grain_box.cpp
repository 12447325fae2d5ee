// Grain boxes without a run: formulas, criteria, scenes, files.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "common/core/error.h"
#include "microsim/grain_box/analysis.h"
#include "microsim/grain_box/box_measure.h"
#include "microsim/grain_box/grain_box_run.h"
#include "pipelines/kinds/grain_box/scene.h"
#include "pipelines/kinds/grain_box/summary.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;

/// Stress increments of an isotropic elastic body: ds = (K - 2/3 G) tr(de) + 2 G de.
Vec3 hooke(double bulk, double shear, const Vec3& strain) {
  const double volume = strain[0] + strain[1] + strain[2];
  const double lame = (bulk - 2.0 / 3.0 * shear) * volume;
  return Vec3{{lame, lame, lame}} + strain * (2.0 * shear);
}

TEST(GrainBoxModuli, ComeBackFromLinearData) {
  const double bulk = 2.1e9;
  const double shear = 1.3e9;
  for (const Vec3& e : {Vec3{{0, 0, 1e-4}}, Vec3{{1e-4, 2e-4, -5e-5}}, Vec3{{-1e-5, -1e-5, 1e-4}}}) {
    const Moduli m = hooke_moduli(hooke(bulk, shear, e), e);
    EXPECT_NEAR(m.bulk / bulk, 1.0, 1e-12);
    EXPECT_NEAR(m.shear / shear, 1.0, 1e-12);
  }
}

TEST(GrainBoxModuli, AreThePublishedOnesForUniaxialStrain) {
  const double axial = 3.7e5;
  const double lateral = 1.9e5;
  const double strain = 1e-4;
  const Moduli m = hooke_moduli({{lateral, lateral, axial}}, {{0.0, 0.0, strain}});
  EXPECT_NEAR(m.bulk, (axial + 2.0 * lateral) / (3.0 * strain), 1e-3);
  EXPECT_NEAR(m.shear, (axial - lateral) / (2.0 * strain), 1e-3);
}

TEST(GrainBoxModuli, SayWhenTheyAreNotDefined) {
  const Moduli isotropic = hooke_moduli({{1e5, 1e5, 1e5}}, {{1e-4, 1e-4, 1e-4}});
  EXPECT_TRUE(std::isfinite(isotropic.bulk));
  EXPECT_TRUE(std::isnan(isotropic.shear));
  const Moduli shear = hooke_moduli({{-1e5, -1e5, 2e5}}, {{-1e-4, -1e-4, 2e-4}});
  EXPECT_TRUE(std::isnan(shear.bulk));
  EXPECT_TRUE(std::isfinite(shear.shear));
}

TEST(GrainBoxModuli, EffectiveMediumIsTheFormulaAndScales) {
  const MediumState s{1e7, 0.63, 6.0, 29e9, 0.2};
  const Moduli m = effective_medium(s);
  const double p = std::numbers::pi;
  const double common = 36.0 * 0.63 * 0.63 * 29e9 * 29e9 * 1e7 / (p * p * 0.64);
  EXPECT_NEAR(m.bulk / std::cbrt(common / 18.0), 1.0, 1e-12);
  EXPECT_NEAR(m.shear / (4.2 / 9.0 * std::cbrt(1.5 * common)), 1.0, 1e-12);
  MediumState eight = s;
  eight.pressure *= 8.0;
  EXPECT_NEAR(effective_medium(eight).bulk / m.bulk, 2.0, 1e-12);
  // K/G = 5 (2 - nu) / (3 (5 - 4 nu)), independent of everything else.
  EXPECT_NEAR(m.bulk / m.shear, 5.0 * 1.8 / (3.0 * 4.2), 1e-12);
}

TEST(GrainBoxModuli, ExponentsComeBackWithTheirError) {
  std::vector<double> x;
  std::vector<double> y;
  for (int k = 0; k < 40; ++k) {
    x.push_back(1e6 * std::pow(1.1, k));
    y.push_back(3.0 * std::pow(x.back(), 0.4) * (1.0 + (k % 2 == 0 ? 0.02 : -0.02)));
  }
  y[7] = std::numeric_limits<double>::quiet_NaN();
  const PowerFit fit = fit_power(x, y, 1e6, 1e8);
  EXPECT_EQ(fit.points, 39U);
  EXPECT_NEAR(fit.exponent, 0.4, 3.0 * fit.standard_error);
  EXPECT_LT(fit.standard_error, 0.01);
  EXPECT_GT(fit.standard_error, 0.001);
  EXPECT_TRUE(std::isnan(fit_power(x, y, 1e6, 1.15e6).exponent));
}

std::vector<BoxPoint> friction_points(const std::vector<double>& shear, const std::vector<double>& share) {
  std::vector<BoxPoint> points(3);
  for (std::size_t k = 0; k < shear.size(); ++k) {
    BoxPoint p;
    p.phase = BoxPhase::friction;
    p.shear_modulus = shear[k];
    p.sliding_share = share[k];
    points.push_back(p);
  }
  return points;
}

TEST(GrainBoxGenerationEnd, NeedsSaturationAndGrowth) {
  GrainBoxGeneration g;
  g.window = 2;
  g.saturation = 0.01;
  EXPECT_FALSE(friction_phase_over(friction_points({1, 1, 1}, {0, 0, 0}), g));  // too few
  EXPECT_FALSE(friction_phase_over(friction_points({4, 3, 2, 1}, {0.1, 0.1, 0.1, 0.1}), g));
  EXPECT_FALSE(friction_phase_over(friction_points({1, 2, 3, 4}, {0.0, 0.05, 0.1, 0.15}), g));
  EXPECT_TRUE(friction_phase_over(friction_points({4, 3, 1, 1, 2, 2}, {0.0, 0.1, 0.1, 0.1, 0.1, 0.105}), g));
}

TEST(GrainBoxIncrements, FollowTheirStages) {
  GrainBoxLoading l;
  l.increments = {5e-4, 1e-4, 2e-5};
  l.stage_strains = {0.01, 0.002};
  EXPECT_EQ(increment_at(l, 0.0), 5e-4);
  EXPECT_EQ(increment_at(l, 0.0095), 5e-4);
  EXPECT_EQ(increment_at(l, 0.01), 1e-4);
  EXPECT_EQ(increment_at(l, 0.0119), 1e-4);
  EXPECT_EQ(increment_at(l, 0.5), 2e-5);
}

/// Four grains on a square, one beside it, floor and lid.
GrainPack small_pack() {
  GrainPack pack;
  pack.friction = 0.3;
  for (const Vec3& x : {Vec3{{1, 1, 1}}, Vec3{{3, 1, 1}}, Vec3{{1, 3, 1}}, Vec3{{3, 3, 1}}, Vec3{{7, 7, 5}}}) {
    pack.position.push_back(x);
    pack.radius.push_back(1.0);
    pack.youngs_modulus.push_back(1e9);
    pack.poisson_ratio.push_back(0.2);
  }
  for (int k = 0; k < 3; ++k)
    for (const bool high : {false, true}) {
      PackWall wall;
      wall.point[k] = high ? 8.0 : 0.0;
      wall.normal[k] = high ? -1.0 : 1.0;
      wall.youngs_modulus = 1e12;
      wall.poisson_ratio = 0.3;
      wall.friction = 0.3;
      pack.walls.push_back(wall);
    }
  const auto contact = [&](std::int32_t i, std::int32_t j, const Vec3& n, double force, bool sliding) {
    PackContact c;
    c.i = i;
    c.j = j;
    c.normal = n;
    c.overlap = 1e-3;
    c.normal_force = force;
    c.contact_radius = 0.02;
    c.tangential_force = {{0.0, 0.0, 0.1 * force}};
    c.torsion = 0.01;
    c.sliding = sliding;
    pack.contacts.push_back(c);
  };
  contact(0, 1, {{-1, 0, 0}}, 2.0, false);
  contact(0, 2, {{0, -1, 0}}, 4.0, true);
  contact(0, 5, {{1, 0, 0}}, 1.0, false);
  contact(1, 3, {{0, -1, 0}}, 3.0, false);
  contact(2, 3, {{-1, 0, 0}}, 3.0, false);
  contact(3, 4, {{-1, -1, -1}}, 2.0, false);
  return pack;
}

TEST(GrainBoxMeasure, CountsContactsAndRattlers) {
  const GrainPack pack = small_pack();
  const ContactCounts c = count_contacts(pack);
  EXPECT_EQ(c.contacts, 6);
  EXPECT_EQ(c.sliding, 1);
  EXPECT_DOUBLE_EQ(c.mean_force, 15.0 / 6.0);
  EXPECT_DOUBLE_EQ(c.coordination, 11.0 / 5.0);
  EXPECT_EQ(c.rattlers, 1);  // the fifth, with one contact
  EXPECT_DOUBLE_EQ(c.coordination_without, 9.0 / 4.0);
  EXPECT_EQ(c.fewest, 1);
  GrainPack slippery = pack;
  slippery.friction = 0.0;
  EXPECT_EQ(count_contacts(slippery).rattlers, 5);  // none has four
}

/// Every wall of the small pack is touched at its middle, with a force along the normal and one across.
GrainPack between_walls(const std::array<Vec3, 6>& across) {
  GrainPack pack = small_pack();
  pack.position = {{{4, 4, 4}}};
  pack.radius = {4.0 + 1e-3};
  pack.contacts.clear();
  for (std::int32_t w = 0; w < 6; ++w) {
    PackContact c;
    c.i = 0;
    c.j = 1 + w;
    c.normal = pack.walls[static_cast<std::size_t>(w)].normal;
    c.overlap = 1e-3;
    c.normal_force = 64.0;
    c.tangential_force = across[static_cast<std::size_t>(w)];
    pack.contacts.push_back(c);
  }
  return pack;
}

TEST(GrainBoxMeasure, ShearIsTheFirstMomentOfTheWallForces) {
  const Vec3 x{{1, 0, 0}};
  const Vec3 y{{0, 1, 0}};
  const BoxStress pressed = box_stress(between_walls({}));
  EXPECT_DOUBLE_EQ(pressed.mean(), 1.0);  // 64 N on 8 m x 8 m
  EXPECT_EQ(pressed.shear, 0.0);
  EXPECT_EQ(pressed.moment, 0.0);
  // Simple shear: -x +x are dragged along y, -y +y along x.
  const BoxStress sheared = box_stress(between_walls({y * 6.4, y * -6.4, x * 6.4, x * -6.4}));
  EXPECT_NEAR(sheared.shear, 0.1, 1e-12);
  EXPECT_NEAR(sheared.moment, 0.0, 1e-12);
  // Two walls alone turn the pack.
  const BoxStress turned = box_stress(between_walls({y * 6.4, y * -6.4}));
  EXPECT_NEAR(turned.shear, 0.05, 1e-12);
  EXPECT_NEAR(turned.moment, 0.1, 1e-12);
  // Opposite walls that are dragged to the same side shear nothing: drags of single walls are no stress of the pack.
  const BoxStress dragged = box_stress(between_walls({y * 6.4, y * 6.4}));
  EXPECT_NEAR(dragged.shear, 0.0, 1e-12);
  EXPECT_NEAR(dragged.moment, 0.0, 1e-12);
}

/// P and Q of the start and of the end of an increment, one contact for every case.
TEST(GrainBoxMeasure, TheLimitOfTheStartIsThatOfContactsThatThereWere) {
  GrainPack pack;
  pack.position.resize(5);
  pack.friction = 0.5;
  const auto contact = [](int j, double normal, double tangential) {
    PackContact c;
    c.j = j;
    c.normal_force = normal;
    c.tangential_force = {{0.0, tangential, 0.0}};
    return c;
  };
  const std::vector<PackContact> before{contact(1, 2.0, 0.9), contact(2, 2.0, 1.0), contact(4, 1.0, 0.4)};
  // To the limit of the start while P grows, twice; new, at its limit; to a limit that stays.
  pack.contacts = {contact(1, 4.0, 1.0), contact(2, 4.0, 1.0), contact(3, 2.0, 1.0), contact(4, 1.0, 0.5)};
  EXPECT_DOUBLE_EQ(share_at_start_limit(before, pack), 3.0 / 4.0);
  pack.friction = 0.0;
  EXPECT_TRUE(std::isnan(share_at_start_limit(before, pack)));
}

TEST(GrainBoxMeasure, WallMovesStrainTheBoxFromBothSides) {
  const auto moves = wall_moves({{0.01, 0.0, -0.02}}, {{1.0, 2.0, 4.0}});
  ASSERT_EQ(moves.size(), 6U);
  EXPECT_DOUBLE_EQ(moves[0][0], 0.005);
  EXPECT_DOUBLE_EQ(moves[1][0], -0.005);
  EXPECT_DOUBLE_EQ(moves[4][2], -0.04);
  EXPECT_DOUBLE_EQ(moves[5][2], 0.04);
}

TEST(GrainBoxArrangement, IsLooseInsideAndOfTheGivenMaterial) {
  GrainBoxSpec spec;
  spec.grains = 500;
  spec.aspect = {{1.0, 1.0, 2.0}};
  const GrainPack pack = make_loose_pack(spec, 3);
  ASSERT_EQ(pack.grains(), 500);
  const Vec3 lengths = box_lengths(pack);
  EXPECT_NEAR(lengths[2] / lengths[0], 2.0, 1e-12);
  EXPECT_NEAR(solid_fraction(pack), spec.solid_fraction, 1e-12);
  double sum = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < 500; ++i) {
    EXPECT_GE(pack.radius[i], spec.material.radius_min);
    EXPECT_LE(pack.radius[i], spec.material.radius_max);
    sum += pack.youngs_modulus[i] / 500.0;
    square += pack.youngs_modulus[i] * pack.youngs_modulus[i] / 500.0;
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(pack.position[i][k], pack.radius[i]);
      EXPECT_LE(pack.position[i][k], lengths[k] - pack.radius[i]);
    }
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GE(norm(pack.position[i] - pack.position[j]), pack.radius[i] + pack.radius[j]);
  }
  // Mean within three standard errors of 70 GPa; deviation 7 GPa (a little less for the cut at three).
  EXPECT_NEAR(sum, 70e9, 3.0 * 7e9 / std::sqrt(500.0));
  EXPECT_NEAR(std::sqrt(square - sum * sum), 7e9, 0.8e9);
  EXPECT_EQ(make_loose_pack(spec, 3).position, pack.position);
  EXPECT_NE(make_loose_pack(spec, 4).position, pack.position);
}

TEST(GrainBoxArrangement, NoneOfOneSeedIsOneOfAnotherSeed) {
  GrainBoxSpec spec;
  spec.grains = 40;
  std::set<std::vector<double>> radii;
  std::set<std::vector<double>> moduli;
  std::set<double> first_places;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U})
    for (spec.arrangement = 0; spec.arrangement < 4; ++spec.arrangement) {
      const GrainPack pack = make_loose_pack(spec, seed);
      radii.insert(drawn_radii(spec, seed));
      moduli.insert(pack.youngs_modulus);
      first_places.insert(pack.position.front()[0]);
      EXPECT_EQ(pack.radius, drawn_radii(spec, seed));
    }
  EXPECT_EQ(radii.size(), 16U);
  EXPECT_EQ(moduli.size(), 16U);
  EXPECT_EQ(first_places.size(), 16U);
}

TEST(GrainBoxArrangement, RefusesWhatDoesNotFit) {
  GrainBoxSpec spec;
  spec.grains = 300;
  spec.solid_fraction = 0.6;
  EXPECT_THROW((void)make_loose_pack(spec, 1), InputError);
  spec = {};
  spec.grains = 8;
  spec.aspect = {{1.0, 1.0, 100.0}};
  EXPECT_THROW((void)make_loose_pack(spec, 1), InputError);
}

GrainBoxResult small_result() {
  GrainBoxResult r;
  r.spec.name = "a";
  r.spec.friction = std::numeric_limits<double>::infinity();
  r.usable = false;
  r.reason = "because";
  r.state.phase = BoxPhase::loading;
  r.state.pack = small_pack();
  r.state.pack.friction = std::numeric_limits<double>::infinity();
  r.state.stress_free_lengths = {{1.0, 2.0, 3.0}};
  r.state.growth_passes = 4;
  for (int k = 0; k < 30; ++k) {
    BoxPoint p;
    p.phase = BoxPhase::loading;
    p.pressure = 1e6 * (1.0 + k);
    p.bulk = 3.0 * std::pow(p.pressure, 0.4);
    p.shear_modulus = k == 3 ? std::numeric_limits<double>::quiet_NaN() : 2.0 * std::pow(p.pressure, 0.35);
    p.strain = {{0.0, 0.1, 1e-4 * k}};
    p.moment = 10.0 * k;
    p.at_start_limit = 0.01 * k;
    p.mean_force = 1e-9 * p.pressure;
    p.effort.iterations = k;
    p.effort.residual = 1e-7;
    r.state.points.push_back(p);
  }
  r.state.failures.push_back({2, {{{0.0, 0.0, 1e-4}}, 0.5, "no equilibrium"}});
  r.spec.fit = {{1e6, 1e7}, {1e7, 3e7}};
  r.spec.material.youngs_modulus = 5e9;
  r.spec.material.poisson_ratio = 0.33;
  r.spec.material.density = 2650.0;
  r.spec.material.radius_max = 2e-3;
  r.spec.generation.lower_pressures = {4e6, 10e6};
  r.state.pressures_met = 3;
  return r;
}

TEST(GrainBoxFiles, GiveBackWhatWasWritten) {
  const softgrain::test::TemporaryDirectory directory;
  const GrainBoxResult a = small_result();
  save_grain_boxes(directory.file("grain_box.h5"), {a, a}, build_provenance());
  const auto all = load_grain_boxes(directory.file("grain_box.h5"));
  ASSERT_EQ(all.size(), 2U);
  const GrainBoxResult& b = all[1];
  EXPECT_EQ(b.spec.name, "a");
  EXPECT_TRUE(std::isinf(b.spec.friction));
  EXPECT_EQ(b.reason, "because");
  EXPECT_EQ(b.spec.fit.high[1], 3e7);
  EXPECT_EQ(b.spec.material.youngs_modulus, 5e9);
  EXPECT_EQ(b.spec.material.poisson_ratio, 0.33);
  EXPECT_EQ(b.spec.material.density, 2650.0);
  EXPECT_EQ(b.spec.material.radius_max, 2e-3);
  ASSERT_EQ(b.state.points.size(), 30U);
  EXPECT_EQ(b.state.points[5].strain, a.state.points[5].strain);
  EXPECT_TRUE(std::isnan(b.state.points[3].shear_modulus));
  EXPECT_EQ(b.state.points[7].effort.iterations, 7);
  EXPECT_EQ(b.state.points[7].moment, 70.0);
  EXPECT_EQ(b.state.points[7].at_start_limit, 0.07);
  EXPECT_EQ(b.state.pressures_met, 3);
  EXPECT_EQ(b.spec.generation.lower_pressures, (std::vector<double>{4e6, 10e6}));
  EXPECT_EQ(b.state.failures[0].tried.reason, "no equilibrium");
  EXPECT_EQ(b.state.pack.position, a.state.pack.position);
  ASSERT_EQ(b.state.pack.contacts.size(), 6U);
  EXPECT_EQ(b.state.pack.contacts[1].sliding, true);
  EXPECT_EQ(b.state.pack.contacts[4].tangential_force, a.state.pack.contacts[4].tangential_force);
  EXPECT_EQ(b.state.pack.walls[5].point, a.state.pack.walls[5].point);
  EXPECT_TRUE(std::isinf(b.state.pack.friction));
  const GrainBoxFits fits = fit_growth(b);
  EXPECT_NEAR(fits.bulk_low.exponent, 0.4, 1e-9);
  EXPECT_NEAR(fits.shear_high.exponent, 0.35, 1e-9);
  const ModuliAt at = moduli_at(b, 2.04e7);
  EXPECT_EQ(at.points, 4U);  // 19 to 22 MPa
  EXPECT_NEAR(at.bulk / (3.0 * std::pow(2.04e7, 0.4)), 1.0, 0.01);
  EXPECT_NEAR(at.force, 2.04e-2, 1e-12);
  EXPECT_EQ(total_effort(b.state).iterations, 435);
}

constexpr const char* kScene = R"(kind = "grain-box"
[material]
E = "50 GPa"
mu = 0.4
[loading]
increments = [5e-4, 1e-4]
stage_strains = [0.01]
end_stress = "60 MPa"
[[variant]]
name = "a"
[[variant]]
name = "b"
mu = "infinite"
pressure = "20 MPa"
increment = 2e-4
grains = 500
[[variant]]
name = "c"
wall_mu = 0.1
)";

TEST(GrainBoxAnalysis, FindsWhereTheShearModulusIsSmallest) {
  GrainBoxResult r = small_result();
  EXPECT_TRUE(std::isnan(pressure_of_smallest_shear(GrainBoxResult{})));
  for (std::size_t k = 0; k < r.state.points.size(); ++k) {
    const double off = static_cast<double>(k) - 15.5;
    r.state.points[k].shear_modulus = 1e9 + 1e6 * off * off;
  }
  EXPECT_NEAR(pressure_of_smallest_shear(r), 16.5e6, 1.1e6);
}

TEST(GrainBoxScene, VariantsChangeTheirKeysOnly) {
  const GrainBoxSetup setup = read_grain_box(Scene::parse(kScene, "scene.toml"));
  ASSERT_EQ(setup.packs.size(), 3U);
  EXPECT_EQ(setup.packs[2].friction, 0.4);
  EXPECT_EQ(setup.packs[2].walls.friction, 0.1);
  const GrainBoxSpec& a = setup.packs[0];
  const GrainBoxSpec& b = setup.packs[1];
  EXPECT_EQ(a.friction, 0.4);
  EXPECT_EQ(a.walls.friction, 0.4);
  EXPECT_EQ(a.walls.youngs_modulus, 100.0 * 50e9);
  EXPECT_EQ(a.loading.increments.size(), 2U);
  EXPECT_EQ(a.generation.pressure, 4e6);
  EXPECT_TRUE(std::isinf(b.friction));
  EXPECT_TRUE(std::isinf(b.walls.friction));
  EXPECT_EQ(b.generation.pressure, 20e6);
  EXPECT_EQ(b.loading.increments, std::vector<double>{2e-4});
  EXPECT_TRUE(b.loading.stage_strains.empty());
  EXPECT_EQ(b.grains, 500);
  EXPECT_EQ(b.material.youngs_modulus, 50e9);
}

/// "Both grain-grain and grain-boundary contacts" have the friction of the grains [QS 2.3], under the published rule,
/// and packs of one arrangement are one pack pressed on.
TEST(GrainBoxScene, TheScenesOfThePublicationAreAsPublished) {
  for (const char* name : {"glass_beads", "glass_beads_comparison", "glass_beads_sliding"}) {
    const Scene scene = Scene::load(std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/" + name + ".toml");
    for (const GrainBoxSpec& pack : read_grain_box(scene).packs) {
      const bool smooth = pack.name.find("smooth") != std::string::npos;
      EXPECT_EQ(pack.walls.friction, smooth ? 0.0 : pack.friction) << name << ", " << pack.name;
      const bool current = pack.name.find("current") != std::string::npos || std::isinf(pack.friction);
      EXPECT_EQ(pack.solver.coulomb == CoulombRule::current, current) << name << ", " << pack.name;
      if (pack.of == "10MPa") {
        EXPECT_EQ(pack.generation.lower_pressures, std::vector<double>{4e6}) << name;
      }
    }
  }
  EXPECT_EQ(GrainBoxSpec{}.walls.friction, GrainBoxSpec{}.friction);
}

TEST(GrainBoxScene, PacksOfTheSameGrainsArePressedOn) {
  const GrainBoxSetup setup = read_grain_box(Scene::parse(R"(kind = "grain-box"
arrangements = 2
[generation]
pressure = "10 MPa"
[loading]
end_stress = "60 MPa"
[[variant]]
name = "a"
pressure = "41 MPa"
[[variant]]
name = "b"
mu = 0.5
[[variant]]
name = "c"
pressure = "4 MPa"
[[variant]]
name = "d"
[[variant]]
name = "e"
pressure = "20 MPa"
grains = 100
)",
                                                          "scene.toml"));
  const auto lower = [&](std::size_t k) { return setup.packs.at(k).generation.lower_pressures; };
  for (std::size_t k = 0; k < 2; ++k) {  // arrangements
    EXPECT_EQ(lower(k), (std::vector<double>{4e6, 10e6}));
    EXPECT_EQ(lower(2 + k), std::vector<double>{4e6});
    EXPECT_TRUE(lower(4 + k).empty());
    EXPECT_EQ(lower(6 + k), std::vector<double>{4e6});
    EXPECT_TRUE(lower(8 + k).empty());  // of other grains
  }
}

TEST(GrainBoxScene, TriaxialHoldsTheLateralStress) {
  const GrainBoxSetup setup = read_grain_box(Scene::parse(R"(kind = "grain-box"
[loading]
test = "triaxial"
axis = "x"
lateral_stress = "10 MPa"
end_strain = 0.01
)",
                                                          "scene.toml"));
  const GrainBoxLoading& l = setup.packs.at(0).loading;
  EXPECT_EQ(l.control[0], AxisControl::strain);
  EXPECT_EQ(l.control[1], AxisControl::stress);
  EXPECT_EQ(l.stress[2], 10e6);
  EXPECT_EQ(l.strain_rate[0], 1.0);
}

TEST(GrainBoxSummary, MeansOverArrangementsHaveTheirErrorsInTheTerminal) {
  const ModuliAt low{.pressure = 3e7, .bulk = 1.4e9, .bulk_error = 2e7, .shear = 9e8, .shear_error = 1e7, .points = 3};
  const ModuliAt high{
      .pressure = 6e7, .bulk = 1.938e9, .bulk_error = 1.7e7, .shear = 1.366e9, .shear_error = 1.6e7, .points = 3};
  const ModuliAt none{.pressure = 9e7, .bulk = std::nan(""), .points = 1};
  EXPECT_EQ(arrangements_text({{"pack", 3, {low, high, none}, 0.5027, 0.002}}),
            "pack, mean of 3 arrangements +- standard error: at sigma_c 60 MPa K 1.938 +- 0.017 GPa, G 1.366 +- 0.016 "
            "GPa; sliding 0.5027 +- 0.002\n");
  EXPECT_EQ(arrangements_text({}), "");
}

}  // namespace
