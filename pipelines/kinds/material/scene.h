// Scenes of kind "material": packings of grains in a periodic cell, and tests of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/material/constituents.h"
#include "pipelines/kinds/material/equation.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// One material, its preparation and its test.
struct MaterialVariant {
  std::string name;            ///< name in files and tables
  MacroSetup setup;            ///< periodic setup without soft particles
  bool same_packings = false;  ///< whether it tests the samples of the variant before it in another way
  std::string packings{};      ///< name of its packings; empty: that of the variant
  std::string loading{};       ///< the name of its [[loading]], if any
};

struct MaterialScene {
  std::string title;
  std::uint64_t seed = 1;
  EquationSettings equation;
  std::vector<MaterialVariant> variants;  ///< one per [[variant]] (without any, the scene itself) and [[loading]]
};

/// What the tables of a material mean where they say nothing.
MacroSetup material_defaults();

/// [material], [grains] (which must be there), [packing] and [test], stages apart, over what `setup` has; with
/// `constituents` [[constituent]] too, whose sizes the caller takes. Returns whether E of `setup` is what the scene
/// says: not where it was refused. Throws InputError.
bool read_material_tables(const SceneTable& root, MacroSetup& setup, std::vector<Constituent>* constituents = nullptr);

/// Sizes of the solid grains, whichever way the spec says them.
Grading sizes_of(const MacroSpec& spec);
void take_sizes(MacroSpec& spec, const Grading& sizes);

/// b of the sizes of the solid grains, P(r) ~ r^-b; empty where they are no single power law.
std::optional<double> exponent_of(const MacroSpec& spec);

/// Refuses samples that do not fit into memory, at `count` of this table. Throws InputError.
void require_material_memory(const SceneTable& grains, const MacroSetup& setup);

/// All tables but those of other kinds that hold materials too, which read theirs beside it. `alone`: whether it is a
/// material and nothing else, which may have [[constituent]] and a target density. Throws InputError, IoError.
MaterialScene read_material(const SceneTable& root, bool alone);

/// Reads the whole scene. Throws InputError, IoError.
MaterialScene read_material_scene(const Scene& scene);

/// Number, sizes and memory of every variant, what to mind, and with `timed` the time. Throws InputError, IoError.
void check_variants(const MaterialScene& material, Findings& out, bool timed = true);

/// Prepares and tests all samples of all variants; writes material_NAME.h5, material_initial_NAME.h5, the kept states,
/// material.csv, summary.json and the report. Status not_usable when a curve is not usable or carries no stress.
SceneKind material_kind();

// Which variants of a material differ in the span of their sizes alone, so that one may be foretold from others.

/// Equal for variants that differ in nothing but the span of their sizes, the unit of length, and how many grains and
/// samples there are. Preparation, mu and the law of the sizes always stand in it, anything else where variants of the
/// scene differ in it. What variants are tested by is left out where they have loadings: test_family() says it.
std::string material_family(const MaterialVariant& variant, const std::vector<MaterialVariant>& all);

/// Equal for variants whose tests under one loading do not differ, as keys of the variants ("steps") may make them:
/// what variants of the scene differ in there, ", test = ..."; empty without loadings.
std::string test_family(const MaterialVariant& variant, const std::vector<MaterialVariant>& all);

/// Equal for variants of one material_family() in the same test, under the same loading.
std::string family_of(const MaterialVariant& variant, const std::vector<MaterialVariant>& all);

// What runs of kind "material" leave behind.

/// Name that the curves of resolved grains bear as their engine.
inline constexpr const char* kMaterialEngine = "material";

KindResults material_results();

/// See KindResults::differences: paired by sample where the seed and the numbers of samples and grains are the same.
PairedSummary material_differences(const report::RunData& a, const report::RunData& b,
                                   const std::vector<std::string>& keys);

/// p = (sigma_x + sigma_y + sigma_z)/3 at every point [Pa].
std::vector<double> mean_stresses(const MacroCurve& curve);

namespace report {
std::string material_section(const RunData& run);  ///< pressure over solid fraction, stresses, who bears them
}

}  // namespace softgrain
