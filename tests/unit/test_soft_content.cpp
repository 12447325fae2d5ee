// Contents turned as a whole: distances stay, directions are even.
#include "microsim/filled_shell.h"

#include <gtest/gtest.h>

#include "microsim/shell_packing.h"

namespace softgrain {
namespace {

SoftContent sample() {
  SoftContent content;
  content.grains.position = {{{0.5, 0.1, -0.2}}, {{-0.3, 0.4, 0.0}}, {{0.0, 0.0, 0.7}}};
  content.grains.radius = {0.2, 0.1, 0.05};
  content.inner = {{{{0.1, -0.6, 0.3}}, 0.1}};
  content.inner_packings = {content.grains};
  return content;
}

TEST(SoftContent, TheFirstOrientationIsTheContentItself) {
  const SoftContent content = sample();
  const SoftContent same = turned(content, 1, 7, 0);
  EXPECT_EQ(same.grains.position, content.grains.position);
  EXPECT_EQ(same.inner[0].x, content.inner[0].x);
}

TEST(SoftContent, AllTurnsTogetherAndAlwaysAlike) {
  const SoftContent content = sample();
  const SoftContent a = turned(content, 1, 7, 2);
  EXPECT_EQ(a.grains.position, turned(content, 1, 7, 2).grains.position);
  EXPECT_EQ(a.grains.radius, content.grains.radius);
  EXPECT_GT(norm(a.grains.position[0] - content.grains.position[0]), 1e-3);
  EXPECT_GT(norm(a.grains.position[0] - turned(content, 1, 8, 2).grains.position[0]), 1e-3) << "another packing";
  EXPECT_GT(norm(a.grains.position[0] - turned(content, 2, 7, 2).grains.position[0]), 1e-3) << "another seed";
  const auto dots = [](const SoftContent& c) {
    const Vec3& p = c.grains.position[0];
    return std::vector<double>{dot(p, c.grains.position[1]), dot(p, c.grains.position[2]), dot(p, c.inner[0].x),
                               dot(p, c.inner_packings[0].position[1]),
                               dot(cross(p, c.grains.position[1]), c.grains.position[2])};
  };
  const auto before = dots(content);
  const auto after = dots(a);
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(after[k], before[k], 1e-14) << k;
}

/// Mean of a turned unit vector 0, of its squared components 1/3, of the trace of the rotation 0 (Haar measure).
TEST(SoftContent, OrientationsAreEven) {
  SoftContent content;
  content.grains.position = {{{1.0, 0.0, 0.0}}, {{0.0, 1.0, 0.0}}, {{0.0, 0.0, 1.0}}};
  content.grains.radius = {0.1, 0.1, 0.1};
  constexpr int kDraws = 4000;
  Vec3 mean{};
  Vec3 square{};
  double trace = 0.0;
  for (int k = 1; k <= kDraws; ++k) {
    const auto& x = turned(content, 3, k, 1 + k % 3).grains.position;
    for (int j = 0; j < 3; ++j) {
      mean[j] += x[0][j] / kDraws;
      square[j] += x[0][j] * x[0][j] / kDraws;
      trace += x[static_cast<std::size_t>(j)][j] / kDraws;
    }
  }
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(mean[j], 0.0, 0.037);          // 4 sqrt(1/3 / 4000)
    EXPECT_NEAR(square[j], 1.0 / 3.0, 0.019);  // 4 sqrt(4/45 / 4000)
  }
  EXPECT_NEAR(trace, 0.0, 0.064);  // its variance is 1
}

}  // namespace
}  // namespace softgrain
