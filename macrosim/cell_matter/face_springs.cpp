#include "macrosim/cell_matter/face_springs.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/core/parallel_tasks.h"

namespace softgrain {

namespace {

/// One spring, which keeps its force where it gets stiffer.
void pull_one(const FaceSpring& before, const Vec3& normal, double limit, FaceSpring& spring) {
  const double share = spring.stiffness < before.stiffness ? spring.stiffness / before.stiffness : 1.0;
  const double on_the_way = std::min(spring.stiffness, 0.5 * (spring.stiffness + before.stiffness));
  const Vec3 pull = before.force * share - (spring.separation - before.separation) * on_the_way;
  spring.force = pull - normal * dot(pull, normal);
  const double size = norm(spring.force);
  spring.slides = size > limit;
  spring.tangent = on_the_way;
  if (!spring.slides) return;
  spring.kept = limit / size;
  spring.yields = 1.0;
  spring.force *= spring.kept;
}

/// Six springs at the A/d of the kept state.
void pull_six(const FaceSpring& before, const SpringForces& parts, const Vec3& normal, double limit, std::size_t f,
              SpringSet& out) {
  FaceSpring& spring = out.springs[f];
  spring.stiffness *= before.shape / spring.shape;
  spring.shape = before.shape;
  const PulledSprings pulled =
      pull(parts, before.stiffness, spring.stiffness, spring.separation - before.separation, normal, limit);
  spring.force = pulled.sum;
  spring.slides = pulled.slides;
  spring.tangent = spring.stiffness;
  spring.kept = pulled.kept;
  spring.yields = pulled.yields;
  out.parts[f] = pulled.force;
  out.energy[f] = pulled.energy;
}

}  // namespace

std::optional<std::size_t> FaceSprings::find(const FaceKey& key) const {
  const auto at = std::lower_bound(kept_.springs.begin(), kept_.springs.end(), key,
                                   [](const FaceSpring& s, const FaceKey& k) { return s.key < k; });
  if (at == kept_.springs.end() || at->key != key) return std::nullopt;
  return static_cast<std::size_t>(at - kept_.springs.begin());
}

SpringSet FaceSprings::trial(const FaceFriction& friction, bool memory, const RadicalCells& cells,
                             const std::vector<FaceKey>& keys, const std::vector<CellResponse>& response) const {
  SpringSet out;
  out.springs.resize(cells.faces.size());
  if (memory) {
    out.parts.resize(cells.faces.size());
    out.energy.resize(cells.faces.size());
  }
  const auto try_one = [&](std::size_t f) {
    const CellFace& face = cells.faces[f];
    const auto i = static_cast<std::size_t>(face.i);
    const auto j = static_cast<std::size_t>(face.j);
    const double bulk = 0.5 * (response[i].stiffness * cells.volume[i] + response[j].stiffness * cells.volume[j]);
    const double mu = strength_.empty() ? friction.coefficient : 0.5 * (strength_[i] + strength_[j]);
    const double limit = mu * 0.5 * (response[i].pressure + response[j].pressure) * face.area;
    FaceSpring& spring = out.springs[f];
    spring.key = keys[f];
    spring.separation = face.separation;
    spring.stiffness = friction.stiffness * bulk * face.area / face.distance;
    if (memory) spring.shape = face.area / face.distance;
    if (!(friction.coefficient > 0.0)) return;
    const auto before = find(keys[f]);
    if (!before) return;
    const Vec3 normal = face.separation * (1.0 / face.distance);
    if (memory)
      pull_six(kept_.springs[*before], kept_.parts[*before], normal, limit, f, out);
    else
      pull_one(kept_.springs[*before], normal, limit, spring);
  };
  in_pieces(out.springs.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) try_one(f);
  });
  return out;
}

void FaceSprings::keep(SpringSet springs) {
  std::vector<std::size_t> order(springs.springs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&springs](std::size_t a, std::size_t b) { return springs.springs[a].key < springs.springs[b].key; });
  kept_ = {};
  kept_.springs.reserve(order.size());
  kept_.parts.reserve(springs.parts.size());
  for (const std::size_t f : order) {
    kept_.springs.push_back(springs.springs[f]);
    if (!springs.parts.empty()) kept_.parts.push_back(springs.parts[f]);
  }
}

}  // namespace softgrain
