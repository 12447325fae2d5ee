// softgrain run of kind "macro-comparison": every law and both resolved twins on the same scenes, error against cost.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/macro_stage.h"

namespace softgrain {

struct ComparisonScene {
  std::string name;  ///< of its files and in tables: letters, digits, '-'
  MacroSetup setup;
};

struct MacroComparisonSetup {
  std::string title;
  std::uint64_t seed = 1;
  SoftParticleSpec spec;      ///< contents of the soft particles
  std::int64_t contents = 7;  ///< number of different ones
  LawSources laws;
  std::vector<ComparisonScene> scenes;
};

/// Reads [material], [packing], [law], [macro] and every [[scene]], whose keys replace those of [macro]. Throws
/// BadInput, FileTrouble.
MacroComparisonSetup read_macro_comparison(const Scene& scene);

/// Runs all scenes and writes macro_SCENE.h5, macro_initial_SCENE.h5, comparison.json, table.md, table.csv,
/// summary.json and the report.
ExitStatus run_macro_comparison(const CommonOptions& options, const Scene& scene);

}  // namespace softgrain
