// Vectors of the plane and of space in one form, for files and pictures.
#pragma once

#include "common/core/vec.h"

namespace softgrain {

/// A vector of space; what is flat has z = 0.
template <int D>
Vec3 in_space(const Vec<D>& a) {
  Vec3 out{};
  for (int k = 0; k < D; ++k) out[k] = a[k];
  return out;
}

}  // namespace softgrain
