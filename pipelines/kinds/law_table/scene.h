// Scene kind "law-table": what is measured with which neighbours, and how it is fitted.
#pragma once

#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/kinds/law_table/crowd_law_fit.h"
#include "pipelines/kinds/law_table/crowd_scene.h"

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

}  // namespace softgrain
