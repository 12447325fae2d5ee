// Laws of soft particles in a scene of explicit particles: one [[contact]] with law = "law-card".
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/core/material.h"
#include "common/io/scene.h"
#include "microsim/particles/scene_contacts.h"

namespace softgrain {

/// Index of the two materials of a pair.
struct PairOfMaterials {
  std::int32_t first = 0;
  std::int32_t second = 0;
  std::string text;  ///< "glass and steel"
};

/// Reads laws from cards (one contact by itself) and from law tables (several contacts at once). A soft particle of a
/// table needs one law in all its contacts: that is checked at the end.
class SoftLawReader {
 public:
  SoftLawReader(const Scene& scene, const std::vector<Material>& materials, SceneLaws& out)
      : scene_(scene), materials_(materials), out_(out) {}

  /// Throws InputError, IoError.
  void read(const SceneTable& t, const PairOfMaterials& pair);

  /// Throws InputError where a material has table laws with some partners and other laws with others.
  void require_whole() const;

 private:
  /// What all contacts of a soft particle of a table must agree in.
  struct Choice {
    std::string text;
    std::string where;
  };

  void read_card(const SceneTable& t, const PairOfMaterials& pair, const std::string& path);
  void read_table(const SceneTable& t, const PairOfMaterials& pair, const std::string& path);
  /// Where keys are taken down (KeyRecord) and the file is not there: asks for what goes with a card and with a table.
  void ask_for_all(const SceneTable& t, const PairOfMaterials& pair) const;
  [[nodiscard]] std::int32_t soft_of(const SceneTable& t, const PairOfMaterials& pair) const;
  void agree(const SceneTable& t, std::int32_t soft, const std::string& choice);

  const Scene& scene_;
  const std::vector<Material>& materials_;
  SceneLaws& out_;
  std::map<std::int32_t, Choice> choices_;  ///< choice per soft material of a law table
};

}  // namespace softgrain
