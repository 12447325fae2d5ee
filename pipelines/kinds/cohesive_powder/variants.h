// Variants of a powder: one scene, several times, each with other values of some keys.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/kinds/cohesive_powder/scene.h"

namespace softgrain {

/// A number of the publication, shown beside ours.
struct PublishedValue {
  std::string quantity;  ///< one of powder_comparable()
  double value = 0.0;
  std::optional<double> error;
};

struct PowderVariant {
  Scene scene;            ///< as it would stand in a file of its own
  std::string name = {};  ///< also of its directory
  bool picked = true;     ///< by `only`; without it all are
  PowderSetup setup = {};
  std::vector<PublishedValue> published = {};
};

[[nodiscard]] bool has_powder_variants(const Scene& scene);

/// Reads every variant to its last key. Throws BadInput.
std::vector<PowderVariant> read_powder_variants(const Scene& scene);

}  // namespace softgrain
