// Springs at faces: what a face may do between two kept states, and that none of it makes energy.
#include <gtest/gtest.h>

#include <cmath>

#include "macrosim/cell_matter/cell_forces.h"

namespace softgrain {
namespace {

/// Two cells of volume 1 and their face, perpendicular to `separation`.
struct OneFace {
  RadicalCells cells;
  std::vector<CellResponse> response{{1.0, 10.0, 0.0}, {1.0, 10.0, 0.0}};

  OneFace(double area, const Vec3& separation) {
    cells.volume = {1.0, 1.0};
    cells.faces = {{0, 1, home_image<3>(), area, norm(separation), {}, separation}};
  }
  [[nodiscard]] FaceSpring trial(const FaceSprings& springs, double mu, std::array<std::int32_t, 3> moved = {}) const {
    return springs.trial({mu, 0.5}, false, cells, face_keys(cells, {{}, moved}), response).springs.at(0);
  }
};

const Vec3 kAlong{{0.0, 0.0, 2.0}};

void keep(FaceSprings& springs, const FaceSpring& one) { springs.keep(SpringSet{{one}, {}, {}}); }

/// Kept without force, then moved sideways by `slip` and kept again.
FaceSprings loaded(double area, const Vec3& slip, double mu) {
  FaceSprings springs;
  keep(springs, OneFace(area, kAlong).trial(springs, mu));
  keep(springs, OneFace(area, kAlong + slip).trial(springs, mu));
  return springs;
}

TEST(FaceSprings, AreAsStiffAsTheMatterAndPullAgainstTheMotion) {
  const Vec3 slip{{1e-6, 0.0, 0.0}};
  const FaceSprings springs = loaded(3.0, slip, 0.5);
  const double k = 0.5 * 10.0 * 3.0 / 2.0;
  EXPECT_NEAR(springs.kept().springs[0].stiffness, k, 1e-9);
  EXPECT_NEAR(springs.kept().springs[0].force[0], -k * 1e-6, 1e-15);
  EXPECT_NEAR(springs.kept().springs[0].energy(), 0.5 * k * 1e-12, 1e-18);
  EXPECT_FALSE(springs.kept().springs[0].slides);
}

TEST(FaceSprings, ANewFaceBeginsWithoutForceAndAVanishedOneIsForgotten) {
  FaceSprings springs;
  EXPECT_EQ(OneFace(3.0, {{0.3, 0.0, 2.0}}).trial(springs, 0.5).force, Vec3{});
  springs = loaded(3.0, {{0.1, 0.0, 0.0}}, 0.5);
  springs.keep({});
  EXPECT_EQ(OneFace(3.0, {{0.3, 0.0, 2.0}}).trial(springs, 0.5).force, Vec3{});
}

TEST(FaceSprings, SlideAtTheCoulombLimitOfTheCurrentPressure) {
  const FaceSprings springs = loaded(3.0, {{0.5, 0.0, 0.0}}, 0.2);
  EXPECT_NEAR(norm(springs.kept().springs[0].force), 0.2 * 3.0, 1e-12);
  EXPECT_TRUE(springs.kept().springs[0].slides);
  OneFace soft(3.0, kAlong + Vec3{{0.5, 0.0, 0.0}});
  soft.response[0].pressure = 0.1;
  soft.response[1].pressure = 0.3;
  EXPECT_NEAR(norm(soft.trial(springs, 0.2).force), 0.2 * 0.2 * 3.0, 1e-12);
  soft.response = {{}, {}};
  EXPECT_EQ(soft.trial(springs, 0.2).force, Vec3{});
}

TEST(FaceSprings, NoChangeOfAreaStiffnessOrDirectionMakesEnergy) {
  const Vec3 slip{{0.01, 0.0, 0.0}};
  const FaceSprings springs = loaded(3.0, slip, 5.0);
  const double before = springs.kept().springs[0].energy();
  const double force = norm(springs.kept().springs[0].force);
  EXPECT_GT(before, 0.0);
  for (const double area : {1e-9, 0.1, 1.0, 2.9, 3.1, 10.0}) {
    const FaceSpring one = OneFace(area, kAlong + slip).trial(springs, 5.0);
    EXPECT_LE(one.energy(), before * (1.0 + 1e-12)) << area;
    EXPECT_NEAR(norm(one.force), force * std::min(1.0, area / 3.0), 1e-12) << area;
    // There and back in area: what was lost stays lost.
    FaceSprings again;
    keep(again, one);
    EXPECT_LE(OneFace(3.0, kAlong + slip).trial(again, 5.0).energy(), before * (1.0 + 1e-12));
  }
  for (const double softer : {0.01, 0.5, 2.0}) {
    OneFace face(3.0, kAlong + slip);
    for (auto& r : face.response) r.stiffness *= softer;
    EXPECT_LE(face.trial(springs, 5.0).energy(), before * (1.0 + 1e-12)) << softer;
  }
  // The kept force turned by a quarter has no part in the new plane.
  FaceSprings turned = springs;
  FaceSpring one = springs.kept().springs[0];
  one.separation = Vec3{{2.0, 0.0, 0.0}};
  keep(turned, one);
  EXPECT_NEAR(norm(OneFace(3.0, {{2.0, 0.0, 0.0}}).trial(turned, 5.0).force), 0.0, 3.0 * 0.006 * force);
}

TEST(FaceSprings, ForceLiesInTheFace) {
  const FaceSprings springs = loaded(3.0, {{0.2, -0.1, 0.05}}, 5.0);
  const FaceSpring& one = springs.kept().springs[0];
  EXPECT_NEAR(dot(one.force, one.separation), 0.0, 1e-12);
  EXPECT_GT(norm(one.force), 0.1);
}

TEST(FaceSprings, AFaceIsTheSameAfterASiteCameBackByAPeriod) {
  const FaceSprings springs = loaded(3.0, {{0.01, 0.0, 0.0}}, 5.0);
  OneFace face(3.0, kAlong + Vec3{{0.01, 0.0, 0.0}});
  face.cells.faces[0].image = home_image<3>() + 1;  // site 1, one period back along x, is seen one period ahead
  EXPECT_EQ(face.trial(springs, 5.0, {1, 0, 0}).force, springs.kept().springs[0].force);
  EXPECT_EQ(face.trial(springs, 5.0, {0, 0, 0}).force, Vec3{});
}

}  // namespace
}  // namespace softgrain
