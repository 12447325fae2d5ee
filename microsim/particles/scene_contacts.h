// Materials and contact laws of a scene of explicit particles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/contact/law_set.h"
#include "common/core/material.h"
#include "common/io/scene.h"

namespace softgrain {

/// The tables [material.NAME], and "rigid", which is always there (last) for walls. Densities are per volume, in two
/// dimensions per area. Throws InputError.
std::vector<Material> read_materials(const SceneTable& root, int dimension);

/// Index of the material that `key` of `table` names; throws InputError with the nearest name.
std::int32_t material_index(const std::vector<Material>& materials, const SceneTable& table, const Key& key);

/// What a law may meet: what it says of the other body holds for grains or walls alone.
enum class LawScope { any, grains, walls };

/// Laws per pair of materials and how to call each in a message.
struct SceneLaws {
  LawSet laws;
  std::vector<std::string> description;  ///< per law: "hertz-tsuji of glass and steel (file:line)"
  std::vector<LawScope> scopes;          ///< per law
  std::vector<std::string> remarks;      ///< what to mind about laws from files
  std::string files;                     ///< text of the cards and tables that laws come from
};

/// The tables [[contact]]. Spheres have hertz-tsuji, linear-spring and law-card, disks (dimension 2) linear-spring and
/// cohesive. Throws InputError; IoError for law cards and tables that cannot be read.
SceneLaws read_contacts(const Scene& scene, const std::vector<Material>& materials, int dimension);

/// The law cards and tables that they name.
std::vector<std::string> contact_law_files(const Scene& scene);

}  // namespace softgrain
