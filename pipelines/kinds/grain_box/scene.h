// A scene of kind "grain-box": one pack, or several that differ in a few keys.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "microsim/grain_box/spec.h"

namespace softgrain {

struct GrainBoxSetup {
  std::string title;
  std::uint64_t seed = 1;
  std::vector<GrainBoxSpec> packs;  ///< one per [[variant]]; without any, the scene itself
};

/// Reads the whole scene. Throws BadInput.
GrainBoxSetup read_grain_box(const Scene& scene);

}  // namespace softgrain
