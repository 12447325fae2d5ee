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
  Scene scene;            ///< scene of the variant, as it would stand in a file of its own
  std::string name = {};  ///< name of the variant and of its directory
  bool picked = true;     ///< whether `only` names it; without that key all are picked
  PowderSetup setup = {};
  std::vector<PublishedValue> published = {};
};

[[nodiscard]] bool has_powder_variants(const Scene& scene);

/// Reads every variant to its last key. Throws InputError.
std::vector<PowderVariant> read_powder_variants(const Scene& scene);

}  // namespace softgrain
