// Scene kind "law-table": what is measured with which neighbours, and how it is fitted.
#pragma once

#include <optional>
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
  std::optional<std::int64_t> packings;  ///< of every configuration; empty: as those of the main measurement
};

/// What is measured for it: all that the main one measures, or, on packings of its own number, what the fit takes.
CrowdSetup setup_of(const LawTableVariant& variant, const CrowdSetup& main);

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
