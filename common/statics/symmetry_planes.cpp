#include "common/statics/symmetry_planes.h"

#include <cmath>

#include "common/core/error.h"

namespace softgrain::statics {

namespace {

constexpr double kOnPlane = 1e-9;  // of the radius

void set_triple(Unknowns& v, std::size_t at, const Vec3& a) {
  for (int k = 0; k < 3; ++k) v[at + static_cast<std::size_t>(k)] = a[k];
}

}  // namespace

bool centred_on(const GrainPack& pack, std::size_t g, std::size_t w) {
  const PackWall& wall = pack.walls[w];
  return wall.symmetry &&
         std::abs(softgrain::dot(pack.position[g] - wall.point, wall.normal)) < kOnPlane * pack.radius[g];
}

SymmetryPlanes::SymmetryPlanes(const GrainPack& pack) {
  for (const PackWall& w : pack.walls) normal_.push_back(w.normal);
  for (std::size_t g = 0; g < pack.position.size(); ++g) {
    HeldGrain held{g, {}};
    for (std::size_t w = 0; w < pack.walls.size(); ++w) {
      if (!centred_on(pack, g, w)) continue;
      for (const std::size_t other : held.walls)
        if (std::abs(softgrain::dot(normal_[other], normal_[w])) > 1e-9)
          throw InputError("pack: symmetry planes that share a grain are at right angles");
      held.walls.push_back(w);
    }
    if (!held.walls.empty()) held_.push_back(std::move(held));
  }
}

void SymmetryPlanes::project(Unknowns& v, int stride) const {
  for (const HeldGrain& held : held_) {
    const std::size_t at = held.grain * static_cast<std::size_t>(stride);
    Vec3 move = triple(v, at);
    for (const std::size_t w : held.walls) move -= normal_[w] * softgrain::dot(normal_[w], move);
    set_triple(v, at, move);
    if (stride != 6) continue;
    const Vec3 n = normal_[held.walls.front()];
    set_triple(v, at + 3, held.walls.size() == 1 ? n * softgrain::dot(n, triple(v, at + 3)) : Vec3{});
  }
}

void SymmetryPlanes::carry(Unknowns& displacement, int stride, const std::vector<Vec3>& wall_moves, double part) const {
  for (const HeldGrain& held : held_) {
    const std::size_t at = held.grain * static_cast<std::size_t>(stride);
    Vec3 move = triple(displacement, at);
    for (const std::size_t w : held.walls) move += normal_[w] * softgrain::dot(normal_[w], wall_moves[w] * part - move);
    set_triple(displacement, at, move);
  }
}

}  // namespace softgrain::statics
