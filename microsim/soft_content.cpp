#include "microsim/soft_content.h"

#include <cmath>

#include "common/core/random.h"

namespace softgrain {

namespace {

constexpr std::uint64_t kOrientations = 1000000;  ///< largest number of orientations of one packing

/// A unit quaternion, evenly on the sphere of four dimensions: four normal numbers over their length.
struct Turn {
  Vec3 axis{};
  double angle = 0.0;
};

Turn draw(RandomStream random) {
  const double w = random.normal();
  Vec3 v;
  for (int k = 0; k < 3; ++k) v[k] = random.normal();
  const double length = norm(v);
  if (!(length > 0.0)) return {{{1.0, 0.0, 0.0}}, 0.0};
  return {v * (1.0 / length), 2.0 * std::atan2(length, w)};
}

}  // namespace

SoftContent turned(const SoftContent& content, std::uint64_t seed, std::int64_t packing, std::int64_t orientation) {
  SoftContent out = content;
  if (orientation == 0) return out;
  const auto index = static_cast<std::uint64_t>(packing) * kOrientations + static_cast<std::uint64_t>(orientation);
  const Turn turn = draw(RandomStream(seed, RandomPurpose::rotation, index));
  const auto apply = [&](Vec3& x) { x = rotate(x, turn.axis, turn.angle); };
  for (Vec3& x : out.grains.position) apply(x);
  for (InnerSoft& inner : out.inner) apply(inner.x);
  for (ShellPacking& packing_inside : out.inner_packings)
    for (Vec3& x : packing_inside.position) apply(x);
  return out;
}

}  // namespace softgrain
