// Vectors of a scene with as many components as it has dimensions.
#pragma once

#include <string>
#include <vector>

#include "common/core/vec.h"
#include "common/io/scene.h"

namespace softgrain {

/// Throws InputError.
template <int D>
Vec<D> read_vector(const SceneTable& t, const std::string& key, Unit unit) {
  if constexpr (D == 3) {
    return t.vector3(key, unit);
  } else {
    const std::vector<double> values = t.numbers(key, unit);
    if (values.size() == 2) return {{values[0], values[1]}};
    t.add_error(key, "must have two components, as the scene has dimension = 2");
    return {};
  }
}
template <int D>
Vec<D> read_vector(const SceneTable& t, const std::string& key, Unit unit, const Vec<D>& fallback) {
  return t.has(key) ? read_vector<D>(t, key, unit) : fallback;
}

}  // namespace softgrain
