// The vector of unknowns of the least-work solver, and sums over it.
#pragma once

#include <cstddef>
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

}  // namespace softgrain::statics
