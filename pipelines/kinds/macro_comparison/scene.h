// A scene of kind "macro-comparison".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/kinds/macro/scene.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

struct ComparisonScene {
  std::string name;  ///< name of the scene in tables and of its files: letters, digits, '-'
  MacroSetup setup;
  std::optional<LawSources> laws;  ///< laws of this scene, in place of those of the comparison

  /// What soft particles hold is what the law was measured on, not the contents of twins.
  [[nodiscard]] bool by_own_law() const { return laws && setup.twins.empty(); }
};

struct MacroComparisonSetup {
  std::string title;
  std::uint64_t seed = 1;
  SoftParticleSpec spec;      ///< contents of the soft particles
  std::int64_t contents = 7;  ///< number of different ones
  LawSources laws;
  std::vector<ComparisonScene> scenes;

  [[nodiscard]] const LawSources& laws_of(const ComparisonScene& scene) const {
    return scene.laws ? *scene.laws : laws;
  }
};

/// Reads [material], [packing], [law], [macro] and every [[scene]], whose keys replace those of [macro]. Throws
/// InputError, IoError.
MacroComparisonSetup read_macro_comparison(const Scene& scene);

/// Runs all scenes and writes macro_SCENE.h5, macro_initial_SCENE.h5, comparison.json, table.md, table.csv,
/// summary.json and the report.
SceneKind macro_comparison_kind();

/// What every scene asks of its laws, and the time of all. Throws InputError, IoError.
void check_macro_comparison(const MacroComparisonSetup& setup, Findings& out);

// What comparisons of laws with twins leave behind.

KindResults macro_comparison_results();

namespace report {
std::string macro_scenes_section(const RunData& run);  ///< every law and both twins on every scene: error and cost
}

}  // namespace softgrain
