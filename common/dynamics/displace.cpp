#include "common/dynamics/displace.h"

#include <algorithm>

#include "common/dynamics/force_pass.h"

namespace softgrain {

template <int D>
void displace(System<D>& s, const std::vector<Vec<D>>& moves) {
  auto& p = s.particles;
  std::fill(p.spin.begin(), p.spin.end(), StoredRot<D>{});
  for (std::size_t u = 0; u < moves.size(); ++u) {
    p.sphere[u].x += moves[u];
    p.velocity[u] = moves[u];
  }
  force_pass(s, 1.0, History::advance);
  std::fill(p.velocity.begin(), p.velocity.end(), Stored<D>{});
}

template <int D>
void displace(System<D>& s, const std::vector<Vec<D>>& moves, const Vec<D>& growth) {
  for (int k = 0; k < D; ++k) {
    s.cell.edges[k][k] *= 1.0 + growth[k];
    s.cell.velocity_gradient[k][k] = growth[k] / (1.0 + growth[k]);  // over the unit of time that displace() takes
  }
  displace(s, moves);
  s.cell.velocity_gradient = {};
}

template void displace<2>(System<2>&, const std::vector<Vec<2>>&);
template void displace<2>(System<2>&, const std::vector<Vec<2>>&, const Vec<2>&);
template void displace<3>(System<3>&, const std::vector<Vec<3>>&, const Vec<3>&);
template void displace<3>(System<3>&, const std::vector<Vec<3>>&);

}  // namespace softgrain
