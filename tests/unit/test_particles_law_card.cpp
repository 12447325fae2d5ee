// Scenes of explicit particles whose contacts follow a law card.
#include <array>
#include <cmath>

#include "common/core/error.h"
#include "common/data/law_card.h"
#include "common/dynamics/force_pass.h"
#include "microsim/particles/particles_run.h"
#include "tests/support/small_packing.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

PairLaw good_law(PairKind kind, double a) {
  PairLaw law;
  law.kind = kind;
  law.status = LawStatus::good;
  law.normal.a = {a, 0.01, 0.9 * a, 1.1 * a};
  law.normal.b = {2.2, 0.02, 2.1, 2.3};
  law.normal.delta = {0.05, 0.001, 0.04, 0.06};
  const double c = -a * std::pow(0.05, 2.2);
  law.normal.c = {c, 1e-5, 1.1 * c, 0.9 * c};
  law.tangential_initial = law.normal;
  law.has_tangential_initial = true;
  law.covariance.assign(49, 0.0);
  law.delta_max = 0.4;
  law.packings = 8;
  law.points = 40;
  return law;
}

class ParticlesLawCard : public ::testing::Test {
 protected:
  void SetUp() override {
    LawCard card;
    card.relaxation = "damped";
    card.pairs = {good_law(PairKind::soft_solid, 0.6)};
    save_card(card, directory_.file("law.toml"));
  }
  /// `pair` and `more` go into the contact; a soft and a solid ball overlap by 0.2 of the soft radius.
  ParticlesScene read(const std::string& pair, const std::string& more, bool soft_first, const std::string& wall = "") {
    const std::string soft = "[[particle]]\nmaterial = \"soft\"\nradius = 0.02\nposition = [0.0, 0.0, 0.0]\n";
    const std::string solid = "[[particle]]\nmaterial = \"stone\"\nradius = 0.05\nposition = [0.066, 0.0, 0.0]\n";
    const std::string text =
        "kind = \"particles\"\n[material.soft]\ndensity = 1500.0\n[material.stone]\ndensity = 2500.0\n"
        "[[contact]]\npair = " +
        pair +
        "\nlaw = \"law-card\"\nfile = \"law.toml\"\nE = \"0.5 MPa\"\nmu = 0.3\ndamping = 0.1\nkt = \"initial\"\n" +
        more + (soft_first ? soft + solid : solid + soft) + wall + "[time]\nend = 1e-3\nstep = 1e-5\n";
    return read_particles_scene(Scene::parse(text, directory_.file("scene.toml")));
  }
  TemporaryDirectory directory_;
};

TEST_F(ParticlesLawCard, ForceDoesNotDependOnTheOrderOfPairOrBodies) {
  // E R^2 (a D^b + c), R the soft radius
  const double expected = 0.5e6 * 0.02 * 0.02 * 0.6 * (std::pow(0.2, 2.2) - std::pow(0.05, 2.2));
  for (const char* pair : {"[\"soft\", \"stone\"]", "[\"stone\", \"soft\"]"})
    for (const bool soft_first : {true, false}) {
      ParticlesScene scene = read(pair, "kind = \"soft-solid\"\nwhich_soft = \"soft\"\n", soft_first);
      force_pass(scene.system, 0.0);
      EXPECT_NEAR(std::abs(scene.system.particles.force[0][0]), expected, 1e-9 * expected) << pair << soft_first;
      EXPECT_TRUE(run_particles(scene, {}).usable);
    }
}

TEST_F(ParticlesLawCard, UnusableCombinationsAreBadInput) {
  EXPECT_THROW((void)read("[\"soft\", \"stone\"]", "kind = \"soft-solid\"\n", true), InputError);
  EXPECT_THROW((void)read("[\"soft\", \"stone\"]", "kind = \"soft-solid\"\nwhich_soft = \"rigid\"\n", true),
               InputError);
  EXPECT_THROW((void)read("[\"soft\", \"stone\"]", "kind = \"soft-soft\"\n", true), InputError)
      << "the card has no such law";
  const std::string solid_wall =
      "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, -0.05]\nnormal = [0.0, 0.0, 1.0]\nmaterial = \"soft\"\n";
  EXPECT_THROW((void)read("[\"soft\", \"stone\"]", "kind = \"soft-solid\"\nwhich_soft = \"soft\"\n", true, solid_wall),
               InputError);
}

/// Pairs of a soft and a solid ball far from each other, either one first in turn.
System3 pairs_apart(const System3& pair, int count) {
  System3 s = pair;
  s.particles = {};
  const auto& from = pair.particles;
  for (int k = 0; k < count; ++k)
    for (const std::size_t u : k % 2 == 0 ? std::array<std::size_t, 2>{0, 1} : std::array<std::size_t, 2>{1, 0}) {
      NewBody<3> body;
      body.x = from.sphere[u].x + Vec3{{0.5 * (k * 7 % 11), 0.5 * (k * 5 % 13), 0.5 * (k % 17)}};
      body.x += Vec3{{6.0 * (k / 2431), 0.0, 0.0}};
      body.r = from.sphere[u].r;
      body.mass = 1.0 / from.inverse_mass[u];
      body.inertia = 1.0 / from.inverse_inertia[u];
      body.material = from.material[u];
      add_grain(s.particles, body);
    }
  return s;
}

/// From 2000 grains on they are put in another order: pairs of which the second body has become the first.
TEST_F(ParticlesLawCard, ForceOfAPairDoesNotDependOnHowManyThereAre) {
  ParticlesScene scene = read("[\"soft\", \"stone\"]", "kind = \"soft-solid\"\nwhich_soft = \"soft\"\n", true);
  scene.time.steps = 3;
  scene.record = false;
  const double expected =
      contact_records(run_particles(scene, pairs_apart(scene.system, 1), {}).system).at(0).normal_force;
  ASSERT_GT(expected, 0.0);
  for (const int count : {990, 1010}) {
    const ParticlesResult out = run_particles(scene, pairs_apart(scene.system, count), {});
    const auto contacts = contact_records(out.system);
    ASSERT_EQ(contacts.size(), static_cast<std::size_t>(count));
    for (const auto& c : contacts) ASSERT_NEAR(c.normal_force, expected, 1e-9 * expected) << count;
  }
}

}  // namespace
