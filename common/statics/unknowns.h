// The vector of unknowns of the least-work solver, sums over it, and iterations that know no more than such vectors:
// Anderson mixing, preconditioned solutions of linear systems given as functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/core/vec.h"

namespace softgrain::statics {

using Unknowns = std::vector<double>;

/// Three entries from `at`.
inline Vec3 triple(const Unknowns& v, std::size_t at) { return {{v[at], v[at + 1], v[at + 2]}}; }

inline void add_triple(Unknowns& v, std::size_t at, const Vec3& a) {
  for (int k = 0; k < 3; ++k) v[at + static_cast<std::size_t>(k)] += a[k];
}

/// Sum in a fixed order.
double dot(const Unknowns& a, const Unknowns& b);
/// y += s x
void add_scaled(Unknowns& y, double s, const Unknowns& x);

/// Speeds up a fixed-point iteration x -> x + d(x) that converges linearly in a few directions.
class AndersonMixing {
 public:
  explicit AndersonMixing(std::size_t memory) : memory_(memory) {}
  void forget() {
    states_.clear();
    steps_.clear();
  }

  /// The step to take from x instead of d: the combination of the remembered steps with the least |weight d|.
  Unknowns mixed(const Unknowns& x, const Unknowns& d, const Unknowns& weight);

 private:
  std::size_t memory_;
  std::vector<Unknowns> states_, steps_;  ///< oldest first
};

using LinearMap = std::function<void(const Unknowns& in, Unknowns& out)>;

struct KrylovResult {
  std::int64_t iterations = 0;
  double reduction = 1.0;   ///< residual norm at the end over that at the start
  bool indefinite = false;  ///< conjugate gradient met a direction without stiffness and stopped before it
};

/// Preconditioned conjugate gradient for symmetric maps; x starts at zero.
KrylovResult conjugate_gradient(const LinearMap& map, const LinearMap& inverse, const Unknowns& rhs, double reduction,
                                std::int64_t most, Unknowns& x);

/// Stabilised biconjugate gradient (van der Vorst 1992, preconditioned from the right) for any map; x starts at zero.
/// `iterations` counts applications of the map, two per step.
KrylovResult biconjugate_gradient(const LinearMap& map, const LinearMap& inverse, const Unknowns& rhs, double reduction,
                                  std::int64_t most, Unknowns& x);

}  // namespace softgrain::statics
