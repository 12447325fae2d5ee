#include "macrosim/cell_matter/face_springs.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

std::vector<FaceSpring> FaceSprings::trial(const FaceFriction& friction, const RadicalCells& cells,
                                           const std::vector<FaceKey>& keys,
                                           const std::vector<CellResponse>& response) const {
  std::vector<FaceSpring> out(cells.faces.size());
  for (std::size_t f = 0; f < out.size(); ++f) {
    const CellFace& face = cells.faces[f];
    const auto i = static_cast<std::size_t>(face.i);
    const auto j = static_cast<std::size_t>(face.j);
    const double bulk = 0.5 * (response[i].stiffness * cells.volume[i] + response[j].stiffness * cells.volume[j]);
    const double limit = friction.coefficient * 0.5 * (response[i].pressure + response[j].pressure) * face.area;
    FaceSpring& spring = out[f];
    spring.key = keys[f];
    spring.separation = face.separation;
    spring.stiffness = friction.stiffness * bulk * face.area / face.distance;
    if (!(friction.coefficient > 0.0)) continue;
    const auto before = std::lower_bound(kept_.begin(), kept_.end(), keys[f],
                                         [](const FaceSpring& s, const FaceKey& key) { return s.key < key; });
    if (before == kept_.end() || before->key != keys[f]) continue;
    const Vec3 normal = face.separation * (1.0 / face.distance);
    const double share = spring.stiffness < before->stiffness ? spring.stiffness / before->stiffness : 1.0;
    const double on_the_way = std::min(spring.stiffness, 0.5 * (spring.stiffness + before->stiffness));
    const Vec3 pull = before->force * share - (face.separation - before->separation) * on_the_way;
    spring.force = pull - normal * dot(pull, normal);
    const double size = norm(spring.force);
    spring.slides = size > limit;
    spring.tangent = on_the_way;
    if (!spring.slides) continue;
    spring.kept = limit / size;
    spring.force *= spring.kept;
  }
  return out;
}

void FaceSprings::keep(std::vector<FaceSpring> springs) {
  kept_ = std::move(springs);
  std::sort(kept_.begin(), kept_.end(), [](const FaceSpring& a, const FaceSpring& b) { return a.key < b.key; });
}

}  // namespace softgrain
