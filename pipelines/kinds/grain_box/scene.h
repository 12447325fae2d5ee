// A scene of kind "grain-box": one pack, or several that differ in a few keys.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "microsim/grain_box/record.h"
#include "microsim/grain_box/spec.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/scene_kind.h"
#include "pipelines/run/size_summary.h"

namespace softgrain {

struct GrainBoxSetup {
  std::string title;
  std::uint64_t seed = 1;
  std::vector<GrainBoxSpec> packs;  ///< one per [[variant]]; without any, the scene itself
};

/// Grains whose sizes a distribution says, pack by pack.
std::vector<DrawnSizes> drawn_sizes(const GrainBoxSetup& setup, std::uint64_t seed);

/// Reads the whole scene. Throws InputError.
GrainBoxSetup read_grain_box(const Scene& scene);

/// Runs a scene of kind "grain-box"; writes grain_box.h5, summary.json and report.html. Packs run side by side when
/// there are threads for it. Status not_usable when a pack could not be brought to its end (what came before is kept).
SceneKind grain_box_kind();

/// Facts per pack: counts, solid fraction, overlap at the end of the loading, memory, time; and what to mind.
void check_grain_box(const GrainBoxSetup& setup, Findings& out);

/// Sentences about what must not be overlooked: packs that broke off, increments that were tried again.
std::vector<std::string> grain_box_remarks(const std::vector<GrainBoxResult>& results);

}  // namespace softgrain
