// Scene kind "law-table": what is measured with which neighbours, and how it is fitted.
#pragma once

#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/kinds/law_table/crowd_law_fit.h"
#include "pipelines/kinds/law_table/crowd_scene.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// The same measurement on looser or denser packings.
struct LawTableVariant {
  SoftParticleSpec spec;
  std::int64_t packings = 0;
};

struct LawTableSetup {
  std::string title;
  CrowdSetup crowd;
  std::vector<LawTableVariant> variants;
  CrowdFitOptions fit;
};

/// Reads a scene of kind "law-table" to the last key. Throws BadInput.
LawTableSetup read_law_table(const Scene& scene);

/// Measures and fits; writes crowd.h5, law_table.toml, law_table.h5, summary.json and the report. Status not_usable
/// when a recorded point did not converge or the best law is not good.
SceneKind law_table_kind();

/// Counts, overlaps, memory, time, and what the table will lack. Throws BadInput.
void check_law_table(const Scene& scene, Findings& out);

}  // namespace softgrain
