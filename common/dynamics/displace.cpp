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

template void displace<2>(System<2>&, const std::vector<Vec<2>>&);
template void displace<3>(System<3>&, const std::vector<Vec<3>>&);

}  // namespace softgrain
