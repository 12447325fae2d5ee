// Materials of a scene of explicit particles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/material.h"
#include "common/io/scene.h"

namespace softgrain {

/// The tables [material.NAME], and "rigid", which is always there (last) for walls. Densities are per volume, in two
/// dimensions per area. Throws BadInput.
std::vector<Material> read_materials(const SceneTable& root, int dimension);

/// Index of the material that `key` of `table` names; throws BadInput with the nearest name.
std::int32_t material_index(const std::vector<Material>& materials, const SceneTable& table, const std::string& key);

}  // namespace softgrain
