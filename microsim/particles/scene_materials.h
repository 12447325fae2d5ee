// Materials and contact laws of a scene of explicit particles.
#pragma once

#include <string>
#include <vector>

#include "common/contact/law_set.h"
#include "common/core/material.h"
#include "common/io/scene.h"

namespace softgrain {

/// The tables [material.NAME], and "rigid", which is always there (last) for walls. Throws BadInput.
std::vector<Material> read_materials(const SceneTable& root);

/// Index of the material that `key` of `table` names; throws BadInput with the nearest name.
std::int32_t material_index(const std::vector<Material>& materials, const SceneTable& table, const std::string& key);

/// Laws per pair of materials and how to call each in a message.
struct SceneLaws {
  LawSet laws;
  std::vector<std::string> description;  ///< per law: "hertz-tsuji of glass and steel (file:line)"
};

/// The tables [[contact]]. Throws BadInput; FileTrouble for law cards that cannot be read.
SceneLaws read_contacts(const Scene& scene, const std::vector<Material>& materials);

}  // namespace softgrain
